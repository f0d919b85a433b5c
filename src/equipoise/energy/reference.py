"""Gravity and springs of every kind, with the analytic torque, summed one by one: slow, and obviously right.

    U = -sum m g . p  +  sum of each spring's own energy,      torque = dU/dq

The torque is what the actuators must supply to hold the pose [N m, or N for a prismatic coordinate]; it is minus the
generalised force of gravity and springs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..kinematics.tree import Tree
from ..model.arrays import Array
from ..model.masses import lumped_masses
from ..model.mechanism import Mechanism

CHUNK_ENTRIES = 4_000_000  # velocities held at a time, about 32 MB


@dataclass(frozen=True)
class State:
    """Everything about a batch of N configurations.

    Attributes:
        gravity: (N,) energy [J].
        springs: (N, springs) energy of each [J].
        path: (N, springs) length or angle of each [m or rad].
        gravity_torque: (N, n) [N m or N].
        spring_torque: (N, n) [N m or N].
    """

    gravity: Array
    springs: Array
    path: Array
    gravity_torque: Array
    spring_torque: Array

    @staticmethod
    def of(mechanism: Mechanism, gravity: Array, path: Array, gravity_torque: Array, spring_torque: Array) -> State:
        """With the energies that the springs' laws give for their paths."""
        springs = np.empty_like(path)
        for i, spring in enumerate(mechanism.springs):
            springs[:, i] = spring.law.energy(path[:, i])
        return State(gravity, springs, path, gravity_torque, spring_torque)

    @property
    def energy(self) -> Array:
        """(N,) total potential energy [J]."""
        return self.gravity + self.springs.sum(axis=1)

    @property
    def torque(self) -> Array:
        """(N, n) total holding torque [N m or N]."""
        return self.gravity_torque + self.spring_torque


class Reference:
    """Energy and torque of a mechanism at given configurations, by definition.

    Raises:
        InputError: its loops cannot be closed.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.tree = Tree.of(mechanism)
        self._g = np.array(mechanism.gravity)
        self._masses = [(self.tree.index[b], m, p) for b, m, p in lumped_masses(mechanism) if m]

    def __call__(self, q: ArrayLike) -> State:
        """Energies, paths and torques at `q`, (N, n) or (n,) for one pose (N = 1)."""
        q = self.tree.batch(q)
        size = max(1, CHUNK_ENTRIES // (6 * max(1, self.tree.n) * len(self.tree.names)))
        parts = [self._chunk(q[i : i + size]) for i in range(0, max(1, len(q)), size)]
        fields = ("gravity", "springs", "path", "gravity_torque", "spring_torque")
        return State(*(np.concatenate([getattr(part, name) for part in parts]) for name in fields))

    def _chunk(self, q: Array) -> State:
        poses = self.tree.poses(q)
        velocities = self.tree.velocities(q, poses)
        gravity, gravity_torque = np.zeros(len(q)), np.zeros_like(q)
        for body, mass, p in self._masses:
            gravity -= mass * (poses.point(body, p) @ self._g)
            gravity_torque -= mass * np.einsum("i,nij->nj", self._g, velocities.point(poses, body, p))
        path, spring_torque = np.empty((len(q), len(self.mechanism.springs))), np.zeros_like(q)
        for i, spring in enumerate(self.mechanism.springs):
            path[:, i], torque = spring.state(self.tree, poses, velocities)
            spring_torque += torque
        return State.of(self.mechanism, gravity, path, gravity_torque, spring_torque)
