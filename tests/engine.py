"""What the physics engine says of an MJCF file: torques at rest, projected on the coordinates that we read from it."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.rotation import about, from_quaternion, from_rpy, to_quaternion

STEP = 0.01  # [rad or m] between the seven poses of a derivative of sixth order
WEIGHTS = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}


class Engine:
    """A model of the engine beside the mechanism that was read from the same file."""

    def __init__(self, path: Path, mechanism: eq.Mechanism) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.data = mujoco.MjData(self.model)
        self.mechanism, self.tree = mechanism, Tree.of(mechanism)
        self.joints = {joint.name: joint for joint in mechanism.joints}
        self.row = {name: row for row, name in enumerate(self.tree.motions)}

    def qpos(self, q: np.ndarray) -> np.ndarray:
        """(N, nq) the engine's coordinates where ours are `q` (N, n); NaN where the loops do not close."""
        model, s = self.model, self.tree.values(q)
        found = np.tile(model.qpos0, (len(q), 1))
        for j in range(model.njnt):
            name, at = model.joint(j).name or f"joint {j}", int(model.jnt_qposadr[j])
            kind = mujoco.mjtJoint(model.jnt_type[j])
            if kind in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
                found[:, at] = s[:, self.row[name]]
            elif kind == mujoco.mjtJoint.mjJNT_BALL:
                found[:, at : at + 4] = self._ball(s, name, np.eye(3))
            elif self.joints[name].type == "fixed":
                held = self.joints[name]
                found[:, at : at + 7] = [*held.xyz, *to_quaternion(from_rpy(held.rpy))]
            else:
                R = from_quaternion(model.qpos0[at + 3 : at + 7])
                found[:, at : at + 3] += s[:, [self.row[f"{name} {letter}"] for letter in "xyz"]] @ R.T
                found[:, at + 3 : at + 7] = self._ball(s, name, R)
        return found

    def _ball(self, s: np.ndarray, name: str, zero: np.ndarray) -> np.ndarray:
        turns = [about(axis, s[:, self.row[f"{name}.{letter}"]]) for axis, letter in zip(np.eye(3), "xyz", strict=True)]
        R = zero @ turns[0] @ turns[1] @ turns[2]
        return np.array([to_quaternion(one) if np.isfinite(one).all() else [np.nan] * 4 for one in R])

    def torque(self, q: np.ndarray) -> np.ndarray:
        """(N, n) what holds it at rest at `q` (N, n) [N m or N], NaN where it does not close at or close by."""
        model = self.model
        rates = np.zeros((len(q), model.nv, self.tree.n))
        here = self.qpos(q)
        for i in range(self.tree.n):
            for k, weight in WEIGHTS.items():
                for sign in (1, -1):
                    there = self.qpos(q + sign * k * STEP * np.eye(self.tree.n)[i])
                    for a, b, rate in zip(here, there, rates, strict=True):
                        way = np.zeros(model.nv)
                        mujoco.mj_differentiatePos(model, way, 1.0, a, b)
                        rate[:, i] += sign * weight / STEP * way
        force = np.array([self._force(one) for one in here])
        return np.einsum("nvi,nv->ni", rates, force)

    def _force(self, qpos: np.ndarray) -> Any:
        if not np.isfinite(qpos).all():
            return np.full(self.model.nv, np.nan)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = qpos
        mujoco.mj_forward(self.model, self.data)
        return self.data.qfrc_bias - self.data.qfrc_passive
