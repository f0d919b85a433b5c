"""Pinocchio: gravity and masses of a mechanism as its model."""

# pyright: reportAttributeAccessIssue=false
# (its names come from a compiled module that ships no type stubs)

from __future__ import annotations

from typing import Any

import numpy as np
from peers import peer
from scipy.spatial.transform import Rotation

from equipoise.model.mechanism import WORLD, Mechanism

pin = peer("pinocchio")


def pinocchio_model(m: Mechanism) -> tuple[Any, list[str]]:
    """Gravity and masses as a Pinocchio model; the names of its joint values in its order. No parallelograms."""
    model, names = pin.Model(), []
    model.gravity.linear = np.array(m.gravity)
    holder = {joint.child: joint for joint in m.joints}
    placed = {WORLD: (0, pin.SE3.Identity())}  # body -> its Pinocchio joint, and where it sits on it

    def place(body: str) -> tuple[int, Any]:
        if body not in placed:
            j = holder[body]
            parent, X = place(j.parent)
            X = X * pin.SE3(Rotation.from_euler("xyz", j.rpy).as_matrix(), np.array(j.xyz))
            axis = np.array(j.axis) / np.linalg.norm(j.axis)
            kinds = {
                "revolute": [(pin.JointModelRevoluteUnaligned(axis), j.name)],
                "prismatic": [(pin.JointModelPrismaticUnaligned(axis), j.name)],
                "spherical": [
                    (kind(), f"{j.name}.{letter}")
                    for kind, letter in ((pin.JointModelRX, "x"), (pin.JointModelRY, "y"), (pin.JointModelRZ, "z"))
                ],
                "fixed": [],
            }
            for kind, name in kinds[j.type]:
                parent, X = model.addJoint(parent, kind, X, name), pin.SE3.Identity()
                names.append(name)
            placed[body] = parent, X
        return placed[body]

    lumps = [(body.name, body.mass, body.com) for body in m.bodies]
    lumps += [(mass.body, mass.mass, mass.position) for mass in m.masses]
    for s in m.springs:
        lumps += [(s.body_a, s.mass * s.mass_split, s.p_a), (s.body_b, s.mass * (1 - s.mass_split), s.p_b)]
    for body, mass, p in lumps:
        joint, X = place(body)
        model.appendBodyToJoint(joint, pin.Inertia(mass, np.array(p), np.zeros((3, 3))), X)
    return model, names
