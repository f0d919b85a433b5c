"""One way of assembling a mechanism's loops: all the closed poses that paths from its assembly pose lead to.

Waypoints are closed poses all over the ranges, found from each other; every other pose is reached from the nearest.
Where joint angles are related, as in a parallelogram, the relations take the place of coordinates: so the branch goes
on through the poses where it folds, and no path strays into the other branch that it meets there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from enum import IntEnum
from functools import cached_property, lru_cache

import numpy as np

from ..model.arrays import Array, Integers
from ..model.mechanism import SINGLE, Body, Coupling, Mechanism
from . import assembly
from .closure import Closure
from .continuation import Closed, follow, tangents
from .relations import relations
from .sampling import bounds, inside
from .tolerances import SHORTEST
from .tree import Tree

NEARBY = 0.05  # [rad, or share of the size] from the assembly pose, where relations are looked for
LEAST_BEND = 1e-3  # so that of two waypoints that serve alike the nearer one is taken
NOTHING = 1e-12  # a smaller derivative of the loop equations is rounding
SINGULAR = 1e7  # condition number of the loop equations from which on a pose is singular
WAYPOINTS = 512  # goals of a round
FLOODS = 4  # each in the box of what the last has reached
MARGIN = 0.25  # of that box, on every side
ENOUGH = 0.5  # of the goals: no more rounds
ATTEMPTS = 3  # nearest waypoints that a pose is tried from
FLOOD = 3  # nearest reached waypoints that a goal is tried from
COARSE = 0.02  # [rad, or share of the size] shortest step between waypoints: they end far from singular poses
DISTANCES = 4_000_000  # between poses and waypoints, held at a time
REMEMBERED = 131_072  # poses


class Status(IntEnum):
    """What became of a pose: its loops close; no path from the assembly pose leads there; it is singular."""

    CLOSED = 0
    UNREACHABLE = 1
    SINGULAR = 2


class Branch:
    """The closed poses of a mechanism. Make it with `Branch.of`: springs, masses and gravity make no difference.

    Attributes:
        open: the spanning tree, loops ignored.
        assembled: (open.n,) the closed pose that all others are reached from.
        mobility: how many ways the mechanism can move.
        within: the branch of the mechanism with the relations as couplings, in the coordinates `kept` of this one; None
            where there are none.
        split: which coordinates of the spanning tree are independent.

    Raises:
        InputError: it cannot be assembled, its assembly pose is singular, or its `independent` coordinates are not.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.open = Tree(mechanism)
        self.closure = Closure(self.open)
        self.assembled = assembly.assemble(self.closure)
        self.mobility = assembly.mobility(self.closure, self.assembled)
        self.split = assembly.choose(self.closure, self.assembled, self.mobility.numerical)
        self._remembered: dict[bytes, tuple[Array, Status]] = {}
        self.within: Branch | None = None
        found = tuple(self._relations())
        if found:
            names = self.open.coordinates
            start = dict(zip(names, self.assembled.tolist(), strict=True))
            kept = [name for name in names if name not in {one.joint for one in found}]
            self.within = Branch(replace(
                mechanism,
                couplings=(*mechanism.couplings, *found),
                independent=tuple(names[j] for j in self.split.independent),
                assembly=tuple((name, start[name]) for name in kept),
            ))  # fmt: skip
            self.kept = [names.index(name) for name in kept]
            self._spread, self._offset = np.zeros((len(names), len(kept))), np.zeros(len(names))
            self._spread[self.kept, range(len(kept))] = 1.0
            for one in found:
                j = names.index(one.joint)
                self._offset[j] = one.offset
                for name, ratio in one.terms:
                    self._spread[j, [str(one) for one in kept].index(name)] = ratio

    def _relations(self) -> Iterator[Coupling]:
        """Between the joints, at poses near the assembly pose."""
        single = {joint.name for joint in self.open.mechanism.joints if joint.type in SINGLE}
        names, first = self.open.coordinates, self.split.independent.tolist()
        if not single & {names[j] for j in self.split.dependent}:
            return
        count = 4 * self.open.n
        start = tangents(self.closure, self.split, self.assembled[None])
        if start.condition.max(initial=0) > SINGULAR:
            return
        aside = np.random.default_rng(0).uniform(-NEARBY, NEARBY, (count, len(first)))
        goal = self.assembled[first] + aside * self.closure.scale[first]
        q, reached = follow(self.closure, self.split, start, np.zeros(count, int), goal)
        if reached.sum() > 2 * self.open.n:
            yield from relations(q[reached], [name in single for name in names], names, first)

    @staticmethod
    def of(mechanism: Mechanism) -> Branch:
        """The branch of `mechanism`; the last few are remembered."""
        bodies = tuple(Body(body.name) for body in mechanism.bodies)
        return _branch(
            Mechanism(
                "",
                bodies,
                mechanism.joints,
                mechanism.couplings,
                mechanism.loops,
                independent=mechanism.independent,
                assembly=mechanism.assembly,
            )
        )

    def solve(self, u: Array) -> tuple[Array, Integers]:
        """All coordinates (N, open.n) at independent ones `u` (N, m), NaN where not closed, and (N,) the `Status`."""
        u = np.ascontiguousarray(u, float) + 0.0  # -0 is 0
        keys = [row.tobytes() for row in u]
        new = list({key: i for i, key in enumerate(keys) if key not in self._remembered}.values())
        known = self._remembered
        if len(known) + len(new) > REMEMBERED:
            self._remembered = {}
        if new:
            found = dict(zip((keys[i] for i in new), zip(*self._close(u[new]), strict=True), strict=True))
            self._remembered.update(found)
            known = known | found
        pairs = [known[key] for key in keys]
        full = np.array([q for q, _ in pairs], float).reshape(len(u), self.open.n)
        return full, np.array([status for _, status in pairs], int)

    def _close(self, u: Array) -> tuple[Array, Integers]:
        """`solve` for new poses: from the nearest waypoint, then from the next ones."""
        if self.within is not None:
            q, status = self.within.solve(u)
            full = q @ self._spread.T + self._offset
            return self._without_singular(full, status)
        way = self._waypoints
        full, status = np.full((len(u), self.open.n), np.nan), np.full(len(u), int(Status.UNREACHABLE))
        near = self._nearest(u, way.q)
        todo = np.flatnonzero(np.isfinite(u).all(axis=1))
        for start in near.T:
            q, reached = follow(self.closure, self.split, way, start[todo], u[todo], SHORTEST)
            full[todo[reached]] = q[reached]
            status[todo[reached]] = Status.CLOSED
            todo = todo[~reached]
        return self._without_singular(full, status)

    def _without_singular(self, full: Array, status: Integers) -> tuple[Array, Integers]:
        """Poses and their status where singular ones are none."""
        closed = np.flatnonzero(status == Status.CLOSED)
        bad = closed[~(tangents(self.closure, self.split, full[closed]).condition < SINGULAR)]
        full[bad], status[bad] = np.nan, Status.SINGULAR
        return full, status

    def close(self, full: Array) -> Array:
        """(N,) how many times nearer to a singular pose than usual `full` (N, open.n) is; 0 where it is not closed.

        By the least change of the loop equations for a unit change of the dependent coordinates: it is nothing at a
        singular pose, and grows with the distance. Where relations lead through one, it counts nevertheless: ask
        `within` for those that they do not lead through.
        """
        found = np.zeros(len(full))
        good = np.flatnonzero(~np.isnan(full).any(axis=1))
        with np.errstate(divide="ignore"):
            found[good] = self._usual / self._distance(full[good])
        return found

    def _distance(self, full: Array) -> Array:
        there = tangents(self.closure, self.split, full)
        return np.linalg.norm(there.J, axis=(1, 2)) / there.condition

    @cached_property
    def _usual(self) -> float:
        """The distance of half of the waypoints."""
        q = self._waypoints.q if self.within is None else self.within._waypoints.q @ self._spread.T + self._offset
        return float(np.median(self._distance(q)))

    def rates(self, full: Array) -> Array:
        """dq/du (N, open.n, m) at closed coordinates `full` (N, open.n); NaN where not closed."""
        if self.within is not None:
            return self._spread @ self.within.rates(full[:, self.kept])
        split, scale = self.split, self.closure.scale
        rates = np.full((len(full), self.open.n, len(split.independent)), np.nan)
        good = np.flatnonzero(~np.isnan(full).any(axis=1))
        T = tangents(self.closure, split, full[good]).T
        rates[good] = 0.0
        rates[np.ix_(good, split.independent)] = np.eye(len(split.independent))
        rates[np.ix_(good, split.dependent)] = T * scale[split.dependent, None] / scale[split.independent]
        return rates

    def _nearest(self, u: Array, q: Array) -> Integers:
        """(N, k) numbers of the nearest poses of `q` (K, open.n), nearest first."""
        k, size = min(ATTEMPTS, len(q)), max(16, DISTANCES // len(q))
        found = np.zeros((len(u), k), int)
        for i in range(0, len(u), size):
            apart = self._apart(u[i : i + size], q, self._bend)
            near = np.argpartition(apart, k - 1, axis=1)[:, :k]
            order = np.take_along_axis(apart, near, axis=1).argsort(axis=1)
            found[i : i + size] = np.take_along_axis(near, order, axis=1)
        return found

    def _apart(self, u: Array, q: Array, weight: Array | float = 1.0) -> Array:
        """(N, K) distances of independent coordinates `u` (N, m) from those of poses `q` (K, open.n).

        In widths times `weight` (m,). What turns a loop as a whole has none: it needs no other start.
        """
        a, b = ((x * (weight / self._width))[:, self._matters] for x in (u, q[:, self.split.independent]))
        return np.sqrt(np.maximum((a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1) - 2 * a @ b.T, 0.0))

    @cached_property
    def _bend(self) -> Array:
        """(m,) how much the tangents change with each independent coordinate, over the waypoints.

        A rod's spin has nothing: the other joints follow it in proportion, so that one step goes all the way.
        """
        low, high = np.quantile(self._waypoints.T, (0.1, 0.9), axis=0)
        bend = (high - low).max(axis=0, initial=0.0)
        return np.maximum(bend / max(bend.max(initial=0.0), NOTHING), LEAST_BEND)

    @cached_property
    def _ranges(self) -> tuple[Array, Array]:
        lower, upper = bounds(self.open)
        return lower[self.split.independent], upper[self.split.independent]

    @cached_property
    def _width(self) -> Array:
        lower, upper = self._ranges
        return np.where(upper > lower, upper - lower, 1.0)

    @cached_property
    def _matters(self) -> Integers:
        """Which of the independent coordinates change the loop equations: at random poses, open ones too."""
        J = self.closure.at(np.random.default_rng(0).uniform(-1, 1, (8, self.open.n)))[1][:, :, self.split.independent]
        return np.flatnonzero(np.abs(J).max(axis=(0, 1), initial=0) > NOTHING)

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Lower and upper ends (m,) of a box round the poses that are reached inside the ranges, with a margin."""
        if self.within is not None:
            return self.within.box
        return self._around(self._waypoints.q)

    def _around(self, q: Array) -> tuple[Array, Array]:
        q = q[inside(self.open, q, 1e-9)]
        lower, upper = self._ranges
        if len(q) == 0:
            return lower, upper
        low, high = (f(q[:, self.split.independent], axis=0) for f in (np.min, np.max))
        margin = MARGIN * np.maximum(high - low, (upper - lower) / WAYPOINTS)
        return np.maximum(lower, low - margin), np.minimum(upper, high + margin)

    @cached_property
    def _waypoints(self) -> Closed:
        rng = np.random.default_rng(0)
        reached = self._with(None, self.assembled[None])
        box = self._ranges
        for _ in range(FLOODS if len(self.split.independent) else 0):
            before = len(reached.q)
            reached = self._flooded(reached, rng.uniform(*box, (WAYPOINTS, len(box[0]))))
            box = self._around(reached.q)
            if len(reached.q) - before > ENOUGH * WAYPOINTS:
                break
        return reached

    def _flooded(self, reached: Closed, goals: Array) -> Closed:
        """With what can be reached of the goals, each from the nearest poses that are reached already."""
        tried = np.zeros((len(goals), 0), bool)
        todo = np.arange(len(goals))
        while len(todo):
            tried = np.hstack([tried, np.zeros((len(goals), len(reached.q) - tried.shape[1]), bool)])
            apart = np.where(tried[todo], np.inf, self._apart(goals[todo], reached.q))
            worth = np.isfinite(apart.min(axis=1)) & (tried[todo].sum(axis=1) < FLOOD)
            todo, start = todo[worth], apart[worth].argmin(axis=1)
            tried[todo, start] = True
            q, done = follow(self.closure, self.split, reached, start, goals[todo], COARSE)
            reached = self._with(reached, q[done])
            todo = todo[~done]
        return reached

    def _with(self, way: Closed | None, q: Array) -> Closed:
        """With the closed poses `q` added, but for singular ones."""
        new = tangents(self.closure, self.split, q)
        new = new[new.condition < SINGULAR]
        return new if way is None else way.with_more(new)


@lru_cache(maxsize=8)
def _branch(kinematics: Mechanism) -> Branch:
    return Branch(kinematics)
