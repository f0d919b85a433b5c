"""MuJoCo: a model of ours in a pose of ours, its energy and torques in our coordinates."""

# pyright: reportAttributeAccessIssue=false
# (its names come from a compiled module that ships no type stubs)

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from equipoise.io import mjcf, mjcf_springs
from equipoise.model.mechanism import Mechanism


def set_pose(m: Mechanism, model: mujoco.MjModel, q: dict[str, float]) -> mujoco.MjData:
    """The model's data with every joint where the coordinates `q` of `m` put it."""
    data = mujoco.MjData(model)
    joints = mjcf.joint_map(m)
    assert {model.joint(i).name for i in range(model.njnt)} == joints.keys()
    for name, value in joints.items():
        angles = [q[coordinate] for coordinate, _ in value.terms]
        if value.type == "ball":
            x, y, z, w = Rotation.from_euler("XYZ", angles).as_quat()
            data.joint(name).qpos[:] = w, x, y, z
        else:
            data.joint(name).qpos[:] = value.offset + sum(
                ratio * angle for (_, ratio), angle in zip(value.terms, angles, strict=True)
            )
    mujoco.mj_fwdPosition(model, data)
    return data


def mujoco_state(m: Mechanism, model: Any, q: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Potential energy, and the torque that holds gravity, and springs, in our coordinates."""
    values: dict[str, float] = dict(zip(m.coordinates, q.tolist(), strict=True))
    data = set_pose(m, model, values)
    column: dict[str, int] = {name: j for j, name in enumerate(m.coordinates)}
    T = np.zeros((model.nv, len(q)))  # the model's velocities per rate of our coordinates
    for name, value in mjcf.joint_map(m).items():
        row = int(model.joint(name).dofadr[0])
        if value.type == "ball":
            # R = Rx Ry Rz; the velocity of a ball is in the child's frame
            y, z = (values[coordinate] for coordinate, _ in value.terms[1:])
            Ry, Rz = (Rotation.from_euler(letter, angle).as_matrix() for letter, angle in (("y", y), ("z", z)))
            rates = Rz.T @ Ry.T @ [1, 0, 0], Rz.T @ [0, 1, 0], np.array([0, 0, 1])
            for (coordinate, _), rate in zip(value.terms, rates, strict=True):
                T[row : row + 3, column[coordinate]] = rate
        else:
            for other, ratio in value.terms:
                T[row, column[other]] += ratio
    mujoco.mj_fwdVelocity(model, data)  # at rest: gravity and springs
    mujoco.mj_energyPos(model, data)
    laws = mjcf_springs.beyond(m)

    def bias(model: Any, data: Any, actuator: int) -> float:
        """A law that the engine lacks, at its own length."""
        return -float(laws[model.actuator(actuator).name].pull(data.actuator_length[actuator]))

    mujoco.set_mjcb_act_bias(bias if laws else None)
    mujoco.mj_fwdActuation(model, data)
    mujoco.set_mjcb_act_bias(None)
    energy = float(data.energy[0])
    for spring in m.springs:  # the engine counts no energy of actuators
        if not spring.mjcf()[1]:
            energy += float(spring.law.energy(np.array(data.tendon(spring.name).length[0])))
    return energy, T.T @ data.qfrc_bias, -T.T @ (data.qfrc_passive + data.qfrc_actuator)
