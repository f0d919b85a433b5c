"""The same mechanism written in another way: in another world, with another body frame, springs the other way round."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from equipoise.model.elements import Vec3
from equipoise.model.mechanism import WORLD, Joint, Mechanism


def vec3(v: np.ndarray) -> Vec3:
    x, y, z = v.tolist()
    return x, y, z


def rotation(rpy: Vec3) -> np.ndarray:
    return Rotation.from_euler("xyz", rpy).as_matrix()


def rpy(R: np.ndarray) -> Vec3:
    return vec3(Rotation.from_matrix(R).as_euler("xyz"))


def moved_points(m: Mechanism, body: str, R: np.ndarray, p: np.ndarray) -> Mechanism:
    """Every point that is given in the frame of `body`, given in another one: x -> R x + p."""

    def move(name: str, point: Vec3) -> Vec3:
        return vec3(R @ point + p) if name == body else point

    return replace(
        m,
        bodies=tuple(replace(b, com=move(b.name, b.com), inertia=None) for b in m.bodies),
        masses=tuple(replace(x, position=move(x.body, x.position)) for x in m.masses),
        springs=tuple(replace(s, p_a=move(s.body_a, s.p_a), p_b=move(s.body_b, s.p_b)) for s in m.springs),
    )


def moved_children(joints: tuple[Joint, ...], body: str, R: np.ndarray, p: np.ndarray) -> tuple[Joint, ...]:
    """The joints that hang on `body`, or follow it, when its frame is another one: x -> R x + p."""
    result = []
    for j in joints:
        xyz = vec3(R @ j.xyz + p) if j.parent == body else j.xyz
        turned = (j.follows or j.parent) == body
        result.append(replace(j, xyz=xyz, rpy=rpy(R @ rotation(j.rpy)) if turned else j.rpy))
    return tuple(result)


def in_another_world(m: Mechanism, R: np.ndarray, p: np.ndarray) -> Mechanism:
    """Everything, gravity too, rotated and translated."""
    m = moved_points(m, WORLD, R, p)
    return replace(m, joints=moved_children(m.joints, WORLD, R, p), gravity=vec3(R @ m.gravity))


def relabelled(m: Mechanism, body: str, rng: np.random.Generator) -> Mechanism:
    """The same mechanism with the frame of `body` elsewhere in it, as far as its joint leaves a choice."""
    joint = next(j for j in m.joints if j.child == body)
    if joint.type == "spherical":  # its frame is where its three angles are zero
        return m
    R_BN, p_BN = Rotation.random(rng=rng).as_matrix(), rng.uniform(-1, 1, 3)
    axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
    if joint.type == "revolute":
        p_BN = 0.7 * axis  # the origin stays on the axis
    elif joint.type == "parallelogram":
        p_BN = np.zeros(3)
    R0 = rotation(joint.rpy)
    new = replace(joint, xyz=vec3(joint.xyz + R0 @ p_BN), rpy=rpy(R0 @ R_BN), axis=vec3(R_BN.T @ np.array(joint.axis)))
    m = moved_points(m, body, R_BN.T, -R_BN.T @ p_BN)
    joints = moved_children(m.joints, body, R_BN.T, -R_BN.T @ p_BN)
    # a parallelogram may have a parent that is not what it follows: `joint` itself never hangs on `body`
    return replace(m, joints=tuple(new if j.name == joint.name else j for j in joints))


def swapped_ends(m: Mechanism) -> Mechanism:
    return m.with_springs(
        replace(s, body_a=s.body_b, p_a=s.p_b, body_b=s.body_a, p_b=s.p_a, mass_split=1 - s.mass_split)
        for s in m.springs
    )
