"""Write a mechanism as URDF, which holds trees of fixed, revolute and prismatic joints with single-term couplings."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import replace
from xml.etree import ElementTree as ET

from ..model.errors import EquipoiseWarning, UnsupportedError
from ..model.mechanism import WORLD, Body, Joint, Mechanism
from ..model.names import Names
from .text import numbers

GRAVITY = (0.0, 0.0, -9.81)
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
POINT = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""The inertia of a point."""
TRAVEL = 1000.0
"""Stands for no limit on a prismatic joint [m], which URDF does not let go without one."""


def weld(root: str) -> Joint:
    """The joint that holds a URDF's root link in the world when the file has no link named world."""
    return Joint(f"world_to_{root}", "fixed", WORLD, root)


def to_text(mechanism: Mechanism) -> str:
    """Write a mechanism as URDF.

    A spherical joint becomes three continuous joints ``name.x, name.y, name.z`` with massless links between; a point
    mass becomes a link on a fixed joint; a single-term coupling becomes a mimic. Effort and velocity limits, which a
    mechanism does not know and URDF requires, are written as 0. Reading a URDF, writing it and reading that gives the
    same mechanism.

    Raises:
        UnsupportedError: for parallelogram joints, loops and couplings without exactly one term.

    Warns:
        EquipoiseWarning: for what is left out or filled in: springs with their masses, gravity other than 9.81 m/s^2
            along -z, unknown inertias, and travel without limits.
    """
    _refuse(mechanism)
    _warn(mechanism)
    robot = ET.Element("robot", name=mechanism.name)
    links, joints = Names(mechanism.body_names), Names(joint.name for joint in mechanism.joints)
    mimic = {coupling.joint: coupling for coupling in mechanism.couplings}
    dropped = _automatic_weld(mechanism)
    if dropped is None:
        ET.SubElement(robot, "link", name=WORLD)
    for body in mechanism.bodies:
        _link(robot, body)
    for joint in mechanism.joints:
        if joint is dropped:
            continue
        if joint.type == "spherical":
            _spherical(robot, joint, links, joints)
            continue
        element = _joint(robot, joint)
        if joint.name in mimic:
            coupling = mimic[joint.name]
            (other, ratio), offset = coupling.terms[0], coupling.offset
            ET.SubElement(element, "mimic", joint=other, multiplier=numbers([ratio]), offset=numbers([offset]))
    for mass in mechanism.masses:
        name = links.new(mass.name)
        _link(robot, Body(name, mass.mass, inertia=POINT))
        _joint(robot, Joint(joints.new(f"{mass.name}_joint"), "fixed", mass.body, name, mass.position))
    ET.indent(robot)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(robot, encoding="unicode") + "\n"


def _refuse(m: Mechanism) -> None:
    reasons = [
        f"URDF cannot hold the parallelogram joint '{joint.name}'; yaml and mjcf can"
        for joint in m.joints
        if joint.type == "parallelogram"
    ]
    reasons += [
        f"URDF cannot hold the coupling of joint '{coupling.joint}', which has {len(coupling.terms)} terms, not one; "
        "yaml and mjcf can"
        for coupling in m.couplings
        if len(coupling.terms) != 1
    ]
    reasons += [
        f"URDF cannot hold the loop between '{loop.body_a}' and '{loop.body_b}'; yaml and mjcf can" for loop in m.loops
    ]
    if reasons:
        raise UnsupportedError("\n".join(reasons))


def _warn(m: Mechanism) -> None:
    messages = []
    if m.springs:
        messages.append(f"URDF cannot hold springs: {len(m.springs)} springs left out")
    if m.gravity != GRAVITY:
        messages.append(f"URDF cannot hold gravity: {list(m.gravity)} m/s^2 left out")
    unknown = [body.name for body in m.bodies if body.mass and body.inertia is None]
    if unknown:
        messages.append(f"URDF requires an inertia: written as zero for {_quoted(unknown)}")
    unlimited = [joint.name for joint in m.joints if joint.type == "prismatic" and joint.range is None]
    if unlimited:
        messages.append(f"URDF requires limits on prismatic joints: {_quoted(unlimited)} written with {TRAVEL:g} m")
    for message in messages:
        warnings.warn(message, EquipoiseWarning, stacklevel=3)


def _automatic_weld(m: Mechanism) -> Joint | None:
    """The weld that reading adds again, when nothing else is fixed to the world."""
    at_world = [joint for joint in m.joints if joint.parent == WORLD]
    if len(at_world) == 1 and at_world[0] == weld(at_world[0].child) and all(mass.body != WORLD for mass in m.masses):
        return at_world[0]
    return None


def _link(robot: ET.Element, body: Body) -> None:
    link = ET.SubElement(robot, "link", name=body.name)
    if not body.mass and body.inertia is None:
        return
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=numbers(body.com), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=numbers([body.mass]))
    moments = zip(MOMENTS, body.inertia or POINT, strict=True)
    ET.SubElement(inertial, "inertia", {key: numbers([value]) for key, value in moments})


def _joint(robot: ET.Element, joint: Joint) -> ET.Element:
    kind = "continuous" if joint.type == "revolute" and joint.range is None else joint.type
    element = ET.SubElement(robot, "joint", name=joint.name, type=kind)
    ET.SubElement(element, "origin", xyz=numbers(joint.xyz), rpy=numbers(joint.rpy))
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    if kind != "fixed":
        ET.SubElement(element, "axis", xyz=numbers(joint.axis))
    if kind in ("revolute", "prismatic"):
        lower, upper = (numbers([limit]) for limit in joint.range or (-TRAVEL, TRAVEL))
        ET.SubElement(element, "limit", lower=lower, upper=upper, effort=numbers([joint.effort or 0.0]), velocity="0")
    elif joint.effort:
        ET.SubElement(element, "limit", effort=numbers([joint.effort]), velocity="0")
    if joint.damping or joint.friction:
        ET.SubElement(element, "dynamics", damping=numbers([joint.damping]), friction=numbers([joint.friction]))
    return element


def _spherical(robot: ET.Element, joint: Joint, links: Names, joints: Names) -> None:
    parent, xyz, rpy = joint.parent, joint.xyz, joint.rpy
    for letter, axis in (("x", (1.0, 0.0, 0.0)), ("y", (0.0, 1.0, 0.0)), ("z", (0.0, 0.0, 1.0))):
        child = joint.child
        if letter != "z":
            child = links.new(f"{joint.name}.{letter}")
            _link(robot, Body(child))
        name = joints.new(f"{joint.name}.{letter}")
        _joint(
            robot, replace(joint, name=name, type="revolute", parent=parent, child=child, xyz=xyz, rpy=rpy, axis=axis)
        )
        parent, xyz, rpy = child, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


def _quoted(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
