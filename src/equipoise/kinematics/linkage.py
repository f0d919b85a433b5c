"""Kinematics of mechanisms with loops: `Tree`'s interface, with the independent coordinates in the place of q.

The dependent coordinates of the spanning tree are solved for (THEORY section 6): q = f(u), and velocities are
multiplied by dq/du. Poses that do not close are NaN in everything, so that no torque is ever given for them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import numpy as np

from ..arrays import Array, Integers
from ..mechanism import Mechanism
from . import assembly
from .closure import Closure
from .continuation import chunk, follow, tangent
from .sampling import bounds
from .tree import Poses, Tree, Velocities

SINGULAR = 1e7  # condition number of the loop equations from which on a pose is singular
WAYPOINTS = 512  # poses that others are reached from
ATTEMPTS = 4  # of the nearest waypoints, before the assembly pose
FLOOD = 12  # nearest reached waypoints that an unreached one is tried from
REMEMBERED = 65_536  # poses


class Status(IntEnum):
    """What became of a pose: its loops close; no path from the assembly pose leads there; it is singular."""

    CLOSED = 0
    UNREACHABLE = 1
    SINGULAR = 2


@dataclass(frozen=True)
class ClosedPoses(Poses):
    """Poses with the coordinates `q` (N, tree coordinates) [rad or m] they were computed from, NaN where not closed."""

    q: Array


@dataclass(frozen=True)
class _Waypoints:
    """Closed poses `q` (K, n) with the tangents and Jacobians there."""

    q: Array
    T: Array
    J: Array


class Linkage(Tree):
    """A mechanism with loops compiled for kinematics; `Tree.of` makes it. See `Tree` for the common attributes.

    `C` says only how the independent coordinates turn joints by themselves and through couplings, not through loops.

    Attributes:
        open: the spanning tree, loops ignored.
        assembled: (open.n,) the closed pose that all others are reached from.
        mobility: how many ways it can move.
        split: which coordinates of the spanning tree are independent.

    Raises:
        InputError: it cannot be assembled, its assembly pose is singular, or its `independent` coordinates are not.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        super().__init__(mechanism)
        self.open = Tree(mechanism)
        self.closure = Closure(self.open)
        self.assembled = assembly.assemble(self.closure)
        self.mobility = assembly.mobility(self.closure, self.assembled)
        self.split = assembly.choose(self.closure, self.assembled, self.mobility.numerical)
        self.coordinates = tuple(self.open.coordinates[j] for j in self.split.independent)
        self.n = len(self.coordinates)
        self.C = self.open.C[:, self.split.independent]
        self._remembered: dict[bytes, tuple[Array, Status]] = {}

    def values(self, q: Array) -> Array:
        """(N, motions) every elementary joint value [rad or m]; NaN where the loops do not close."""
        return self.open.values(self.solve(q)[0])

    def poses(self, q: Array) -> ClosedPoses:
        """Body poses at `q` (N, n) [rad or m]; NaN where the loops do not close."""
        full, _ = self.solve(q)
        poses = self.open.poses(full)
        bad = np.isnan(full).any(axis=1)
        poses.R[bad], poses.p[bad] = np.nan, np.nan  # of the bodies before the loops too
        return ClosedPoses(poses.R, poses.p, full)

    def velocities(self, q: Array, poses: Poses) -> Velocities:
        """Analytic body velocities per unit rate of each independent coordinate, at `q` (N, n) with its `poses`."""
        full = poses.q if isinstance(poses, ClosedPoses) else self.solve(q)[0]
        velocities = self.open.velocities(full, poses)
        rates = self._rates(full, poses, velocities)
        return Velocities(velocities.w @ rates[:, None], velocities.v @ rates[:, None])

    def _rates(self, full: Array, poses: Poses, velocities: Velocities) -> Array:
        """dq/du (N, open.n, n)."""
        rates = np.full((len(full), self.open.n, self.n), np.nan)
        good = ~np.isnan(full).any(axis=1)
        J = self.closure.jacobian(poses, velocities)[good]
        T, _ = tangent(J, self.split)
        scale = self.closure.scale
        own = np.zeros((len(J), self.open.n, self.n))
        own[:, self.split.independent, np.arange(self.n)] = 1.0
        own[:, self.split.dependent] = T * scale[self.split.dependent, None] / scale[self.split.independent]
        rates[good] = own
        return rates

    def status(self, q: Array) -> Integers:
        """(N,) the `Status` of each pose."""
        return self.solve(q)[1]

    def solve(self, q: Array) -> tuple[Array, Integers]:
        """All coordinates (N, open.n) of the spanning tree, NaN where the loops do not close, and (N,) the `Status`."""
        q = np.ascontiguousarray(q, float) + 0.0  # -0 is 0
        keys = [row.tobytes() for row in q]
        new = list({key: i for i, key in enumerate(keys) if key not in self._remembered}.values())
        found = dict(self._remembered) if len(self._remembered) + len(new) > REMEMBERED else self._remembered
        if found is not self._remembered:
            self._remembered.clear()
        size = chunk(self.closure)
        for start in range(0, len(new), size):
            rows = new[start : start + size]
            for i, full, status in zip(rows, *self._close(q[rows]), strict=True):
                found[keys[i]] = self._remembered[keys[i]] = full, status
        if not len(q):
            return np.zeros((0, self.open.n)), np.zeros(0, int)
        pairs = [found[key] for key in keys]
        return np.array([full for full, _ in pairs]).reshape(len(q), self.open.n), np.array([s for _, s in pairs])

    def _close(self, u: Array) -> tuple[Array, Integers]:
        """`solve` for one chunk of new poses: from the nearest waypoints, at last from the assembly pose."""
        way = self._waypoints
        full, status = np.full((len(u), self.open.n), np.nan), np.full(len(u), Status.UNREACHABLE)
        tried = min(ATTEMPTS, len(way.q))
        order = np.argpartition(self._distance(u, way.q), tried - 1, axis=1)[:, :tried] if tried < len(way.q) else None
        order = np.tile(np.arange(len(way.q)), (len(u), 1)) if order is None else order
        apart = np.take_along_axis(self._distance(u, way.q), order, axis=1)
        order = np.take_along_axis(order, np.argsort(apart, axis=1), axis=1)
        order = np.column_stack([order, np.zeros(len(u), int)])  # the assembly pose is the first waypoint
        todo = np.flatnonzero(np.isfinite(u).all(axis=1))
        for k in range(order.shape[1]):
            start = order[todo, k]
            q, reached = follow(self.closure, self.split, way.q[start], way.T[start], way.J[start], u[todo])
            full[todo[reached]] = q[reached]
            status[todo[reached]] = Status.CLOSED
            todo = todo[~reached]
            if not len(todo):
                break
        closed = np.flatnonzero(status == Status.CLOSED)
        _, condition = tangent(self.closure.at(full[closed])[1], self.split)
        bad = closed[~(condition < SINGULAR)]
        full[bad], status[bad] = np.nan, Status.SINGULAR
        return full, status

    @cached_property
    def _width(self) -> Array:
        lower, upper = bounds(self)
        return np.where(upper > lower, upper - lower, 1.0)

    def _distance(self, u: Array, q: Array) -> Array:
        """(N, K) between independent coordinates `u` (N, n) and those of poses `q` (K, open.n), ranges being 1."""
        a, b = u / self._width, q[:, self.split.independent] / self._width
        return np.linalg.norm(a[:, None] - b, axis=2)

    @cached_property
    def _waypoints(self) -> _Waypoints:
        """Closed poses all over the ranges, the assembly pose first: reached straight from it, else from each other."""
        rng = np.random.default_rng(0)
        goals = rng.uniform(*bounds(self), (WAYPOINTS if self.n else 0, self.n))
        reached = self._extended(_Waypoints(*(np.zeros((0, *x.shape[1:])) for x in self._at(self.assembled[None]))), self.assembled[None])
        tried = np.zeros((len(goals), 0), bool)
        todo = np.arange(len(goals))
        while len(todo):
            tried = np.hstack([tried, np.zeros((len(goals), len(reached.q) - tried.shape[1]), bool)])
            apart = np.where(tried[todo], np.inf, self._distance(goals[todo], reached.q))
            start = apart.argmin(axis=1)
            worth = np.isfinite(apart.min(axis=1)) & (tried[todo].sum(axis=1) < FLOOD)
            todo, start = todo[worth], start[worth]
            tried[todo, start] = True
            found = []
            size = chunk(self.closure)
            done = np.zeros(len(todo), bool)
            for i in range(0, len(todo), size):
                part = slice(i, i + size)
                q, ok = follow(
                    self.closure, self.split, reached.q[start[part]], reached.T[start[part]], reached.J[start[part]],
                    goals[todo[part]],
                )
                found.append(q[ok])
                done[part] = ok
            reached = self._extended(reached, np.concatenate(found)) if found else reached
            todo = todo[~done]
        return reached

    def _at(self, q: Array) -> tuple[Array, Array, Array]:
        J = self.closure.at(q)[1]
        return q, tangent(J, self.split)[0], J

    def _extended(self, way: _Waypoints, q: Array) -> _Waypoints:
        """With the poses `q` added, but for singular ones."""
        J = self.closure.at(q)[1]
        T, condition = tangent(J, self.split)
        good = condition < SINGULAR
        return _Waypoints(*(np.concatenate([a, b[good]]) for a, b in ((way.q, q), (way.T, T), (way.J, J))))
