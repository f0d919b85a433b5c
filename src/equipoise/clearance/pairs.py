"""The distances between the parts that must keep apart: of capsules at once, of other solids where that may matter."""

from __future__ import annotations

import numpy as np

from ..kinematics import Poses, Tree
from ..model.arrays import Array, Booleans, Integers
from ..model.mechanism import Mechanism
from .room import Room
from .segments import closest

BLOCK = 32  # poses whose distance to a solid is measured before the next are looked at


class Pairs:
    """Every spring, weight and auxiliary link with every other, and with every link that it is not fixed to.

    Attributes:
        room: the parts.
        names: of each pair.
        first, second: (pairs,) numbers of parts.
        bodies: of each part, of its two ends.
        ends: (parts, 2, 3) their ends, in the bodies' frames [m].
        radius: of each [m]; of a solid that of the capsule that it lies in.
        solid: (pairs,) whether the second is no capsule.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.tree, self.room = Tree.of(mechanism), Room.of(mechanism)
        parts = self.room.parts
        self.bodies = [part.bodies for part in parts]
        self.ends = np.array([part.ends for part in parts]).reshape(-1, 2, 3)
        self.radius = np.array([part.radius for part in parts])
        pairs = list(self.room.pairs())
        self.first, self.second = (np.array([pair[side] for pair in pairs], int) for side in (0, 1))
        self.names = [(parts[i].name, parts[j].name) for i, j in pairs]
        self.solid = np.array([parts[j].solid is not None for _, j in pairs], bool)

    def distances(self, poses: Poses, least: Array | None = None) -> Array:
        """(N, pairs) [m] between surfaces, less than 0 where they overlap.

        Args:
            least: (pairs,) [m] of each pair the least that matters, lowered here to the least that is found: what is
                farther may come out too near, but not as near as that.
        """
        p = self.points(poses, self.ends)
        found = closest(*self.of_both(p))[0] - self.radius[self.first] - self.radius[self.second]
        for pair in np.flatnonzero(self.solid):
            column = found[:, pair]
            order = np.argsort(column)  # of what it is at least
            for start in range(0, len(order), BLOCK):
                pose = order[start : start + BLOCK]
                if least is not None:
                    pose = pose[column[pose] < least[pair]]
                if not len(pose):
                    break
                column[pose] = self.to_solids(poses, p, pose, np.full(len(pose), pair))[0]
                if least is not None:
                    least[pair] = min(least[pair], column[pose].min())
        return found

    def nearest(self, poses: Poses) -> Array:
        """(N,) [m] the least distance of all at each pose; inf where there are no pairs."""
        p = self.points(poses, self.ends)
        found = closest(*self.of_both(p))[0] - self.radius[self.first] - self.radius[self.second]
        least = found[:, ~self.solid].min(axis=1, initial=np.inf)
        solid = np.flatnonzero(self.solid)
        while len(solid):  # those nearest by the capsules that they lie in, as long as one may be nearer than the least
            column = solid[np.argmin(found[:, solid], axis=1)]
            pose = np.flatnonzero(found[np.arange(len(found)), column] < least)
            if not len(pose):
                break
            exact = self.to_solids(poses, p, pose, column[pose])[0]
            least[pose] = np.minimum(least[pose], exact)
            found[pose, column[pose]] = np.inf
        return least

    def to_solids(self, poses: Poses, p: Array, pose: Integers, pair: Integers) -> tuple[Array, Array, Array]:
        """Of pairs whose second is a solid, at poses, both (M,): `Solid.distances`, the normal in the world."""
        distance, s, n = np.empty(len(pose)), np.empty(len(pose)), np.empty((len(pose), 3))
        for number in np.unique(pair):
            at: Booleans = pair == number
            i, j = self.first[number], self.second[number]
            solid, where = self.room.parts[j].solid, pose[at]
            assert solid is not None
            body = self.bodies[j][0]
            R, origin = poses.R[where, body], poses.p[where, body]
            a, b = (np.einsum("nij,ni->nj", R, p[where, i, e] - origin) for e in (0, 1))
            distance[at], s[at], normal = solid.distances(a, b, float(self.radius[i]))
            n[at] = np.einsum("nij,nj->ni", R, normal)
        return distance, s, n

    def between(self, poses: Poses, pair: int) -> tuple[Array, Array]:
        """Of one pair in one pose, where they are closest: on the surface of each, (3,) in the world [m]."""
        p = self.points(poses, self.ends)
        a, b, c, d = (x[0, pair] for x in self.of_both(p))
        distance, s, t = closest(a, b, c, d)
        radii = self.radius[[self.first[pair], self.second[pair]]]
        if self.solid[pair]:
            found, along, normals = self.to_solids(poses, p, np.zeros(1, int), np.full(1, pair))
            gap, s, n = found[0], along[0], normals[0]
        else:
            gap, n = distance - radii.sum(), (a + s * (b - a) - c - t * (d - c)) / max(float(distance), 1e-12)
        here = a + s * (b - a) - radii[0] * n
        return here, here - gap * n

    def points(self, poses: Poses, ends: Array) -> Array:
        """(N, parts, 2, 3) the ends in the world [m]."""
        if not self.bodies:
            return np.empty((len(poses.p), 0, 2, 3))
        sides = [
            np.stack([poses.point(body[e], at[e]) for body, at in zip(self.bodies, ends, strict=True)], axis=1)
            for e in (0, 1)
        ]
        p = np.stack(sides, axis=2)
        touches = {}
        for i, part in enumerate(self.room.parts):
            for e, cable, mark in part.pulleys:
                if cable.name not in touches:
                    touches[cable.name] = cable.touches(self.tree, poses)
                p[:, i, e] = touches[cable.name][mark][1 - e]  # a part that ends on a pulley comes from before it
        return p

    def of_both(self, p: Array) -> tuple[Array, Array, Array, Array]:
        """Of (N, parts, 2, 3) the four ends of every pair, (N, pairs, 3) each."""
        return p[:, self.first, 0], p[:, self.first, 1], p[:, self.second, 0], p[:, self.second, 1]
