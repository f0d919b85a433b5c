"""The pairs that may come close: springs with each other and with the links, as capsules."""

from __future__ import annotations

import numpy as np

from ..kinematics import Poses, Tree
from ..model.arrays import Array
from ..model.elements import lines
from ..model.mechanism import Mechanism
from .segments import closest


class Pairs:
    """Every spring with every other, and with every capsule that is not on a body it is fixed to.

    Attributes:
        names: of each pair, (spring, other).
        first, second: (pairs,) numbers among springs and then capsules.
        bodies: of each of these, of its two ends.
        ends: (springs + capsules, 2, 3) their ends, in the bodies' frames [m].
        radius: of each [m].
    """

    def __init__(self, mechanism: Mechanism) -> None:
        tree, springs, capsules = Tree.of(mechanism), lines(mechanism, "clearance"), mechanism.capsules
        self.bodies = [(tree.index[s.body_a], tree.index[s.body_b]) for s in springs]
        self.bodies += [(tree.index[c.body],) * 2 for c in capsules]
        self.ends = np.array([[one.p_a, one.p_b] for one in (*springs, *capsules)])
        self.radius = np.array([*(s.diameter / 2 for s in springs), *(c.radius for c in capsules)])
        count, every = len(springs), range(len(self.bodies))
        pairs = [
            (i, j) for i in range(count) for j in every[i + 1 :] if j < count or self.bodies[j][0] not in self.bodies[i]
        ]
        self.first, self.second = (np.array([pair[side] for pair in pairs], int) for side in (0, 1))
        label = [one.name for one in (*springs, *capsules)]
        self.names = [(label[i], label[j]) for i, j in pairs]

    def distances(self, poses: Poses) -> Array:
        """(N, pairs) [m] between surfaces."""
        p = self.points(poses, self.ends)
        return closest(*self.of_both(p))[0] - self.radius[self.first] - self.radius[self.second]

    def points(self, poses: Poses, ends: Array) -> Array:
        """(N, springs + capsules, 2, 3) the ends in the world [m]."""
        sides = [
            np.stack([poses.point(body[e], at[e]) for body, at in zip(self.bodies, ends, strict=True)], axis=1)
            for e in (0, 1)
        ]
        return np.stack(sides, axis=2)

    def of_both(self, p: Array) -> tuple[Array, Array, Array, Array]:
        """Of (N, springs + capsules, 2, 3) the four ends of every pair, (N, pairs, 3) each."""
        return p[:, self.first, 0], p[:, self.first, 1], p[:, self.second, 0], p[:, self.second, 1]
