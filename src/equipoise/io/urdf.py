"""URDF: read here, written by `urdf_write`.

Kinematics, loops, inertia, joint springs, friction and damping are read. What acts on no balance is skipped, what is
unknown is named: see `urdf_known`. A detail that can be read in one way only is read so, with a warning:

- A <mimic> on a fixed joint is ignored; a follower's own limits do not restrict its leader, as in ROS.
- Limits that are missing, or 0 and 0, are what exporters leave where nobody has set any: the joint is unlimited.
- An <inertial> without a mass is massless, one without an inertia has an unknown one.
"""

from __future__ import annotations

import os
import re
import warnings
from dataclasses import replace
from math import isfinite

import numpy as np

from ..model.elements import Vec3
from ..model.errors import EquipoiseWarning, Fault, InputError, Path, nearest
from ..model.mechanism import WORLD, Body, Coupling, Joint, JointType, Mechanism
from ..model.rotation import from_rpy
from ..model.validate import FARTHEST
from . import files, freed
from .lint import inertia_lint
from .notes import Notes
from .urdf_joints import chained, effort, unrestricted
from .urdf_known import CONVERTED, label, refuse_xacro, short, unread
from .urdf_loops import loops
from .urdf_shapes import with_shapes
from .urdf_springs import springs
from .urdf_write import MOMENTS, to_text, weld
from .xmltree import Document, XmlElement

__all__ = ["read", "read_text", "to_text"]

TYPES: dict[str, JointType] = {
    "fixed": "fixed",
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "floating": "spherical",
    "planar": "revolute",
}
"""URDF's joint types that are read, and ours; of the last two it is the last joint of a chain."""

UNLIMITED = {
    "revolute": "read as unlimited, as type='continuous' says; type='fixed' locks it",
    "prismatic": "read as unlimited, and judged over +-1 m; type='fixed' locks it",
}
"""How a joint without usable limits is read, by its type."""
# possessive, so that no text is gone through twice
_NUMBER = re.compile(r"[-+]?(\d++\.?\d*+|\.\d++)([eE][-+]?\d++)?+", re.ASCII)
_FIELDS = {"com": "inertial", "mass": "inertial", "inertia": "inertial", "range": "limit", "xyz": "origin",
           "damping": "dynamics", "friction": "dynamics"}  # fmt: skip
"""Where URDF keeps a field of ours that has another name there."""


def read(path: str | os.PathLike[str], base: str | None = None) -> Mechanism:
    """Read a URDF file.

    Args:
        path: the file; meshes it names are needed for clearance only.
        base: "fixed" holds what a floating joint carries where it is drawn, "free" lets it be free.

    Returns:
        The mechanism, in the file's order. A link named "world" is the world frame; without it the root link is welded
        to the world by a fixed joint ``world_to_<root>``, which comes first. A mimic joint becomes a coupling.

    Raises:
        InputError: with everything that is wrong with the file, each at its line.

    Warns:
        EquipoiseWarning: for each kind of thing that is read otherwise than it stands there, or not at all, and for
            each inertia that looks wrong (see `lint.inertia_lint`).
    """
    return read_text(files.read_text(path), os.fspath(path), base)


def read_text(text: str, file: str, base: str | None = None) -> Mechanism:
    """Read the text of a URDF file; `file` is its name for errors. See `read`."""
    document = Document(text, file)
    refuse_xacro(document)
    reader = _Reader(document, base)
    mechanism = with_shapes(reader.mechanism(), document, reader.notes)
    unread(document, reader.notes)
    reader.notes.close()
    for message in inertia_lint(mechanism):
        warnings.warn(message, EquipoiseWarning, stacklevel=3)
    return mechanism


class _Reader:
    """Turns the elements of one document into values, collecting faults on the way.

    What cannot be read is replaced by a harmless value, so that the rest can be judged and no fault follows from it.
    """

    def __init__(self, document: Document, base: str | None) -> None:
        self.document, self.base, self.notes = document, base, Notes(document.file)
        self.faults = self.notes.faults
        self.broken = False  # a name is missing, so the tree cannot be judged

    def mechanism(self) -> Mechanism:
        root = self.document.root
        if root.tag != "robot":
            how = f": {CONVERTED['.sdf']}" if root.tag == "sdf" else ""
            self._fault(root, (), f"expected a URDF file, whose root element is <robot>, found <{root.tag}>{how}")
            raise self._error()
        name = self._text(root, ("robot",), "name")
        links = [(self._body(link), link) for link in root.find_all("link")]
        joints = [(self._joint(joint), joint) for joint in root.find_all("joint")]
        couplings = self._couplings([joint for joint, _ in joints], root)
        closed = loops(root, self.notes)
        elastic = springs(root, [joint for joint, _ in joints], self.notes)
        if not links:
            self._fault(root, ("robot",), "has no link")
        if self.broken or not links:
            raise self._error()
        joints = self._welds(links, [joint for joint, _ in joints]) + unrestricted(joints, couplings, self.notes)
        links = [(body, element) for body, element in links if body.name != WORLD]
        links, joints, floating = chained(links, joints)
        try:
            mechanism = Mechanism(
                name=name,
                bodies=tuple(body for body, _ in links),
                joints=tuple(joint for joint, _ in joints),
                couplings=tuple(coupling for coupling, _ in couplings),
                loops=tuple(loop for loop, _ in closed),
                springs=elastic,
            )
        except InputError as error:
            places = {"bodies": links, "joints": joints, "couplings": couplings, "loops": closed,
                      "springs": [(spring, root) for spring in elastic]}  # fmt: skip
            for fault in error.faults:
                if len(fault.path) < 2:  # of the whole mechanism
                    self._fault(root, fault.path, fault.message)
                    continue
                kind, i, *rest = fault.path
                element = places[str(kind)][int(i)][1]
                path = (label(element), *(_FIELDS.get(str(key), key) for key in rest))
                self._fault(element, path, fault.message, fault.choices)
            raise self._error() from None
        for joint, element in floating:
            if self.base is None and not self.faults and not freed.held(mechanism, joint):
                self._fault(element, (), f"{label(element)} {freed.FREE}")
        if self.faults:
            raise self._error()
        return mechanism

    def _error(self) -> InputError:
        return InputError(sorted(self.faults, key=lambda fault: (fault.line or 0, fault.column or 0)))

    def _welds(self, links: list[tuple[Body, XmlElement]], joints: list[Joint]) -> list[tuple[Joint, XmlElement]]:
        """A joint from the world to the root link, if that is not the world itself."""
        names = {body.name for body, _ in links}
        children = {joint.child for joint in joints}
        roots = [(body.name, element) for body, element in links if body.name not in children]
        if len(roots) > 1 and children <= names:
            listed = ", ".join(f"'{name}'" for name, _ in roots)
            self._fault(
                roots[1][1],
                (label(roots[1][1]),),
                f"more than one root link: {listed}; all but one must be the child of a joint",
            )
        return [(weld(name), element) for name, element in roots if name != WORLD]

    def _body(self, link: XmlElement) -> Body:
        name = self._text(link, ("link",), "name")
        inertial = link.find("inertial")
        if inertial is None or name == WORLD:
            return Body(name)
        path = (label(link), "inertial")
        mass = self._child(inertial, path, "mass", "value", "its mass is missing, and taken as 0 kg")
        xyz, rpy = self._origin(inertial, path)
        if inertial.find("inertia") is None:
            self.notes.note(label(link), "its inertia is missing: balance does not need it, motion does", inertial.line)
            return Body(name, mass, xyz)
        ixx, iyy, izz, ixy, ixz, iyz = (
            self._child(inertial, path, "inertia", key, "a part of its inertia is missing, and taken as 0 kg m^2")
            for key in MOMENTS
        )
        if any(rpy):
            R = from_rpy(rpy)
            T = R @ np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]) @ R.T
            (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = T.tolist()
        return Body(name, mass, xyz, (ixx, iyy, izz, ixy, ixz, iyz))

    def _joint(self, joint: XmlElement) -> Joint:
        name = self._text(joint, ("joint",), "name")
        path = (label(joint),)
        ends = []
        for key in ("parent", "child"):
            end = joint.find(key)
            if end is None:
                self._fault(joint, (*path, key), f"missing: a joint needs <{key} link='...'/>")
                self.broken = True
            ends.append("" if end is None else self._text(end, (*path, key), "link"))
        kind = self._type(joint, path)
        xyz, rpy = self._origin(joint, path)
        axis: Vec3 = (1.0, 0.0, 0.0)
        if kind == "fixed" or (kind == "floating" and self.base == "fixed"):
            return Joint(name, "fixed", ends[0], ends[1], xyz, rpy)
        element = joint.find("axis")
        if element is not None:
            axis = self._vector(element, (*path, "axis"), "xyz", axis)
        limits = self._limits(joint, path, kind) if kind in ("revolute", "prismatic") else None
        found = Joint(name, TYPES[kind], ends[0], ends[1], xyz, rpy, axis, limits, effort=effort(joint, kind))
        if (dynamics := joint.find("dynamics")) is None:
            return found
        damping, friction = (self._number(dynamics, (*path, "dynamics"), key, 0.0) for key in ("damping", "friction"))
        return replace(found, damping=damping, friction=friction)

    def _type(self, joint: XmlElement, path: Path) -> str:
        kind = joint.attributes.get("type")
        if kind in TYPES:
            return kind
        message = "missing" if kind is None else f"there is no joint type {nearest(short(kind), TYPES)}"
        self._fault(joint, (*path, "type"), message, tuple(TYPES))
        return "continuous"

    def _limits(self, joint: XmlElement, path: Path, kind: str) -> tuple[float, float] | None:
        limit = joint.find("limit")
        if limit is None or not {"lower", "upper"} & limit.attributes.keys():
            self.notes.note(str(path[0]), f"its limits are missing: {UNLIMITED[kind]}", (limit or joint).line)
            return None
        before = len(self.faults)
        # URDF: the one that is not given is zero
        lower, upper = (self._number(limit, (*path, "limit"), key, 0.0) for key in ("lower", "upper"))
        nobody = "its range is a single value, 0 to 0" if lower == upper == 0.0 else "its limits are beyond all bounds"
        if lower == upper == 0.0 or (lower <= -FARTHEST and upper >= FARTHEST):
            self.notes.note(str(path[0]), f"{nobody}: {UNLIMITED[kind]}", limit.line)
            return None
        return (lower, upper) if len(self.faults) == before else None

    def _couplings(self, joints: list[Joint], root: XmlElement) -> list[tuple[Coupling, XmlElement]]:
        types, found = {joint.name: joint.type for joint in joints}, []
        for joint, element in zip(joints, root.find_all("joint"), strict=True):
            if (mimic := element.find("mimic")) is None:
                continue
            path = (label(element), "mimic")
            ratio, offset = (self._number(mimic, path, key, x) for key, x in (("multiplier", 1.0), ("offset", 0.0)))
            leader = self._text(mimic, path, "joint")
            if joint.type == "fixed":
                self.notes.note(label(element), "<mimic> on a fixed joint is ignored", mimic.line)
            elif leader and types.get(leader, "fixed") == "fixed":
                what = f"a fixed joint, '{leader}'" if leader in types else f"no joint {nearest(leader, types)}"
                self.notes.note(label(element), f"it moves by itself, for <mimic> names {what}", mimic.line)
            else:
                found.append((Coupling(joint.name, ((leader, ratio),), offset), element))
        return found

    def _origin(self, element: XmlElement, path: Path) -> tuple[Vec3, Vec3]:
        origin, zero = element.find("origin"), (0.0, 0.0, 0.0)
        if origin is None:
            return zero, zero
        path = (*path, "origin")
        return self._vector(origin, path, "xyz", zero), self._vector(origin, path, "rpy", zero)

    def _child(self, inertial: XmlElement, path: Path, tag: str, key: str, missing: str) -> float:
        child = inertial.find(tag)
        if child is not None and key in child.attributes:
            return self._number(child, (*path, tag), key)
        self.notes.note(str(path[0]), missing, (child or inertial).line)
        return 0.0

    def _text(self, element: XmlElement, path: Path, key: str) -> str:
        value = element.attributes.get(key, "")
        if not value:
            self._fault(element, (*path, key), "missing")
            self.broken = True
        return value

    def _number(self, element: XmlElement, path: Path, key: str, default: float | None = None) -> float:
        text = element.attributes.get(key)
        if text is None:
            if default is None:
                self._fault(element, (*path, key), "missing")
            return default or 0.0
        return (self._floats(element, (*path, key), text, 1) or [0.0])[0]

    def _vector(self, element: XmlElement, path: Path, key: str, default: Vec3) -> Vec3:
        text = element.attributes.get(key)
        values = None if text is None else self._floats(element, (*path, key), text, 3)
        return default if values is None else (values[0], values[1], values[2])

    def _floats(self, element: XmlElement, path: Path, text: str, count: int) -> list[float] | None:
        words = text.split()
        if len(words) == count and all(_NUMBER.fullmatch(word) for word in words):
            values = [float(word) for word in words]
            if all(isfinite(value) for value in values):
                return values
        expected = "a number" if count == 1 else f"{count} numbers"
        self._fault(element, path, f"expected {expected}, found '{short(text)}'")
        return None

    def _fault(self, element: XmlElement, path: Path, message: str, choices: tuple[str, ...] = ()) -> None:
        self.faults.append(self.document.place(Fault(path, message, choices), element))
