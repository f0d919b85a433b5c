"""<loop_joint> of URDF, which simulators and exporters write: a frame on each of two links, and how these stay joined.

In the two frames, of the type: spherical, the origins coincide; revolute or continuous, the axes too (x unless <axis>
says otherwise); fixed, all of them.
"""

from __future__ import annotations

from math import isfinite

import numpy as np

from ..model.arrays import Array, vec3
from ..model.mechanism import Loop
from ..model.rotation import from_rpy
from .notes import Notes
from .urdf_known import label
from .xmltree import XmlElement

TYPES = ("spherical", "revolute", "continuous", "fixed")
ARM = 0.1
"""From the hinge to the point that makes a fixed loop of it [m]."""


def loops(root: XmlElement, notes: Notes) -> list[tuple[Loop, XmlElement]]:
    """The loops of a robot, each with its element; what is wrong is refused in `notes`."""
    found: list[tuple[Loop, XmlElement]] = []
    for element in root.find_all("loop_joint"):
        kind, before = element.attributes.get("type", "spherical"), len(notes.faults)
        ends = [_end(element, tag, notes) for tag in ("link1", "link2")]
        axis = _vector(element.find("axis"), "xyz", (1.0, 0.0, 0.0), element, notes)
        if kind not in TYPES:
            notes.refuse(
                label(element), f"is of no type that is known, '{kind}'; valid: {', '.join(TYPES)}", element.line
            )
        if len(notes.faults) > before:
            continue
        (link_a, p_a, R_a), (link_b, p_b, R_b) = ends
        if kind == "spherical":
            found.append((Loop(link_a, vec3(p_a), link_b, vec3(p_b)), element))
            continue
        axes = vec3(R_a @ axis), vec3(R_b @ axis)
        found.append((Loop(link_a, vec3(p_a), link_b, vec3(p_b), *axes), element))
        if kind == "fixed":
            aside = ARM * np.eye(3)[int(np.argmin(np.abs(axis)))]
            found.append((Loop(link_a, vec3(p_a + R_a @ aside), link_b, vec3(p_b + R_b @ aside)), element))
    return found


def _end(element: XmlElement, tag: str, notes: Notes) -> tuple[str, Array, Array]:
    end = element.find(tag)
    if end is None or not end.attributes.get("link"):
        notes.refuse(label(element), f"needs <{tag} link='...'/>", element.line)
        return "", np.zeros(3), np.eye(3)
    xyz, rpy = (_vector(end, key, (0.0, 0.0, 0.0), element, notes) for key in ("xyz", "rpy"))
    return end.attributes["link"], xyz, from_rpy(rpy)


def _vector(
    at: XmlElement | None, key: str, default: tuple[float, float, float], element: XmlElement, notes: Notes
) -> Array:
    words = (at.attributes.get(key) if at is not None else None) or " ".join(map(str, default))
    try:
        found = np.array([float(word) for word in words.split()])
    except ValueError:
        found = np.zeros(0)
    if found.shape == (3,) and all(isfinite(x) for x in found):
        return found
    notes.refuse(label(element), f"needs 3 numbers as {key}, found '{words}'", element.line)
    return np.array(default)
