"""Drawings that a page can hold: in light and dark, with a name and a text for readers that do not see them."""

from __future__ import annotations

import re
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ...balance import Balance
from ...energy.evaluate import Potential
from ...kinematics import Tree
from ...model.arrays import Array
from .. import arm, loads, style, svg
from ..figure import holding, picture
from ..poses import choose
from ..schematic import schematic
from ..skeleton import Skeleton
from .content import Picture

SIZE = (9.0, 4.6)  # [in] the two poses
STEPS = 121  # of the motion
NO_BREAK = "\N{NO-BREAK SPACE}"
NAMESPACE = re.compile(r"\{[^}]*\}")
COLOUR = re.compile(r"#[0-9a-fA-F]{6}\b|\bwhite\b")
VARIABLE = re.compile(r"var\(--[\w-]+, (#\w+)\)")

# colour -> the variable that a page sets for it; a dark page has others
VARIABLES = {
    colour.lower(): name
    for name, colour in {
        "ink": style.INK, "faint": style.FAINT, "edge": style.EDGE, "ground": style.GROUND,
        "body-0": style.BODIES[0], "body-1": style.BODIES[1], "floor": style.FLOOR, "grid": style.GRID,
        "shadow": style.SHADOW, "paper": "#ffffff",
        **{f"spring-{i}": colour for i, colour in enumerate(style.SPRINGS)},
    }.items()
}  # fmt: skip


def inline(text: str, key: str, title: str, said: str) -> str:
    """An SVG for the inside of a page: named, its colours variables, its identifiers starting with `key`."""
    root = ElementTree.fromstring(text)
    for parent in list(root.iter()):
        for child in list(parent):
            if NAMESPACE.sub("", str(child.tag)) in ("metadata", "style", "title", "desc"):
                parent.remove(child)
    for node in root.iter():
        node.tag = NAMESPACE.sub("", node.tag)
        found = {NAMESPACE.sub("", name): value for name, value in node.attrib.items()}
        node.attrib.clear()
        for name, value in found.items():
            node.set(name, _colours(_own(name, value, key)))
    for name in ("width", "height", "aria-label", "version"):
        root.attrib.pop(name, None)
    # what matplotlib's style sheet says of everything, here of this picture only
    root.set("style", "stroke-linejoin:round;stroke-linecap:butt")
    root.set("xmlns", "http://www.w3.org/2000/svg")
    root.set("role", "img")
    root.set("aria-labelledby", f"{key}-title")
    root.set("aria-describedby", f"{key}-desc")
    for i, (tag, words) in enumerate((("title", title), ("desc", said))):
        node = ElementTree.Element(tag, {"id": f"{key}-{tag}"})
        node.text = words
        root.insert(i, node)
    return ElementTree.tostring(root, encoding="unicode")


def plain(text: str) -> str:
    """The same with the light page's colours, for programs that know no variables."""
    return VARIABLE.sub(r"\1", text)


def _own(name: str, value: str, key: str) -> str:
    if name == "id":
        return f"{key}-{value}"
    if name == "href" and value.startswith("#"):
        return f"#{key}-{value[1:]}"
    return value.replace("url(#", f"url(#{key}-")


def _colours(value: str) -> str:
    if "var(" in value:
        return value

    def variable(match: re.Match[str]) -> str:
        colour = "#ffffff" if match[0] == "white" else match[0].lower()
        return f"var(--{VARIABLES[colour]}, {colour})" if colour in VARIABLES else match[0]

    return COLOUR.sub(variable, value)


def two_poses(balance: Balance) -> Picture:
    """The mechanism with its springs, stretched out and bent."""
    mechanism = balance.mechanism
    skeleton = Skeleton.of(mechanism)
    view, q = choose(mechanism, skeleton)
    poses, state = Tree.of(mechanism).poses(q), Potential(mechanism)(q)
    held = [holding(mechanism, balance, state.gravity_torque[i], state.torque[i]) for i in range(2)]

    def draw(figure: Any) -> None:
        limits = arm.window(skeleton, poses, view, 0.49 * SIZE[0] / (0.9 * SIZE[1]))
        for i in range(2):
            axes = figure.add_axes((0.005 + 0.5 * i, 0.09, 0.49, 0.9))
            axes.set(xlim=limits[0], ylim=limits[1], aspect="equal")
            axes.set_axis_off()
            arm.draw(axes, skeleton, poses, i, view)
            look = {"ha": "center", "va": "top", "color": style.INK, "parse_math": False}
            axes.text(0.5, -0.01, held[i], transform=axes.transAxes, **look)

    name = style.clean(mechanism.name, 60)
    how = "seen straight on" if view.planar else "seen from the side and slightly above"
    said = f"{name}, {how}, with {_springs(balance)} as coils; on the left stretched out, on the right bent. "
    said += "; ".join(f"{side}: {text}" for side, text in zip(("left", "right"), held, strict=True) if text)
    text = picture(".svg", SIZE, draw).decode()
    title = f"{name} in two poses"
    caption = f"{title}, with {_springs(balance)}; {how}."
    return Picture(inline(text, "poses", title, said), caption, said)


def scheme(balance: Balance, key: str = "scheme") -> Picture:
    """The schematic, whose letters the tables use; `key` makes its identifiers its own."""
    mechanism = balance.mechanism
    title = f"Schematic of {style.clean(mechanism.name, 60)}"
    ends = "; ".join(f"spring {i} {s.between}" for i, s in enumerate(mechanism.springs, start=1))
    said = f"Links, joints and ground as lines, circles and hatching. {ends or 'No springs'}."
    letters = ": a and b are the ends of each spring, k its stiffness; the numbers are in the tables below"
    caption = f"{title}{letters if ends else ''}."
    return Picture(inline(schematic(mechanism, legend=False).svg(), key, title, said), caption, said)


def torque_bars(balance: Balance) -> list[Picture]:
    """The largest holding torque of each coordinate with springs and without; turning and sliding joints apart."""
    found = []
    for kind, rows in loads.shown(balance).items():
        names = [balance.coordinates[row] for row in rows]
        before, after = balance.unbalanced.max[rows], balance.residual.max[rows]
        floor = loads.below(balance) or loads.TINY
        title = f"Largest holding {kind.load}"
        text = svg.bars(names, before, after, [kind.load_unit] * len(names), title, floor)
        said = ElementTree.fromstring(text).get("aria-label", "")
        all_of_unit = balance.units.count(kind.unit)
        which = "each coordinate" if len(rows) == all_of_unit else f"the {len(rows)} of {all_of_unit} most loaded ones"
        caption = f"{title} of {which}: grey without springs, green with them."
        found.append(Picture(inline(text, f"bars-{kind.unit}", title, said), caption, said, narrow=True))
    return found


def along_motion(balance: Balance) -> list[Picture]:
    """Energies, and the torque of the joint that gravity loads most, from the left pose of the picture to the right."""
    mechanism = balance.mechanism
    if not balance.coordinates:
        return []
    _, q = choose(mechanism, Skeleton.of(mechanism))
    way = np.linspace(0.0, 1.0, STEPS)
    state = Potential(mechanism)(q[0] + way[:, None] * (q[1] - q[0]))
    springs = state.springs.sum(axis=1)
    energies = {"gravity": state.gravity, "springs": springs, "both": state.energy}
    found = [_curves("energies", "Energy", "J", way, energies)]
    rows = next(iter(loads.shown(balance).values()))
    j = int(rows[np.argmax(balance.unbalanced.max[rows])])
    name = balance.coordinates[j]
    gravity, both = state.gravity_torque[:, j], state.torque[:, j]
    torques = {"gravity": gravity, "springs": both - gravity, "both": both}
    found.append(_curves("torques", f"Holding {name.load} of {name}", name.load_unit, way, torques))
    return found


def _curves(key: str, title: str, unit: str, way: Array, series: dict[str, Array]) -> Picture:
    whole = max((float(np.nanmax(np.abs(y), initial=0)) for y in series.values()), default=0.0)
    series = {name: np.where(np.abs(y) < 1e-10 * whole, 0.0, y) for name, y in series.items()}  # rounding is no curve
    title = f"{title}, from the left pose to the right one"
    text = svg.curves(way, series, "share of the way, all coordinates moving evenly", unit, title)
    said = ElementTree.fromstring(text).get("aria-label", "")
    caption = f"{title} [{unit.replace(' ', NO_BREAK)}]."
    return Picture(inline(text, key, title, said), caption, said, narrow=True)


def _springs(balance: Balance) -> str:
    count = len(balance.mechanism.springs)
    return "no springs" if not count else "1 spring" if count == 1 else f"{count} springs"
