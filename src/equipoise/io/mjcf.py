"""Write a mechanism as a MuJoCo model (MJCF). Nothing is imported from MuJoCo. Choices, where the two differ:

- A spherical joint is a ball: its quaternion is ``Rx(q.x) Ry(q.y) Rz(q.z)``.
- A parallelogram's child is a body of the parent. Its rotation relative to the parent undoes the joints from the common
  ancestor to the parent and repeats those to `follows`: one hinge each through the child's origin, with the axis turned
  round where it undoes, so that every replica has the angle of its original; an equality ties them.
- A coupling with one term is an equality between two joints; with another number, a fixed tendon held at the offset.
- A loop is a connect between two sites; a hinge loop has a second one, 0.1 m along the axes.
- A locked joint (equal limits), which MuJoCo has not, is held by an equality.
- MuJoCo wants mass and inertia on everything that moves: massless bodies are given 1e-13 kg and 1e-12 kg m^2, and then
  all joints a little armature. Neither matters to balance.
- Equalities are MuJoCo's soft constraints: the initial pose must satisfy them (see `joint_map`), drift is not zero. A
  pose that does is the keyframe "assembled", where one is given. Which coordinates steer the loops is a custom text.
- Springs are tendons, and some actuators: see `mjcf_springs`.
- Links are drawn: by capsules, their own or thin ones to their joints. Nothing touches.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal
from xml.etree import ElementTree as ET

import numpy as np

from ..model.elements import Vec3
from ..model.errors import UnsupportedError
from ..model.mechanism import WORLD, Body, Capsule, Joint, Loop, Mechanism, PointMass
from ..model.names import Names
from ..model.rotation import about, from_rpy, to_quaternion
from . import mjcf_springs
from .inertials import Inertials
from .replicas import Replicas, replicas
from .text import numbers

HINGE_ARM = 0.1
"""Between the two points that hold a hinge loop [m]."""
INDEPENDENT, ASSEMBLED = "equipoise.independent", "assembled"
"""Names of the custom text and of the keyframe."""
THIN = 0.03
"""Radius of a link that is drawn without a capsule of its own, as a share of the mean distance between joints."""
ARMATURE = 1e-4
"""As a share of the mechanism's mass times the square of the mean distance between its joints."""
MAX_DEPTH = 400
"""Of nested bodies: MuJoCo's XML parser stops at 500 elements."""
TYPES: dict[str, Literal["hinge", "slide", "ball"]] = {"revolute": "hinge", "prismatic": "slide", "spherical": "ball"}


@dataclass(frozen=True)
class JointValue:
    """What a joint of the exported model is in terms of the mechanism's independent coordinates.

    A hinge or slide is ``offset + sum(ratio * coordinate)`` [rad or m]. A ball's terms are its three coordinates, with
    ratio 1, and its quaternion is that of the rotation ``Rx(first) @ Ry(second) @ Rz(third)``.
    """

    type: Literal["hinge", "slide", "ball"]
    terms: tuple[tuple[str, float], ...]
    offset: float = 0.0

    def qpos(self, values: Mapping[str, float]) -> list[float]:
        """The engine's coordinates of the joint where the mechanism's have these values [rad or m]."""
        terms = [(values[name], ratio) for name, ratio in self.terms]
        if self.type != "ball":
            return [self.offset + sum(value * ratio for value, ratio in terms)]
        R = np.eye(3)
        for axis, (angle, _) in zip(np.eye(3), terms, strict=True):
            R = R @ about(axis, np.array([angle]))[0]
        return to_quaternion(R).tolist()


def joint_map(mechanism: Mechanism) -> dict[str, JointValue]:
    """Every joint of the exported model, replicas and dependent joints included, from the coordinates.

    Raises:
        UnsupportedError: as `to_text`.
    """
    result: dict[str, JointValue] = {}
    waiting = {coupling.joint: coupling for coupling in mechanism.couplings}
    for joint in mechanism.joints:
        if joint.type in TYPES and joint.name not in waiting:
            names = joint.coordinates
            result[joint.name] = JointValue(TYPES[joint.type], tuple((name, 1.0) for name in names))
    types = {joint.name: joint.type for joint in mechanism.joints}
    while waiting:  # each round settles those that depend on settled ones; there are no rings (see `validate`)
        settled = [c for c in waiting.values() if all(other in result for other, _ in c.terms)]
        for coupling in settled:
            terms, offset = defaultdict(float), coupling.offset
            for other, ratio in coupling.terms:
                offset += ratio * result[other].offset
                for coordinate, factor in result[other].terms:
                    terms[coordinate] += ratio * factor
            result[coupling.joint] = JointValue(TYPES[types[coupling.joint]], tuple(terms.items()), offset)
            del waiting[coupling.joint]
    for twin in replicas(mechanism).values():
        result |= {hinge.name: result[hinge.original] for hinge in twin.hinges}
    return result


def to_text(mechanism: Mechanism, assembled: Mapping[str, float] | None = None, warn: bool = True) -> str:
    """Write a mechanism as MJCF, with its springs as tendons, its point masses and the ends of heavy springs as bodies.

    Gravity and masses are exact (to 1e-13 kg on massless bodies); there is no contact.

    Args:
        assembled: coordinate -> value [rad or m] of a pose in which the loops close, for a keyframe.
        warn: where a force cannot be held; who applies `beyond` does not need it.

    Raises:
        UnsupportedError: a spherical joint lies between a parallelogram joint's parent and the body it follows.

    Warns:
        EquipoiseWarning: naming springs whose force MJCF cannot hold, and bodies whose inertia is unknown (a uniform
            sphere of radius 0.05 m is written) or impossible (equal moments with the same sum are written); an inertia
            affects motion, not balance.
    """
    if warn:
        mjcf_springs.warn(mechanism)
    twins = replicas(mechanism)
    sites, connects = _sites(mechanism)
    root = ET.Element("mujoco", model=mechanism.name)
    ET.SubElement(
        root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false", balanceinertia="false",
        boundmass="1e-13", boundinertia="1e-12",
    )  # fmt: skip
    option = ET.SubElement(root, "option", gravity=numbers(mechanism.gravity), timestep="0.001")
    ET.SubElement(option, "flag", contact="disable")
    default = ET.SubElement(root, "default")
    ET.SubElement(default, "equality", solref="0.002 1")
    if any(not body.mass for body in mechanism.bodies):
        ET.SubElement(default, "joint", armature=numbers([_armature(mechanism)]))
    ET.SubElement(default, "geom", contype="0", conaffinity="0", mass="0")
    _bodies(ET.SubElement(root, "worldbody"), mechanism, twins, sites)
    equality, tendon = ET.Element("equality"), ET.Element("tendon")
    actuator = mjcf_springs.write(tendon, mechanism)
    if mechanism.independent:
        ET.SubElement(ET.SubElement(root, "custom"), "text", name=INDEPENDENT, data="\n".join(mechanism.independent))
    _couplings(equality, tendon, mechanism)
    for joint in mechanism.joints:
        if joint.range is not None and joint.range[0] == joint.range[1]:
            ET.SubElement(equality, "joint", joint1=joint.name, polycoef=numbers([joint.range[0], 0, 0, 0, 0]))
        for hinge in twins[joint.name].hinges if joint.name in twins else ():
            ET.SubElement(equality, "joint", joint1=hinge.name, joint2=hinge.original, polycoef="0 1 0 0 0")
    for site_a, site_b in connects:
        ET.SubElement(equality, "connect", site1=site_a, site2=site_b)
    root.extend(element for element in (tendon, equality, actuator) if len(element))
    if assembled is not None:
        qpos = _qpos(root, joint_map(mechanism), assembled)
        ET.SubElement(ET.SubElement(root, "keyframe"), "key", name=ASSEMBLED, qpos=numbers(qpos))
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _qpos(root: ET.Element, joints: dict[str, JointValue], values: Mapping[str, float]) -> list[float]:
    """The engine's coordinates, in the order of its joints: that of the text."""
    return [x for joint in root.iter("joint") if joint.get("type") for x in joints[joint.get("name", "")].qpos(values)]


def _sites(m: Mechanism) -> tuple[dict[str, list[tuple[str, Vec3]]], list[tuple[str, str]]]:
    """The sites of each body, and the pairs of sites that loops hold together."""
    names, sites, connects = Names(), defaultdict(list), []
    for spring in m.springs:
        for mark, (body, p) in spring.places:
            sites[body].append((names.new(f"{spring.name}.{mark}"), p))
    for i, loop in enumerate(m.loops):
        for p_a, p_b in _loop_points(loop):
            pair = names.new(f"loop{i}.a"), names.new(f"loop{i}.b")
            sites[loop.body_a].append((pair[0], p_a))
            sites[loop.body_b].append((pair[1], p_b))
            connects.append(pair)
    return sites, connects


def _loop_points(loop: Loop) -> list[tuple[Vec3, Vec3]]:
    points = [(loop.p_a, loop.p_b)]
    if loop.axis_a is not None and loop.axis_b is not None:
        points.append((_along(loop.p_a, loop.axis_a), _along(loop.p_b, loop.axis_b)))
    return points


def _along(p: Vec3, axis: Vec3) -> Vec3:
    x, y, z = (np.asarray(p) + HINGE_ARM * np.asarray(axis) / np.linalg.norm(axis)).tolist()
    return x, y, z


def _armature(m: Mechanism) -> float:
    """Inertia [kg m^2, or kg] that lets the engine turn what has none."""
    size = float(np.mean([np.linalg.norm(joint.xyz) for joint in m.joints])) if m.joints else 0.0
    return ARMATURE * (sum(body.mass for body in m.bodies) or 1.0) * (size or 1.0) ** 2


def _couplings(equality: ET.Element, tendon: ET.Element, m: Mechanism) -> None:
    names = Names(spring.name for spring in m.springs)
    for coupling in m.couplings:
        if len(coupling.terms) != 1:
            name = names.new(f"{coupling.joint}.coupling")
            element = ET.SubElement(tendon, "fixed", name=name)
            for joint, ratio in ((coupling.joint, -1.0), *coupling.terms):
                ET.SubElement(element, "joint", joint=joint, coef=numbers([-ratio]))
            ET.SubElement(equality, "tendon", tendon1=name, polycoef=numbers([coupling.offset, 0, 0, 0, 0]))
            continue
        ((other, ratio),) = coupling.terms
        polycoef = numbers([coupling.offset, ratio, 0, 0, 0])
        ET.SubElement(equality, "joint", joint1=coupling.joint, joint2=other, polycoef=polycoef)


def _bodies(
    world: ET.Element,
    m: Mechanism,
    twins: dict[str, Replicas],
    sites: dict[str, list[tuple[str, Vec3]]],
) -> None:
    """Fill the world with the tree of bodies, without recursion."""
    inertials = Inertials()
    bodies = {body.name: body for body in m.bodies}
    lumps, children, shapes = _lumps(m), defaultdict(list), _shapes(m)
    wheels = mjcf_springs.wheels(m)
    for joint in m.joints:
        children[joint.parent].append(joint)
    waiting = [(WORLD, world, 0)]
    while waiting:
        name, element, depth = waiting.pop()
        if depth > MAX_DEPTH:
            raise UnsupportedError(f"MJCF cannot hold a chain of more than {MAX_DEPTH} bodies, as that to '{name}'")
        for mark, pulley in wheels[name]:
            mjcf_springs.wheel(element, mark, pulley)
        for site, position in sites[name]:
            ET.SubElement(element, "site", name=site, pos=numbers(position))
        for shape in shapes[name]:
            _shape(element, shape)
        for mass in lumps[name]:
            lump = ET.SubElement(element, "body", name=mass.name, pos=numbers(mass.position))
            inertials.write(lump, Body(mass.name, mass.mass, inertia=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
        for joint in children[name]:
            twin = twins.get(joint.name) or Replicas(from_rpy(joint.rpy), ())
            quat = numbers(to_quaternion(twin.R_PC))
            child = ET.SubElement(element, "body", name=joint.child, pos=numbers(joint.xyz), quat=quat)
            inertials.write(child, bodies[joint.child])
            for hinge in twin.hinges:
                ET.SubElement(child, "joint", name=hinge.name, type="hinge", axis=numbers(hinge.axis), limited="false")
            if joint.type in TYPES:
                _joint(child, joint)
            waiting.append((joint.child, child, depth + 1))
    inertials.warn()


def _joint(body: ET.Element, joint: Joint) -> None:
    element = ET.SubElement(body, "joint", name=joint.name, type=TYPES[joint.type])
    if joint.type != "spherical":
        element.set("axis", numbers(joint.axis))
    limited = joint.range is not None and joint.range[0] < joint.range[1]
    for key, value in (("damping", joint.damping), ("frictionloss", joint.friction)):
        if value:
            element.set(key, numbers([value]))
    if joint.effort and joint.type != "spherical":
        element.set("actuatorfrcrange", numbers([-joint.effort, joint.effort]))
    element.set("limited", str(limited).lower())
    if limited:
        element.set("range", numbers(joint.range or ()))


def _shapes(m: Mechanism) -> dict[str, list[Capsule]]:
    """What to draw of each body: its capsules, or lines without a name to the joints that it carries."""
    shapes: dict[str, list[Capsule]] = defaultdict(list)
    for capsule in m.capsules:
        shapes[capsule.body].append(capsule)
    drawn = {WORLD, *shapes}
    bars = [joint for joint in m.joints if joint.parent not in drawn and any(joint.xyz)]
    radius = THIN * float(np.mean([np.linalg.norm(joint.xyz) for joint in bars])) if bars else 0.0
    for joint in bars:
        shapes[joint.parent].append(Capsule("", joint.parent, (0.0, 0.0, 0.0), joint.xyz, radius))
    return shapes


def _shape(body: ET.Element, shape: Capsule) -> None:
    element = ET.SubElement(body, "geom", size=numbers([shape.radius]))
    if shape.name:
        element.set("name", shape.name)
    if shape.p_a == shape.p_b:
        element.set("pos", numbers(shape.p_a))
    else:
        element.set("type", "capsule")
        element.set("fromto", numbers((*shape.p_a, *shape.p_b)))


def _lumps(m: Mechanism) -> dict[str, list[PointMass]]:
    """The point masses on each body, the ends of heavy springs included."""
    names = Names(m.body_names)
    masses = [replace(mass, name=names.new(mass.name)) for mass in m.masses if mass.mass]
    for spring in m.springs:
        for letter, (body, mass, position) in zip("ab", spring.lumps(), strict=False):
            if mass:
                masses.append(PointMass(names.new(f"{spring.name}.{letter}"), body, mass, position))
    lumps = defaultdict(list)
    for mass in masses:
        lumps[mass.body].append(mass)
    return lumps
