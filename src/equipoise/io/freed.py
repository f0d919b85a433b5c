"""A joint with several coordinates, as a chain of joints with one or three and massless bodies between."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..model.arrays import Array, vec3
from ..model.elements import Vec3
from ..model.mechanism import WORLD, Body, Joint, JointType, Mechanism
from ..model.names import Names

X, Y, Z = np.eye(3)
STEPS: Mapping[str, tuple[JointType, ...]] = {
    "floating": ("prismatic", "prismatic", "prismatic", "spherical"),
    "planar": ("prismatic", "prismatic", "revolute"),
}
"""The joints of each kind, from the parent on; the last one has the name of the whole, the slides a letter more."""
FREE = "is free, and nothing holds what it carries: it falls; --base fixed holds it where it is drawn"


def chain(kind: str, joint: Joint, bodies: Names) -> tuple[list[Body], list[Joint]]:
    """The chain in the place of `joint`, and its massless bodies.

    A floating joint slides along the axes of its frame, then turns as a ball does; a planar one slides across its
    axis, then turns about it.
    """
    axes = [X, Y, Z, Z] if kind == "floating" else _across(joint.axis)
    made, joints, parent, place = [], [], joint.parent, (joint.xyz, joint.rpy)
    for step, axis, letter in zip(STEPS[kind], axes, "xyz ", strict=False):
        last = step != "prismatic"
        child = joint.child if last else bodies.new(f"{joint.name} {letter}")
        name = joint.name if last else f"{joint.name} {letter}"
        found = replace(joint, name=name, type=step, parent=parent, child=child, xyz=place[0], rpy=place[1], range=None)
        joints.append(found if step == "spherical" else replace(found, axis=vec3(axis)))
        made += [] if last else [Body(child)]
        parent, place = child, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return made, joints


def held(mechanism: Mechanism, joint: str) -> bool:
    """Whether a loop or a spring joins what hangs on the joint with anything else."""
    below = {next(j.child for j in mechanism.joints if j.name == joint)}
    for _ in mechanism.joints:
        more = {j.child for j in mechanism.joints if j.parent in below} - below
        if not more:
            break
        below |= more
    ends = [{x.body_a, x.body_b} for x in mechanism.loops]
    ends += [{body for body, _ in spring.ends} for spring in mechanism.springs]
    return any(bodies & below and bodies - below for bodies in ends)


def free_base(mechanism: Mechanism) -> Mechanism:
    """With a floating joint in the place of every fixed one that holds a body with joints in the world."""
    carriers = {joint.parent for joint in mechanism.joints}
    names, bodies, joints = Names(mechanism.body_names), [*mechanism.bodies], []
    for joint in mechanism.joints:
        if joint.type == "fixed" and joint.parent == WORLD and joint.child in carriers:
            made, found = chain("floating", joint, names)
            bodies += made
            joints += found
        else:
            joints.append(joint)
    return replace(mechanism, bodies=tuple(bodies), joints=tuple(joints))


def _across(axis: Vec3) -> list[Array]:
    """Two unit vectors normal to the axis and to each other, and the axis."""
    along = np.array(axis, float) / np.linalg.norm(axis)
    first = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))]).astype(float)
    first /= np.linalg.norm(first)
    return [first, np.cross(along, first).astype(float), along]
