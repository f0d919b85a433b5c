"""URDF: read here, written by `urdf_write`.

Kinematics, inertia, friction and damping are read; visual, collision, transmission, gazebo and safety are skipped.
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
from . import files
from .lint import inertia_lint
from .urdf_write import MOMENTS, to_text, weld
from .xmltree import Document, Element

__all__ = ["read", "read_text", "to_text"]

TYPES: dict[str, JointType] = {
    "fixed": "fixed",
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
}
"""URDF's joint types that are read, and ours."""

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
_FIELDS = {"com": "inertial", "mass": "inertial", "inertia": "inertial", "range": "limit", "xyz": "origin",
           "damping": "dynamics", "friction": "dynamics"}  # fmt: skip
"""Where URDF keeps a field of ours that has another name there."""


def read(path: str | os.PathLike[str]) -> Mechanism:
    """Read a URDF file.

    Args:
        path: the file; meshes it names are not needed.

    Returns:
        The mechanism, in the file's order. A link named "world" is the world frame; without it the root link is welded
        to the world by a fixed joint ``world_to_<root>``, which comes first. A mimic joint becomes a coupling.

    Raises:
        InputError: with everything that is wrong with the file, each at its line.

    Warns:
        EquipoiseWarning: for each inertia that looks wrong (see `lint.inertia_lint`).
    """
    return _read(files.read_text(path), os.fspath(path))


def read_text(text: str, file: str) -> Mechanism:
    """Read the text of a URDF file; `file` is its name for errors. See `read`."""
    return _read(text, file)


def _read(text: str, file: str) -> Mechanism:
    document = Document(text, file)
    _refuse_xacro(document)
    mechanism = _Reader(document).mechanism()
    for message in inertia_lint(mechanism):
        warnings.warn(message, EquipoiseWarning, stacklevel=3)
    return mechanism


def _refuse_xacro(document: Document) -> None:
    spaces = {"xacro:"}
    for element in document.root.walk():
        for key, value in element.attributes.items():
            if key.startswith("xmlns:") and "xacro" in value:
                spaces.add(key.removeprefix("xmlns:") + ":")
            elif "${" in value or "$(" in value:
                _xacro(document, element, f"{key}='{_short(value)}'")
        if element.tag.startswith(tuple(spaces)):
            _xacro(document, element, f"<{element.tag}>")


def _xacro(document: Document, element: Element, found: str) -> None:
    fault = Fault((), f"found {found}: this is a xacro file; expand it with xacro first (xacro FILE > robot.urdf)")
    raise InputError(document.place(fault, element))


class _Reader:
    """Turns the elements of one document into values, collecting faults on the way.

    What cannot be read is replaced by a harmless value, so that the rest can be judged and no fault follows from it.
    """

    def __init__(self, document: Document) -> None:
        self.document = document
        self.faults: list[Fault] = []
        self.broken = False  # a name is missing, so the tree cannot be judged

    def mechanism(self) -> Mechanism:
        root = self.document.root
        if root.tag != "robot":
            self._fault(root, (), f"expected a URDF file, whose root element is <robot>, found <{root.tag}>")
            raise self._error()
        name = self._text(root, ("robot",), "name")
        links = [(self._body(link), link) for link in root.find_all("link")]
        joints = [(self._joint(joint), joint) for joint in root.find_all("joint")]
        mimics = [(joint, joint.find("mimic")) for joint in root.find_all("joint")]
        couplings = [(self._coupling(joint, mimic), joint) for joint, mimic in mimics if mimic is not None]
        if not links:
            self._fault(root, ("robot",), "has no link")
        if self.broken or not links:
            raise self._error()
        joints = self._welds(links, [joint for joint, _ in joints]) + joints
        links = [(body, element) for body, element in links if body.name != WORLD]
        try:
            mechanism = Mechanism(
                name=name,
                bodies=tuple(body for body, _ in links),
                joints=tuple(joint for joint, _ in joints),
                couplings=tuple(coupling for coupling, _ in couplings),
            )
        except InputError as error:
            places = {"bodies": links, "joints": joints, "couplings": couplings}
            for fault in error.faults:
                if len(fault.path) < 2:  # of the whole mechanism
                    self._fault(root, fault.path, fault.message)
                    continue
                kind, i, *rest = fault.path
                element = places[str(kind)][int(i)][1]
                path = (_label(element), *(_FIELDS.get(str(key), key) for key in rest))
                self._fault(element, path, fault.message, fault.choices)
            raise self._error() from None
        if self.faults:
            raise self._error()
        return mechanism

    def _error(self) -> InputError:
        return InputError(sorted(self.faults, key=lambda fault: (fault.line or 0, fault.column or 0)))

    def _welds(self, links: list[tuple[Body, Element]], joints: list[Joint]) -> list[tuple[Joint, Element]]:
        """A joint from the world to the root link, if that is not the world itself."""
        names = {body.name for body, _ in links}
        children = {joint.child for joint in joints}
        roots = [(body.name, element) for body, element in links if body.name not in children]
        if len(roots) > 1 and children <= names:
            listed = ", ".join(f"'{name}'" for name, _ in roots)
            self._fault(
                roots[1][1],
                (_label(roots[1][1]),),
                f"more than one root link: {listed}; all but one must be the child of a joint",
            )
        return [(weld(name), element) for name, element in roots if name != WORLD]

    def _body(self, link: Element) -> Body:
        name = self._text(link, ("link",), "name")
        inertial = link.find("inertial")
        if inertial is None or name == WORLD:
            return Body(name)
        path = (_label(link), "inertial")
        mass = self._child(inertial, path, "mass", "value")
        ixx, iyy, izz, ixy, ixz, iyz = (self._child(inertial, path, "inertia", key) for key in MOMENTS)
        xyz, rpy = self._origin(inertial, path)
        if any(rpy):
            R = from_rpy(rpy)
            T = R @ np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]) @ R.T
            (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = T.tolist()
        return Body(name, mass, xyz, (ixx, iyy, izz, ixy, ixz, iyz))

    def _joint(self, joint: Element) -> Joint:
        name = self._text(joint, ("joint",), "name")
        path = (_label(joint),)
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
        if kind == "fixed":
            return Joint(name, "fixed", ends[0], ends[1], xyz, rpy)
        element = joint.find("axis")
        if element is not None:
            axis = self._vector(element, (*path, "axis"), "xyz", axis)
        limits = None if kind == "continuous" else self._limits(joint, path, kind)
        found = Joint(name, TYPES[kind], ends[0], ends[1], xyz, rpy, axis, limits)
        if (dynamics := joint.find("dynamics")) is None:
            return found
        damping, friction = (self._number(dynamics, (*path, "dynamics"), key, 0.0) for key in ("damping", "friction"))
        return replace(found, damping=damping, friction=friction)

    def _type(self, joint: Element, path: Path) -> str:
        kind = joint.attributes.get("type")
        if kind in TYPES:
            return kind
        if kind is None:
            message = "missing"
        elif kind in ("floating", "planar"):
            message = f"a {kind} joint cannot be balanced: fix the base or remove the joint"
        else:
            message = f"there is no joint type {nearest(_short(kind), TYPES)}"
        self._fault(joint, (*path, "type"), message, tuple(TYPES))
        return "continuous"

    def _limits(self, joint: Element, path: Path, kind: str) -> tuple[float, float] | None:
        limit = joint.find("limit")
        if limit is None or not {"lower", "upper"} & limit.attributes.keys():
            instead = ", or type='continuous'" if kind == "revolute" else ""
            message = f"missing: URDF requires <limit lower='...' upper='...'/> on a {kind} joint{instead}"
            self._fault(limit or joint, (*path, "limit"), message)
            return None
        before = len(self.faults)
        # URDF: the one that is not given is zero
        lower, upper = (self._number(limit, (*path, "limit"), key, 0.0) for key in ("lower", "upper"))
        return (lower, upper) if len(self.faults) == before else None

    def _coupling(self, joint: Element, mimic: Element) -> Coupling:
        path = (_label(joint), "mimic")
        ratio, offset = self._number(mimic, path, "multiplier", 1.0), self._number(mimic, path, "offset", 0.0)
        return Coupling(joint.attributes.get("name", ""), ((self._text(mimic, path, "joint"), ratio),), offset)

    def _origin(self, element: Element, path: Path) -> tuple[Vec3, Vec3]:
        origin, zero = element.find("origin"), (0.0, 0.0, 0.0)
        if origin is None:
            return zero, zero
        path = (*path, "origin")
        return self._vector(origin, path, "xyz", zero), self._vector(origin, path, "rpy", zero)

    def _child(self, inertial: Element, path: Path, tag: str, key: str) -> float:
        child = inertial.find(tag)
        if child is not None:
            return self._number(child, (*path, tag), key)
        if key in ("value", "ixx"):  # once for the six numbers of an inertia
            hint = "; if it is not known, write 0: only simulation uses it" if tag == "inertia" else ""
            self._fault(inertial, (*path, tag), f"missing: URDF requires it in <inertial>{hint}")
        return 0.0

    def _text(self, element: Element, path: Path, key: str) -> str:
        value = element.attributes.get(key, "")
        if not value:
            self._fault(element, (*path, key), "missing")
            self.broken = True
        return value

    def _number(self, element: Element, path: Path, key: str, default: float | None = None) -> float:
        text = element.attributes.get(key)
        if text is None:
            if default is None:
                self._fault(element, (*path, key), "missing")
            return default or 0.0
        return (self._floats(element, (*path, key), text, 1) or [0.0])[0]

    def _vector(self, element: Element, path: Path, key: str, default: Vec3) -> Vec3:
        text = element.attributes.get(key)
        values = None if text is None else self._floats(element, (*path, key), text, 3)
        return default if values is None else (values[0], values[1], values[2])

    def _floats(self, element: Element, path: Path, text: str, count: int) -> list[float] | None:
        words = text.split()
        if len(words) == count and all(_NUMBER.fullmatch(word) for word in words):
            values = [float(word) for word in words]
            if all(isfinite(value) for value in values):
                return values
        expected = "a number" if count == 1 else f"{count} numbers"
        self._fault(element, path, f"expected {expected}, found '{_short(text)}'")
        return None

    def _fault(self, element: Element, path: Path, message: str, choices: tuple[str, ...] = ()) -> None:
        self.faults.append(self.document.place(Fault(path, message, choices), element))


def _label(element: Element) -> str:
    return f"{element.tag} '{element.attributes.get('name', '')}'"


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
