"""What springs leave unbalanced when each is stretched by its own law: the residual torque and the band of friction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...balance import largest_share
from ...energy.extremes import climb
from ...kinematics import Tree, sample
from ...model.arrays import Array, frozen
from ...model.elements import lines
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from .stretch import Stretch


@frozen
class InstalledTorque:
    """Torques [N m or N] over the workspace, (n,) each.

    Attributes:
        residual: largest magnitude of gravity's and the springs' torque together.
        rms: its root mean square over random poses.
        unbalanced: largest magnitude of gravity's alone.
        friction: largest torque that friction in the springs' mounts adds or takes away.
        share: largest residual over the largest unbalanced torque.
    """

    residual: Array
    rms: Array
    unbalanced: Array
    friction: Array
    share: float


class Torques:
    """Gravity's and every spring's holding torque, with a law of stretch for each spring."""

    def __init__(self, mechanism: Mechanism, laws: Sequence[Stretch]) -> None:
        self.tree = Tree.of(mechanism)
        self._g = np.array(mechanism.gravity)
        self._masses = [(self.tree.index[body], m, p) for body, m, p in lumped_masses(mechanism) if m]
        self._springs = [
            (s.stiffness, self.tree.index[s.body_a], np.array(s.p_a), self.tree.index[s.body_b], np.array(s.p_b), law)
            for s, law in zip(lines(mechanism, "hardware"), laws, strict=True)
        ]

    def __call__(self, q: Array) -> tuple[Array, Array]:
        """(N, n) torque against gravity and (N, springs, n) of each spring [N m or N]."""
        poses = self.tree.poses(q)
        velocities = self.tree.velocities(q, poses)
        gravity = np.zeros_like(q)
        for body, mass, p in self._masses:
            gravity -= mass * np.einsum("i,nij->nj", self._g, velocities.point(poses, body, p))
        springs = np.zeros((len(q), len(self._springs), self.tree.n))
        for i, (k, A, p_a, B, p_b, law) in enumerate(self._springs):
            d = poses.point(B, p_b) - poses.point(A, p_a)
            # in A's frame: seen from there only B moves
            stretch, gradient = law(np.einsum("nji,nj->ni", poses.R[:, A], d))
            rate = velocities.point(poses, B, p_b) - velocities.point(poses, A, p_a)
            rate -= np.cross(velocities.w[:, A], d[:, :, None], axis=1)
            pull = np.einsum("nij,nj->ni", poses.R[:, A], k * stretch[:, None] * gradient)
            springs[:, i] = np.einsum("ni,nij->nj", pull, rate)
        return gravity, springs


def installed_torque(
    mechanism: Mechanism,
    laws: Sequence[Stretch],
    friction: Sequence[float] | None = None,
    *,
    samples: int | None = None,
    seed: int = 0,
) -> InstalledTorque:
    """Judge a mechanism whose springs are stretched by `laws`.

    Args:
        friction: share of each spring's force that friction in its mount may hold back; none by default.
        samples: random poses; the mechanism's workspace says how many by default.
    """
    torques = Torques(mechanism, laws)
    tree, n = torques.tree, torques.tree.n
    held = np.zeros(len(mechanism.springs)) if friction is None else np.asarray(friction, float)

    def quantities(q: Array) -> Array:
        gravity, springs = torques(q)
        band = np.einsum("s,nsj->nj", held, np.abs(springs))
        return np.hstack([np.abs(gravity), np.abs(gravity + springs.sum(axis=1)), band])

    q = sample(tree, mechanism.workspace.samples if samples is None else samples, seed)
    best, _ = climb(tree, quantities, q, seed)
    unbalanced, residual, band = np.split(best, [n, 2 * n])
    rms = np.sqrt(np.mean(quantities(q)[:, n : 2 * n] ** 2, axis=0))
    return InstalledTorque(residual, rms, unbalanced, band, largest_share(residual, unbalanced, tree.coordinates))
