"""Kinematics of mechanisms with loops: `Tree`'s interface, with the independent coordinates in the place of q.

The dependent coordinates of the spanning tree are solved for (docs/theory.md, section 3): q = f(u), and velocities are
multiplied by dq/du. Poses that do not close are NaN in everything, so that no torque is ever given for them.
"""

from __future__ import annotations

import numpy as np

from ..model.arrays import Array, Integers, frozen
from ..model.mechanism import Mechanism
from .branch import Branch
from .tree import Poses, Tree, Velocities


@frozen
class ClosedPoses(Poses):
    """Poses with the coordinates `q` (N, tree coordinates) [rad or m] they were computed from, NaN where not closed."""

    q: Array


class Linkage(Tree):
    """A mechanism with loops compiled for kinematics; `Tree.of` makes it. See `Tree` for the common attributes.

    `C` says only how the independent coordinates turn joints by themselves and through couplings, not through loops.

    Attributes:
        open: the spanning tree, loops ignored.
        branch: its closed poses.
        mobility: how many ways it can move.

    Raises:
        InputError: it cannot be assembled, its assembly pose is singular, or its `independent` coordinates are not.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        super().__init__(mechanism)
        self.open = Tree(mechanism)
        self.branch = Branch.of(mechanism)
        self.mobility = self.branch.mobility
        independent = self.branch.split.independent
        self.coordinates = tuple(self.open.coordinates[j] for j in independent)
        self.n = len(self.coordinates)
        self.C = self.open.C[:, independent]

    @property
    def rest(self) -> Array:
        return self.branch.assembled[self.branch.split.independent]

    def values(self, q: Array) -> Array:
        """(N, motions) every elementary joint value [rad or m]; NaN where the loops do not close."""
        return self.open.values(self.branch.solve(q)[0])

    def status(self, q: Array) -> Integers:
        """(N,) the `Status` of each pose."""
        return self.branch.solve(q)[1]

    def close(self, q: Array) -> tuple[Array, Array]:
        """How many times nearer to a singular pose than usual, 0 where the loops do not close.

        Returns:
            (N,) to one that no relation between joints leads through, and (N,) to any.
        """
        full, branch = self.branch.solve(q)[0], self.branch
        every = branch.close(full)
        return (every if branch.within is None else branch.within.close(full[:, branch.kept])), every

    def narrow(self, lower: Array, upper: Array) -> tuple[Array, Array]:
        """The part of a box of configurations that the loops let it reach."""
        low, high = self.branch.box
        return np.maximum(lower, low), np.minimum(upper, high)

    def poses(self, q: Array) -> ClosedPoses:
        """Body poses at `q` (N, n) [rad or m]; NaN where the loops do not close."""
        full, _ = self.branch.solve(q)
        poses = self.open.poses(full)
        bad = np.isnan(full).any(axis=1)
        poses.R[bad], poses.p[bad] = np.nan, np.nan  # of the bodies before the loops too
        return ClosedPoses(poses.R, poses.p, poses.s, full)

    def velocities(self, q: Array, poses: Poses) -> Velocities:
        """Analytic body velocities per unit rate of each independent coordinate, at `q` (N, n) with its `poses`."""
        full = poses.q if isinstance(poses, ClosedPoses) else self.branch.solve(q)[0]
        velocities = self.open.velocities(full, poses)
        rates = self.branch.rates(full)[:, None]
        return Velocities(velocities.w @ rates, velocities.v @ rates, velocities.s @ rates[:, 0])
