"""Slow, obvious answers at one configuration, by the definitions alone: what everything faster is compared with."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from equipoise.model.elements import Vec3
from equipoise.model.mechanism import Mechanism

SlowPoses = dict[str, tuple[np.ndarray, np.ndarray]]


def slow_values(m: Mechanism, q: np.ndarray) -> dict[str, float]:
    """The value of every coordinate and of every coupled joint, by the definition of a coupling."""
    values: dict[str, float] = dict(zip(m.coordinates, map(float, q), strict=True))
    couplings = {coupling.joint: coupling for coupling in m.couplings}

    def value(name: str) -> float:
        if name not in values:
            values[name] = couplings[name].offset + sum(ratio * value(other) for other, ratio in couplings[name].terms)
        return values[name]

    for name in couplings:
        value(name)
    return values


def slow_poses(m: Mechanism, q: np.ndarray) -> SlowPoses:
    """R_WB and p_WB of every body at one configuration, body by body, by the definition of the joints."""
    values = slow_values(m, q)
    holder = {joint.child: joint for joint in m.joints}
    poses: SlowPoses = {"world": (np.eye(3), np.zeros(3))}

    def pose(body: str) -> tuple[np.ndarray, np.ndarray]:
        if body not in poses:
            j = holder[body]
            R_WP, p_WP = pose(j.parent)
            R_base = pose(j.follows)[0] if j.follows is not None else R_WP
            R, p = Rotation.from_euler("xyz", j.rpy).as_matrix(), np.array(j.xyz)
            axis = np.array(j.axis) / np.linalg.norm(j.axis)
            turn = np.eye(3)
            if j.type == "revolute":
                turn = Rotation.from_rotvec(values[j.name] * axis).as_matrix()
            elif j.type == "spherical":
                turn = Rotation.from_euler("XYZ", [values[f"{j.name}.{letter}"] for letter in "xyz"]).as_matrix()
            elif j.type == "prismatic":
                p = p + values[j.name] * R @ axis
            poses[body] = R_base @ R @ turn, p_WP + R_WP @ p
        return poses[body]

    return {body: pose(body) for body in m.body_names}


def slow_energy(m: Mechanism, q: np.ndarray) -> tuple[float, list[float], list[float]]:
    """Gravity's energy, each spring's, and each spring's length at one configuration."""
    poses = slow_poses(m, q)

    def at(body: str, p: Vec3) -> np.ndarray:
        R, origin = poses[body]
        return origin + R @ np.array(p)

    lumps = [(body.mass, at(body.name, body.com)) for body in m.bodies]
    lumps += [(mass.mass, at(mass.body, mass.position)) for mass in m.masses]
    energies, lengths = [], []
    for s in m.springs:
        ends = at(s.body_a, s.p_a), at(s.body_b, s.p_b)
        lengths.append(float(np.linalg.norm(ends[1] - ends[0])))
        energies.append(s.stiffness / 2 * (lengths[-1] - s.free_length) ** 2)
        lumps += [(s.mass * s.mass_split, ends[0]), (s.mass * (1 - s.mass_split), ends[1])]
    return -sum(float(mass * np.dot(m.gravity, p)) for mass, p in lumps), energies, lengths
