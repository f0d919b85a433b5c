"""The room that a URDF's links take: their collision geometry, and of a link without any what is drawn of it.

A capsule or a sphere becomes a `Capsule`, anything else a `Shape`. None of it acts on balance: what cannot be read is
left out, with a word.
"""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from pathlib import Path

import numpy as np

from ..model.arrays import vec3
from ..model.elements import Vec3
from ..model.errors import Fault, InputError
from ..model.mechanism import Capsule, Mechanism, Shape
from ..model.names import Names
from ..model.rotation import from_rpy
from ..model.validate import LARGEST_COUNTS
from .mesh_files import mesh_file
from .notes import Notes
from .urdf_known import label
from .xmltree import Document, XmlElement

MOST = min(LARGEST_COUNTS["capsules"], LARGEST_COUNTS["shapes"])


def with_shapes(mechanism: Mechanism, document: Document, notes: Notes) -> Mechanism:
    """The mechanism with the geometry of its links."""
    folder, names = Path(document.file).parent, Names()
    found: list[Capsule | Shape] = []
    for link in document.root.find_all("link"):
        own = [*link.find_all("collision")] or [*link.find_all("visual")]
        for element in own:
            name = element.attributes.get("name") or link.attributes["name"]
            one = _read(element, names.new(name), link.attributes["name"], folder)
            if isinstance(one, str):
                notes.note(f"geometry of {label(link)}", f"it is left out of its room: {one}", element.line)
            elif len(found) < MOST:
                found.append(one)
            else:
                notes.note(f"geometry of {label(link)}", f"it is left out: {MOST} shapes are worked with", element.line)
    capsules = tuple(one for one in found if isinstance(one, Capsule))
    return replace(mechanism, capsules=capsules, shapes=tuple(one for one in found if isinstance(one, Shape)))


def _read(element: XmlElement, name: str, body: str, folder: Path) -> Capsule | Shape | str:
    """A shape, or what is wrong with it."""
    geometry = element.find("geometry")
    solid = next(iter(geometry.children), None) if geometry is not None else None
    if solid is None:
        return "it is empty"
    origin = element.find("origin")
    try:
        xyz, rpy = (_numbers(origin, key, (0.0, 0.0, 0.0)) for key in ("xyz", "rpy"))
        match solid.tag:
            case "sphere":
                made: Capsule | Shape = Capsule(name, body, xyz, xyz, _number(solid, "radius"))
            case "capsule":
                half = _number(solid, "length") / 2 * from_rpy(rpy)[:, 2]
                p_a, p_b = (vec3(np.array(xyz) + sign * half) for sign in (1, -1))
                made = Capsule(name, body, p_a, p_b, _number(solid, "radius"))
            case "box":
                made = Shape(name, body, "box", _numbers(solid, "size"), xyz, rpy)
            case "cylinder":
                wide = 2 * _number(solid, "radius")
                made = Shape(name, body, "cylinder", (wide, wide, _number(solid, "length")), xyz, rpy)
            case "mesh":
                file, scale = solid.attributes.get("filename", ""), _numbers(solid, "scale", (1.0, 1.0, 1.0))
                there = mesh_file(folder, file)
                made = Shape(name, body, "mesh", (0.0, 0.0, 0.0), xyz, rpy, str(there or file), scale)
            case _:
                return f"<{solid.tag}> is unknown"
    except ValueError as error:
        return str(error)
    if isinstance(made, Shape):
        wrong: Fault | None = next(made.faults(), None)
        return made if wrong is None else f"{wrong.path[0]}: {wrong.message}"
    return made if 0 < made.radius < np.inf else f"radius: must be more than 0 m, found {made.radius:g} m"


def _numbers(element: XmlElement | None, key: str, default: Vec3 | None = None) -> Vec3:
    text = None if element is None else element.attributes.get(key)
    if text is None and default is not None:
        return default
    values = [_finite(word, key) for word in (text or "").split()]
    if len(values) != 3:
        raise InputError(f"{key}: expected 3 numbers, found '{text or ''}'")
    return vec3(np.array(values))


def _number(element: XmlElement, key: str) -> float:
    return _finite(element.attributes.get(key, ""), key)


def _finite(word: str, key: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = np.nan
    if not isfinite(value):
        raise InputError(f"{key}: expected a number, found '{word}'")
    return value
