"""Gravity and springs of any free length, with the analytic torque: the reference sums them one by one.

    U = -sum m g . p  +  sum k/2 (length - free_length)^2,      torque = dU/dq

The torque is what the actuators must supply to hold the pose [N m, or N for a prismatic coordinate]; it is minus the
generalised force of gravity and springs. A spring's mass is lumped at its ends. Many poses of a tree are computed by
`kernel`, whose tests compare it with the reference.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, frozen
from ..errors import InputError
from ..kinematics.tree import Tree
from ..mechanism import Mechanism

FEW = 32  # poses for which writing down a program does not pay
CHUNK_ENTRIES = 4_000_000  # velocities held at a time, about 32 MB


@frozen
class State:
    """Everything about a batch of N configurations.

    Attributes:
        gravity: (N,) energy [J].
        springs: (N, springs) energy of each [J].
        length: (N, springs) [m].
        gravity_torque: (N, n) [N m or N].
        spring_torque: (N, n) [N m or N].
    """

    gravity: Array
    springs: Array
    length: Array
    gravity_torque: Array
    spring_torque: Array

    @property
    def energy(self) -> Array:
        """(N,) total potential energy [J]."""
        return self.gravity + self.springs.sum(axis=1)

    @property
    def torque(self) -> Array:
        """(N, n) total holding torque [N m or N]."""
        return self.gravity_torque + self.spring_torque


def lumped_masses(mechanism: Mechanism) -> Iterator[tuple[str, float, Array]]:
    """Every mass as (body, mass [kg], point in the body's frame (3,) [m]): bodies, point masses, ends of springs."""
    for body in mechanism.bodies:
        yield body.name, body.mass, np.array(body.com)
    for mass in mechanism.masses:
        yield mass.body, mass.mass, np.array(mass.position)
    for spring in mechanism.springs:
        yield spring.body_a, spring.mass * spring.mass_split, np.array(spring.p_a)
        yield spring.body_b, spring.mass * (1 - spring.mass_split), np.array(spring.p_b)


class Potential:
    """Energy and torque of a mechanism at given configurations.

    Raises:
        InputError: its loops cannot be closed.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.tree = Tree.of(mechanism)
        self._g = np.array(mechanism.gravity)
        self._masses = [(self.tree.index[b], m, p) for b, m, p in lumped_masses(mechanism) if m]
        self._ends = [
            (self.tree.index[s.body_a], np.array(s.p_a), self.tree.index[s.body_b], np.array(s.p_b))
            for s in mechanism.springs
        ]
        self._stiffness = np.array([s.stiffness for s in mechanism.springs])
        self._free = np.array([s.free_length for s in mechanism.springs])

    def __call__(self, q: ArrayLike) -> State:
        """Energies, lengths and torques at `q`, (N, n) or (n,) for one pose (N = 1)."""
        q = self._poses(q)
        if len(q) < FEW or self.mechanism.loops:
            return self.reference(q)
        from .kernel import Kernel

        parts = Kernel.of(self.mechanism).parts(q)
        springs = 0.5 * self._stiffness * (parts.length - self._free) ** 2
        return State(parts.gravity, springs, parts.length, parts.gravity_torque, parts.spring_torque)

    def reference(self, q: ArrayLike) -> State:
        """The same, everything summed one by one."""
        q = self._poses(q)
        size = max(1, CHUNK_ENTRIES // (6 * max(1, self.tree.n) * len(self.tree.names)))
        parts = [self._chunk(q[i : i + size]) for i in range(0, max(1, len(q)), size)]
        fields = ("gravity", "springs", "length", "gravity_torque", "spring_torque")
        return State(*(np.concatenate([getattr(part, name) for part in parts]) for name in fields))

    def _poses(self, q: ArrayLike) -> Array:
        q = np.atleast_2d(np.asarray(q, float))
        if q.shape[1:] != (self.tree.n,):
            raise InputError(f"q has shape {q.shape}, expected (N, {self.tree.n}) for {self.tree.coordinates}")
        return q

    def _chunk(self, q: Array) -> State:
        poses = self.tree.poses(q)
        velocities = self.tree.velocities(q, poses)
        gravity, gravity_torque = np.zeros(len(q)), np.zeros_like(q)
        for body, mass, p in self._masses:
            gravity -= mass * (poses.point(body, p) @ self._g)
            gravity_torque -= mass * np.einsum("i,nij->nj", self._g, velocities.point(poses, body, p))
        length = np.empty((len(q), len(self._ends)))
        spring_torque = np.zeros_like(q)
        for i, (A, p_a, B, p_b) in enumerate(self._ends):
            d = poses.point(B, p_b) - poses.point(A, p_a)
            length[:, i] = np.sqrt(np.einsum("ni,ni->n", d, d))
            rate = velocities.point(poses, B, p_b) - velocities.point(poses, A, p_a)
            # k (L - L0)/L d: with L0 > 0 the direction at L = 0 is undefined, and zero is taken
            with np.errstate(divide="ignore", invalid="ignore"):
                share = np.where(length[:, i] > 0, 1 - self._free[i] / length[:, i], 0.0) if self._free[i] else 1.0
            spring_torque += self._stiffness[i] * np.einsum("ni,nij->nj", d * np.reshape(share, (-1, 1)), rate)
        springs = 0.5 * self._stiffness * (length - self._free) ** 2
        return State(gravity, springs, length, gravity_torque, spring_torque)
