"""How long springs may get: a limit on their elongation over the ranges of the joints."""

from __future__ import annotations

from itertools import islice, product
from math import isfinite

import numpy as np

from ...kinematics import Tree, sample
from ...model.arrays import Array, Complexes, frozen
from ...model.mechanism import Mechanism
from .arm import PlanarArm, upward
from .exclusion import Layout

POSES, CORNERS = 256, 1024  # random and extreme ones that springs are kept short in
ROOM = 0.98  # of a limit, where a fit starts to keep within it


@frozen
class Elongation:
    """A limit on the length of springs, and the poses in which it is kept.

    Attributes:
        longest: [m] of a spring.
        directions: (poses, n) where the links point, as unit complex numbers.
    """

    longest: float
    directions: Complexes

    @staticmethod
    def of(mechanism: Mechanism, arm: PlanarArm, longest: float) -> Elongation:
        """A limit [m] in the poses where springs are longest, and in random ones.

        A spring is longest with its joints at the ends of their ranges, or its links in line.
        """
        tree = Tree.of(mechanism)
        bodies = [tree.index[link] for link in arm.links]

        def at(q: Array) -> Complexes:
            turned = arm.R[0] @ tree.poses(q).R[:, bodies] @ np.swapaxes(arm.R, 1, 2)
            return arm.u * np.exp(1j * np.arctan2(turned[..., 1, 0], turned[..., 0, 0]))

        little = 1e-3  # [rad] shows which way a joint counts
        bends = at(np.zeros((1, tree.n))), at(little * np.eye(tree.n))
        rest, bent = (np.angle(u[..., 1:] / u[..., :-1]) for u in bends)
        ways = np.sign(np.angle(np.exp(1j * (np.diagonal(bent) - rest[0]))))
        line = np.append(np.pi / 2, np.zeros(tree.n - 1)) - rest[0]  # the ground's ends are above the first joint
        aligned = np.stack([ways * line, ways * (line + np.pi)], axis=1)
        aligned = (aligned + np.pi) % (2 * np.pi) - np.pi
        rows = tree.coordinate_rows
        limits = zip(tree.lower[rows], tree.upper[rows], aligned, strict=True)
        extremes = [[q for q in (low, high, *flat) if low <= q <= high and isfinite(q)] for low, high, flat in limits]
        corners = np.array(list(islice(product(*extremes), CORNERS)))
        return Elongation(longest, at(np.concatenate([corners, sample(tree, POSES)])))

    def holds(self, layout: Layout, lengths: Array, size: float, a: Complexes, b: Complexes) -> bool:
        """Whether no spring gets too long; for the arguments see `rows`."""
        return bool(np.abs(self._stretches(layout, lengths / size, a, b)).max() <= self.longest / size)

    def rows(
        self, layout: Layout, lengths: Array, size: float, a: Complexes, b: Complexes, half: int
    ) -> tuple[Array, Array]:
        """Rows (springs,) that are 0 for springs that are short enough, and their derivative by the unknowns.

        Args:
            lengths: (n,) of the links [m]; size: the unit of length [m].
            a, b: (springs,) attachments along the links, in that unit.
            half: unknowns of an attachment, 1 along the link or 2 along and across it; log stiffness comes before.
        """
        width, count = 1 + 2 * half, len(layout)
        vectors = self._stretches(layout, lengths / size, a, b)
        far = np.abs(vectors)
        worst = far.argmax(axis=0)
        most = far[worst, np.arange(count)]
        over = most - ROOM * self.longest / size
        J = np.zeros((count, count, width))
        for s in np.flatnonzero(over > 0):
            i, k = layout[s]
            along = vectors[worst[s], s].conjugate() / most[s]
            turns = np.array([1.0, 1j][:half])
            u = self.directions[worst[s]]
            J[s, s, 1 : 1 + half] = 10 * (-along * u[i - 1] * upward(i) * turns).real
            J[s, s, 1 + half :] = 10 * (along * u[k - 1] * turns).real
        return 10 * np.maximum(over, 0), J.reshape(count, -1)

    def _stretches(self, layout: Layout, lengths: Array, a: Complexes, b: Complexes) -> Complexes:
        """(poses, springs) what each spring stretches by."""
        r = self.directions * lengths
        found = [
            b[s] * self.directions[:, k - 1]
            - a[s] * upward(i) * self.directions[:, i - 1]
            + r[:, i : k - 1].sum(axis=1)
            for s, (i, k) in enumerate(layout)
        ]
        return np.stack(found, axis=1)
