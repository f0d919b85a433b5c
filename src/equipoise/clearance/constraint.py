"""Room for springs as a constraint: rows that are zero where everything is far enough away."""

from __future__ import annotations

import numpy as np

from ..kinematics import Tree
from ..model.arrays import Array
from ..model.mechanism import Mechanism
from .pairs import Pairs
from .segments import closest

MORE = 0.02  # share of its scale by which the distance that is aimed at is larger than the one asked for
THIN = 1e-3  # [m] least scale
TOUCHING = 1e-12  # [m] less has no direction


class ClearanceConstraint:
    """What is missing of `least` [m] at poses `q` (N, n), as a share of the spring's and the distance's own scale.

    Of a mechanism whose elements are springs between two points.
    """

    def __init__(self, mechanism: Mechanism, q: Array, least: float) -> None:
        self.pairs, self.springs = Pairs(mechanism), len(mechanism.springs)
        self.poses = Tree.of(mechanism).poses(q)
        self.R = self.poses.R[:, self.pairs.bodies]  # (N, parts, 2, 3, 3)
        first, second = (self.pairs.radius[side] for side in (self.pairs.first, self.pairs.second))
        self.scale = np.maximum(least + first + np.where(self.pairs.solid, 0.0, second), THIN)
        self.wanted = least + first + second + MORE * self.scale
        springs = range(self.springs)
        self.ours = np.isin(self.pairs.first, springs) | np.isin(self.pairs.second, springs)  # what springs can change
        self.weight = 1 / np.sqrt(len(q))

    def __call__(self, ends: Array) -> tuple[Array, Array]:
        """Rows that are not zero, and their derivative (rows, springs, 2, 3) by attachments (springs, 2, 3)."""
        pairs = self.pairs
        p = pairs.points(self.poses, np.concatenate([ends, pairs.ends[self.springs :]]))
        a, b, c, d = pairs.of_both(p)
        distance, s, t = closest(a, b, c, d)
        pose, pair = np.nonzero(
            (distance < self.wanted) & self.ours
        )  # a solid is farther away than the capsule that it lies in
        a, b, c, d, s, t, distance = (x[pose, pair] for x in (a, b, c, d, s, t, distance))
        apart = a + s[:, None] * (b - a) - c - t[:, None] * (d - c)
        crossing = np.cross(b - a, d - c)  # where they meet, either side of it is as good as the other
        n = np.where((distance > TOUCHING)[:, None], apart, crossing)
        n /= np.maximum(np.linalg.norm(n, axis=1), 1e-300)[:, None]
        solid = np.flatnonzero(pairs.solid[pair])
        found, s[solid], n[solid] = pairs.to_solids(self.poses, p, pose[solid], pair[solid])
        distance[solid] = found + pairs.radius[pairs.first[pair[solid]]] + pairs.radius[pairs.second[pair[solid]]]
        near = distance < self.wanted[pair]
        pose, pair = pose[near], pair[near]
        s, t, n, distance = (x[near] for x in (s, t, n, distance))
        unit = self.weight / self.scale[pair]
        J = np.zeros((len(pose), self.springs, 2, 3))
        row = np.arange(len(pose))
        for side, sign, along in ((pairs.first[pair], 1.0, s), (pairs.second[pair], -1.0, t)):
            own = side < self.springs
            for e, share in ((0, 1 - along), (1, along)):
                turned = np.einsum("rji,rj->ri", self.R[pose, side, e], n)
                J[row[own], side[own], e] -= (sign * unit * share)[own, None] * turned[own]
        return (self.wanted[pair] - distance) * unit, J
