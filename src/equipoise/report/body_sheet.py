"""Where to drill: a dimensioned drawing of every body that springs or weights are fixed to, in its own frame.

Each body is drawn in two views. Dimensions run from its origin, which is the joint that carries it (of the world, its
own origin): one line to the margin for each place, with the distance in mm (ordinate dimensions, ISO 129-1).
"""

from __future__ import annotations

from datetime import datetime
from importlib.util import find_spec
from math import cos, log10, pi, sin

import numpy as np

from .._version import __version__
from ..kinematics import Tree
from ..model.arrays import Array, frozen
from ..model.errors import InputError
from ..model.mechanism import WORLD, Mechanism
from .drawing import LARGE, NORMAL, SMALL, THICK, THIN, Drawing, Label
from .schematic import symbols

WIDTH, EDGE, HEAD = 297.0, 8.0, 20.0  # [mm] of the sheet, its frame, its title
VIEW, GAP, MARGIN = 62.0, 34.0, 24.0  # [mm] the size of a view, between two views, room for dimensions
ROW = 4.6  # [mm] a line of the table, and the least distance of two dimensions
TABLE = 205.0  # [mm] where the table begins
AXES = "xyz"
MM = 1000.0


@frozen
class Place:
    """A place on a body: what is fixed there, and where [mm]."""

    mark: str
    what: str
    p: Array


def places(mechanism: Mechanism) -> dict[str, list[Place]]:
    """Of each body with something fixed to it, the places, in the mechanism's order."""
    found: dict[str, list[Place]] = {}
    letters = {letter: symbols(mechanism, letter) for letter in "ab"}
    for i, spring in enumerate(mechanism.springs):
        for mark, (body, p) in spring.places:
            name = letters[mark][i] if mark in letters else f"{letters['a'][i]}.{mark}"
            found.setdefault(body, []).append(Place(name, spring.name, MM * np.array(p)))
    for i, mass in enumerate(mechanism.masses, start=1):
        place = Place(f"m{i}", f"{mass.name}, {mass.mass:.4g} kg", MM * np.array(mass.position))
        found.setdefault(mass.body, []).append(place)
    order = {name: i for i, name in enumerate(mechanism.body_names)}
    return dict(sorted(found.items(), key=lambda item: order[item[0]]))


def body_sheet(mechanism: Mechanism, date: str = "") -> Drawing:
    """All bodies on one sheet.

    Raises:
        InputError: nothing is fixed to any body.
    """
    every = places(mechanism)
    if not every:
        raise InputError(f"mechanism '{mechanism.name}' has no springs and no weights, so nothing is attached")
    sheet = Drawing(WIDTH, HEAD + sum(map(_height, every.values())) + 2 * EDGE)
    top = sheet.height - EDGE
    sheet.label((EDGE + 4, top - 8), f"{mechanism.name}: attachment points", LARGE, bold=True)
    sheet.label((WIDTH - EDGE - 4, top - 6), "dimensions in mm, from the origin of each body", SMALL, "end")
    sheet.label((WIDTH - EDGE - 4, top - 11), f"equipoise {__version__}{f', {date}' * bool(date)}", SMALL, "end")
    _frame(sheet)
    y = top - HEAD + EDGE / 2
    for body, own in every.items():
        sheet.line((EDGE, y), (WIDTH - EDGE, y))
        _panel(sheet, mechanism, body, own, y)
        y -= _height(own)
    return sheet


def body_drawings(mechanism: Mechanism) -> dict[str, Drawing]:
    """Each body on a sheet of its own."""
    found = {}
    for body, own in places(mechanism).items():
        found[body] = Drawing(WIDTH, _height(own) + EDGE)
        _panel(found[body], mechanism, body, own, found[body].height - 2)
    return found


def _height(own: list[Place]) -> float:
    return max(VIEW + MARGIN + 14, 22 + ROW * (len(own) + 3))


def _frame(sheet: Drawing) -> None:
    top = sheet.height - EDGE
    corners = ((EDGE, EDGE), (WIDTH - EDGE, EDGE), (WIDTH - EDGE, top), (EDGE, top), (EDGE, EDGE))
    sheet.line(*corners, width=THICK)


def _panel(sheet: Drawing, mechanism: Mechanism, body: str, own: list[Place], top: float) -> None:
    tree = Tree.of(mechanism)
    number = tree.index[body]
    joints = [MM * link.p0 for link in tree.links if link.parent == number and body != WORLD]
    points = np.array([*(place.p for place in own), *joints, np.zeros(3)])
    spread = np.ptp(points, axis=0)
    u, v = sorted(np.argsort(-spread, kind="stable")[:2].tolist())  # seen along the axis of the least extent
    w = 3 - u - v
    scale = _scale(VIEW / max(float(spread.max()), 1e-6))
    carried = next((link.joint.name for link in tree.links if link.body == number), "")
    origin = "its own origin, fixed" if body == WORLD else f"joint '{carried}'"
    sheet.label((EDGE + 4, top - 6), body, NORMAL + 1, bold=True)
    sheet.label((EDGE + 4, top - 10.5), f"origin: {origin}; scale {_ratio(scale)}", SMALL)
    left = EDGE + MARGIN
    base = top - 16 - VIEW
    for x, (first, second) in ((left, (u, v)), (left + VIEW + GAP, (w, v))):
        _view(sheet, own, joints, points[:, [first, second]], (first, second), scale, (x, base))
    for i, name in enumerate(("place", *(f"{axis} [mm]" for axis in AXES), "for")):
        sheet.label((_column(i), top - 6), name, SMALL, "start" if i in (0, 4) else "end", bold=True)
    for row, place in enumerate(own, start=1):
        at = top - 6 - ROW * row
        sheet.label((_column(0), at), place.mark, NORMAL)
        for i, value in enumerate(place.p, start=1):
            sheet.label((_column(i), at), _number(value), NORMAL, "end")
        sheet.label((_column(4), at), _short(place.what), SMALL)


def _view(
    sheet: Drawing,
    own: list[Place],
    joints: list[Array],
    points: Array,
    axes: tuple[int, int],
    scale: float,
    corner: tuple[float, float],
) -> None:
    """One view: the axes `axes` to the right and upwards; `points` (K, 2) [mm] are all that is in it."""
    low, high = points.min(axis=0), points.max(axis=0)
    shift = np.array(corner) + (VIEW - scale * (high - low)) / 2 - scale * low

    def at(p: Array) -> tuple[float, float]:
        x, y = shift + scale * p[list(axes)]
        return float(x), float(y)

    origin = at(np.zeros(3))
    for joint in joints:
        sheet.line(origin, at(joint), width=THICK, pattern=(4.0, 1.5))
        _circle(sheet, at(joint), 1.2)
    _circle(sheet, origin, 1.6)
    _circle(sheet, origin, 0.5)
    marks: dict[tuple[float, float], list[str]] = {}
    for place in own:
        x, y = at(place.p)
        marks.setdefault((round(x, 1), round(y, 1)), []).append(place.mark)
        sheet.line((x - 1.4, y), (x + 1.4, y))
        sheet.line((x, y - 1.4), (x, y + 1.4))
        _circle(sheet, (x, y), 0.8)
    for (x, y), names in marks.items():
        sheet.label((x + 1.6, y + 1.2), ", ".join(names), NORMAL, bold=True)
    for side, axis in enumerate(axes):
        values = sorted({round(float(place.p[axis]), 2) for place in own} | {0.0})
        spots = [float(shift[side] + scale * value) for value in values]
        for value, spot, text in zip(values, spots, _apart(spots), strict=True):
            nearest = [at(place.p) for place in own if abs(place.p[axis] - value) < 0.006] or [origin]
            edge = corner[1 - side] - 5
            reach = min(point[1 - side] for point in nearest) - 1.6
            path = [(spot, reach), (spot, edge), (text, edge - 4)]
            line = path if side == 0 else [(b, a) for a, b in path]
            sheet.line(*line, width=THIN)
            if side == 0:
                sheet.labels.append(Label((text + NORMAL / 3, edge - 5), _number(value), NORMAL, "end", upwards=True))
            else:
                sheet.label((edge - 5, text - NORMAL / 3), _number(value), NORMAL, "end")
    for side, axis in enumerate(axes):
        tip = (corner[0] + VIEW + 6, corner[1] - 3) if side == 0 else (corner[0] - 3, corner[1] + VIEW + 2)
        sheet.label(tip, f"{AXES[axis]} {'→' if side == 0 else '↑'}", SMALL)


def _apart(spots: list[float]) -> list[float]:
    """The same in the same order, at least a row apart, as near to where they were as one pass makes them."""
    if not spots:
        return []
    found = [spots[0]]
    for spot in spots[1:]:
        found.append(max(spot, found[-1] + ROW))
    back = (found[-1] - spots[-1]) / 2
    return [spot - back for spot in found]


def _circle(sheet: Drawing, centre: tuple[float, float], radius: float) -> None:
    x, y = centre
    turn = [2 * pi * i / 16 for i in range(17)]
    sheet.line(*((x + radius * cos(a), y + radius * sin(a)) for a in turn))


def _scale(largest: float) -> float:
    """The largest of 1, 2, 5, 10, ... to one, either way, that is not above `largest`."""
    power = 10.0 ** np.floor(log10(largest))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= largest * (1 + 1e-9)))


def _ratio(scale: float) -> str:
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def _column(i: int) -> float:
    return TABLE + (0.0, 25.0, 41.0, 57.0, 60.0)[i]


def _number(value: float) -> str:
    return f"{round(float(value), 2) + 0.0:g}"


def _short(text: str, most: int = 16) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


def today() -> str:
    """The date that stands on a sheet."""
    return datetime.now().date().isoformat()


def to_text(mechanism: Mechanism) -> str:
    """The sheet as SVG."""
    return body_sheet(mechanism, today()).svg()


def to_dxf(mechanism: Mechanism) -> str:
    """The sheet as DXF.

    Raises:
        InputError: ezdxf is missing, or nothing is fixed to any body.
    """
    if find_spec("ezdxf") is None:
        raise InputError("DXF drawings need ezdxf: pip install 'equipoise[cad]'")
    return body_sheet(mechanism, today()).dxf()
