"""The profile of a cam at full size, to cut: its axis, reference angle, fixed point and the length of its cable."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, degrees, hypot, sin

import numpy as np

from ..kinematics import Tree
from ..model.arrays import Array
from ..model.elements import Element
from ..model.elements.cam_outline import closed, shaft
from ..model.elements.laws import Cam
from ..model.elements.laws.comparison import Comparison
from ..model.elements.laws.profile import Profile
from ..model.elements.plane import Plane
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from .drawing import NORMAL, SMALL, THICK, WRITERS, Drawing, Pair, check_extra

MM = 1000.0  # per metre
EDGE, ROW = 12.0, 4.6  # [mm] around the drawing, a line of text
CROSS = 4.0  # [mm] half a centre mark
AXIS = (6.0, 1.2, 0.6, 1.2)
DASHED = (2.0, 1.0)
ROUND = np.linspace(0, 2 * np.pi, 73)
WIDE = 1.9  # [mm] of a letter, at most


def cam_of(mechanism: Mechanism, name: str | None = None) -> tuple[Element, Profile]:
    """The cam with that name, or the only one, and its profile.

    Raises:
        InputError: there is none such, several, or its profile is not known.
    """
    found = {
        one.name: (one, one.law.made)
        for one in mechanism.springs
        if isinstance(one.law, Cam) and one.law.made is not None
    }
    if not found:
        raise InputError(f"mechanism '{mechanism.name}' has no cam with a profile; design one with --method cam")
    if name is None and len(found) > 1:
        raise InputError(Fault(("--cam",), "there are several cams with a profile", tuple(found)))
    name = name or next(iter(found))
    if name not in found:
        raise InputError(Fault(("--cam",), f"no cam with a profile {nearest(name, found)}", tuple(found)))
    return found[name]


def cam_text(mechanism: Mechanism, name: str, to: str) -> str:
    """The sheet of a cam as the content of a file.

    Args:
        to: "svg" or "dxf".

    Raises:
        InputError: as `cam_of`; another format; or ezdxf is not installed, for DXF.
    """
    if f".{to}" not in WRITERS:
        raise InputError(Fault(("--cam",), "is drawn with --to svg or --to dxf", ("svg", "dxf")))
    check_extra(f".{to}")
    return WRITERS[f".{to}"](cam_drawing(mechanism, name))


def cam_drawing(mechanism: Mechanism, name: str | None = None) -> Drawing:
    """The sheet of a cam, in the plane of its joint at angle 0, 1 : 1.

    Raises:
        InputError: as `cam_of`.
    """
    cam, made = cam_of(mechanism, name)
    plane = Plane.of(Tree.of(mechanism), cam.turns[0] if cam.turns else cam.joints[0][0])
    rim = MM * closed(made)
    rim = np.vstack([rim, rim[:1]])
    fixed, line = _behind(made)
    reference = max(float(np.hypot(*rim.T).max()), 10.0) + 6
    marks = np.vstack([rim, fixed, line, [[-CROSS, -CROSS], [reference + CROSS, CROSS]]])
    texts = list(_texts(mechanism, cam, made, plane))
    low, high = marks.min(axis=0) - EDGE, marks.max(axis=0) + EDGE
    wide = max(high[0] - low[0], WIDE * max(map(len, texts)) + 2 * EDGE)
    drawing = Drawing(float(wide), float(high[1] - low[1] + ROW * (len(texts) + 2)))
    at = np.array([-low[0], drawing.height - high[1]])

    def pen(points: Array, **look: object) -> None:
        drawing.line(*((float(x), float(y)) for x, y in np.atleast_2d(points) + at), **look)  # type: ignore[arg-type]

    pen(rim, width=THICK)
    if made.cable is not None and made.cable.diameter:
        pen(_inside(MM * np.array(made.profile), rim, MM * made.cable.diameter / 2), pattern=DASHED)
    if room := MM * shaft(made) if made.cable else 0.0:
        pen(room * np.stack([np.cos(ROUND), np.sin(ROUND)], axis=1), pattern=DASHED)
    for cross in ([[-CROSS, 0], [CROSS, 0]], [[0, -CROSS], [0, CROSS]]):
        pen(np.array(cross), pattern=())
        pen(np.array(cross) + fixed)
    pen(np.array([[0, 0], [reference, 0]]), pattern=AXIS)
    pen(line, pattern=DASHED)
    if made.roller is not None:
        centre, r = line[0], MM * made.roller.radius
        pen(centre + r * np.stack([np.cos(ROUND), np.sin(ROUND)], axis=1))

    def label(point: Array, text: str) -> None:
        x, y = (float(v) for v in point + at)
        drawing.label((x + 1.5, y + 1.2), text, SMALL)

    label(np.zeros(2), "axis")
    label(np.array([reference - 8, 0.0]), "x, 0 deg")
    label(fixed, "fixed point" if made.cable else "seat of the spring")
    if made.cable:
        label(MM * np.array(made.profile[0]), "the cable is fixed here")
    for i, text in enumerate(texts):
        place: Pair = (EDGE, ROW * (len(texts) - i))
        drawing.label(place, text, NORMAL, bold=i == 0)
    return drawing


def _behind(made: Profile) -> tuple[Array, Array]:
    """The fixed point (2,) and a line (2, 2) of the cable or the roller's way, at or nearest to angle 0 [mm]."""
    run = made.run
    angle = float(np.clip(0.0, run.angle[0], run.angle[-1]))
    if made.cable is not None:
        turned = made.turn * angle
        x, y = (float(np.interp(angle, run.angle, column)) for column in run.contact.T)
        contact = np.array([cos(turned) * x - sin(turned) * y, sin(turned) * x + cos(turned) * y])
        fixed = MM * np.array(made.cable.point)
        return fixed, np.stack([MM * contact, fixed])
    assert made.roller is not None
    u = np.array([cos(made.roller.direction), sin(made.roller.direction)])
    left = made.roller.offset * np.array([-u[1], u[0]])
    seat, centre = (MM * (s * u + left) for s in (made.roller.seat, float(np.interp(angle, run.angle, run.free))))
    return seat, np.stack([centre, seat])


def _inside(points: Array, rim: Array, by: float) -> Array:
    """The points of a profile moved inwards [mm]: the bottom of the cable's groove."""
    step = np.gradient(points, axis=0)
    normal = np.stack([-step[:, 1], step[:, 0]], axis=1) / np.linalg.norm(step, axis=1)[:, None]
    middle = rim.mean(axis=0)
    return points + by * normal * np.sign(((middle - points) * normal).sum())


def _used(mechanism: Mechanism, cam: Element, made: Profile) -> Comparison:
    """How the profile does within the range of its joint, or all along where that is not one joint's."""
    limits = next((j.range for j in mechanism.joints if cam.joints == ((j.name, 1.0),)), None)
    run = made.run
    low, high = limits or (float(run.angle[0]), float(run.angle[-1]))
    return Comparison.of(made, cam.law, low, high)


def _texts(mechanism: Mechanism, cam: Element, made: Profile, plane: Plane) -> Iterator[str]:
    use, law = _used(mechanism, cam, made), made.spring.law
    run = use.used
    bodies = {"child": plane.child, "parent": plane.parent}
    other = bodies["parent" if made.fixed_to == "child" else "child"]
    yield f"{cam.name}, 1 : 1, in mm"
    yield f"turns with {bodies[made.fixed_to]}; x is that of {other} where {cam.where} is at 0 deg"
    axis = ", ".join(f"{value:.3g}" for value in plane.axes[2] + 0.0)
    yield f"seen against the axis ({axis}) of {plane.child}: it turns anticlockwise"
    low, high = degrees(use.low), degrees(use.high)
    size = f"{MM * run.reach.min():.4g} to {MM * run.reach.max():.4g} from the axis"
    yield f"used from {low:.4g} to {high:.4g} deg of {cam.where}, {size}"
    part = f" '{made.spring.part}'" if made.spring.part else ""
    yield f"{law.noun}{part}: {law.words()}"
    force = f"{run.force.min():.4g} to {run.force.max():.4g} N"
    yield f"its length {MM * run.length.min():.5g} to {MM * run.length.max():.5g} mm, {force}"
    if made.cable is not None:
        x, y = (round(MM * value, 3) + 0.0 for value in made.cable.point)
        behind = f", and the spring ends {MM * made.cable.behind:.5g} behind it" if made.cable.behind else ""
        yield f"fixed point ({x:.5g}, {y:.5g}), {hypot(x, y):.5g} from the axis{behind}"
        yield f"cable {MM * made.cable.length:.5g} from its end on the profile to the spring"
        if made.cable.diameter:
            yield f"thick: middle of the cable of {MM * made.cable.diameter:.3g}; dashed: bottom of its groove"
    if made.roller is not None:
        way = f"{degrees(made.roller.direction):.4g} deg, {MM * made.roller.offset:.4g} beside the axis"
        yield f"roller of radius {MM * made.roller.radius:.4g} on a line at {way}; seat at {MM * made.roller.seat:.5g}"
