"""What the physics engine says of an MJCF file: torques at rest, projected on the coordinates that we read from it."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.kinematics.linkage import Linkage
from equipoise.model.rotation import about, from_quaternion, from_rpy, to_quaternion

STEP = 0.01  # [rad or m] between the seven poses of a derivative of sixth order
WEIGHTS = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}


class Engine:
    """A model of the engine beside the mechanism that was read from the same file."""

    def __init__(self, path: Path, mechanism: eq.Mechanism) -> None:
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.model.opt.jacobian = int(mujoco.mjtJacobian.mjJAC_DENSE)
        self.data = mujoco.MjData(self.model)
        self.mechanism, self.tree = mechanism, Tree.of(mechanism)
        self.open = self.tree.open if isinstance(self.tree, Linkage) else self.tree
        self.joints = {joint.name: joint for joint in mechanism.joints}
        self.row: dict[str, int] = {name: row for row, name in enumerate(self.tree.motions)}

    def qpos(self, q: np.ndarray) -> np.ndarray:
        """(N, nq) the engine's coordinates where those of the spanning tree are `q` (N, open.n)."""
        model, s = self.model, self.open.values(q)
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
        return np.array([to_quaternion(R) for R in zero @ turns[0] @ turns[1] @ turns[2]])

    def torque(self, q: np.ndarray) -> np.ndarray:
        """(N, n) what holds it at rest at `q` (N, n) [N m or N], by the engine's own constraints; NaN where open."""
        closed = self.tree.branch.solve(q)[0] if isinstance(self.tree, Linkage) else q
        found = np.full(q.shape, np.nan)
        for k in np.flatnonzero(np.isfinite(closed).all(axis=1)):
            rates, (force, J) = self._rates(closed[k]), self._forward(self.qpos(closed[k : k + 1])[0])
            if isinstance(self.tree, Linkage):
                split, by_tree = self.tree.branch.split, J @ rates
                follow = -np.linalg.pinv(by_tree[:, split.dependent], rcond=1e-9) @ by_tree[:, split.independent]
                rates = rates[:, split.independent] + rates[:, split.dependent] @ follow
            found[k] = rates.T @ force
        return found

    def _rates(self, q: np.ndarray) -> np.ndarray:
        """(nv, open.n) the engine's velocities for unit rates of the spanning tree's coordinates at `q` (open.n,)."""
        rates = np.zeros((self.model.nv, len(q)))
        (here,) = self.qpos(q[None])
        for k, weight in WEIGHTS.items():
            for sign in (1, -1):
                for i, there in enumerate(self.qpos(q + sign * k * STEP * np.eye(len(q)))):
                    way = np.zeros(self.model.nv)
                    mujoco.mj_differentiatePos(self.model, way, 1.0, here, there)
                    rates[:, i] += sign * weight / STEP * way
        return rates

    def _forward(self, qpos: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(nv,) the forces that hold it at rest, and (equations, nv) the Jacobian of the equalities."""
        model, data = self.model, self.data
        mujoco.mj_resetData(model, data)
        data.qpos[:] = qpos
        mujoco.mj_forward(model, data)
        rows = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        return data.qfrc_bias - data.qfrc_passive, data.efc_J.reshape(data.nefc, model.nv)[rows]
