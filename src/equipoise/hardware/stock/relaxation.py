"""Choosing from stock as a mixed-integer linear program that is never too strict.

For spring s one stock spring is taken: k = sum k_i x_i. With u = ka and v = kb the balance equations, the ranges of a
and b, and the largest force, k |t - a e_a + b e_b| <= F_i in any direction, are linear. Only w = kab is not: over a
cell [p, q] x [r, s] of distances it is kept between McCormick's four planes, multiplied by k,

    w >= p v + r u - p r k,   w >= q v + s u - q s k,   w <= q v + r u - q r k,   w <= p v + s u - p s k

which smaller cells bring as near to the truth as need be. So its optimum is a bound, what it excludes is impossible.
All distances and stiffnesses are relative to the design's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ...model.arrays import Array, Integers, frozen
from ...model.errors import EquipoiseError
from .movable import Movable

if TYPE_CHECKING:
    from scipy.sparse import csr_array

TERMS = 5  # variables of a cell: whether it is the one, and its k, u, v, w


class OutOfTime(EquipoiseError):
    """Whether there is a solution is not known yet."""

    exit_code = 1


@frozen
class Pull:
    """A force that spring `spring` must stand: `terms` . [k, ka, kb] [N] is at most the largest force of its stock."""

    spring: int
    terms: Array


@frozen
class Relaxed:
    """What the program found: stock of each spring, distances (springs, 2), the cost and a bound of every cost."""

    stock: tuple[int, ...]
    shares: Array
    cost: float
    bound: float


@dataclass(eq=False)
class Relaxation:
    """The program; cells, pulls and exclusions are added as it goes.

    Attributes:
        allowed: for each spring, the stock that may be taken (indices).
        stiffness, force, cost: (stock,) [N/m], [N] and what is to be least.
        edges: for each spring the edges of its cells in the relative distances a and b.
    """

    movable: Movable
    stiffness: Array
    force: Array
    cost: Array
    allowed: list[Integers]
    edges: list[tuple[Array, Array]]
    pulls: list[Pull] = field(default_factory=list)
    excluded: list[tuple[int, ...]] = field(default_factory=list)

    def relative(self, spring: int) -> Array:
        """Relative stiffnesses of the stock allowed for a spring."""
        return self.stiffness[self.allowed[spring]] / self.movable.springs[spring].stiffness

    def split(self, shares: Array) -> bool:
        """Cut the cells that hold the distances (springs, 2); False when they are as small as makes sense."""
        cut = False
        for i in range(len(self.edges)):
            pair = list(self.edges[i])
            widths = []
            for j in range(2):
                n = int(np.clip(np.searchsorted(pair[j], shares[i, j]) - 1, 0, len(pair[j]) - 2))
                widths.append((float(pair[j][n + 1] - pair[j][n]), n))
            j = int(widths[1][0] > widths[0][0])  # the wider side
            width, n = widths[j]
            if width > FINEST:
                left, right = pair[j][n], pair[j][n + 1]
                at = float(np.clip(shares[i, j], left + width / 4, right - width / 4))
                pair[j] = np.insert(pair[j], n + 1, at)
                self.edges[i] = (pair[0], pair[1])
                cut = True
        return cut

    def solve(self, fixed: tuple[int, ...] | None = None, seconds: float = np.inf) -> Relaxed | None:
        """The least cost; with the stock `fixed`, a point well inside. None when there is no solution.

        Raises:
            OutOfTime: no solution was found in the time.
        """
        from scipy.optimize import LinearConstraint, milp

        program = _Program(self, fixed)
        options = {"mip_rel_gap": 0.0, "presolve": True}
        if np.isfinite(seconds):
            options["time_limit"] = max(seconds, 0.1)
        # scipy takes arrays here; its stubs want one number
        constraint = LinearConstraint(program.matrix(), np.array(program.low), np.array(program.high))  # type: ignore[arg-type]
        found = milp(
            program.objective,
            constraints=constraint,
            integrality=program.integer,
            bounds=program.bounds,
            options=options,
        )
        if found.status == 2:
            return None
        if found.x is None:
            raise OutOfTime("no solution was found in the time")
        bound = found.mip_dual_bound if found.mip_dual_bound is not None else found.fun
        return program.read(found.x, float(found.fun), float(bound))


FINEST = 1e-4  # relative width of the smallest cell


class _Program:
    """The matrices of a relaxation."""

    def __init__(self, r: Relaxation, fixed: tuple[int, ...] | None) -> None:
        from scipy.optimize import Bounds

        self.r, self.fixed = r, fixed
        self.allowed = list(r.allowed) if fixed is None else [np.array([i]) for i in fixed]
        self.cells = [_cells(a, b) for a, b in r.edges]
        self.x0, self.c0, size = [], [], 0
        for stock, cells in zip(self.allowed, self.cells, strict=True):
            self.x0.append(size)
            self.c0.append(size + len(stock))
            size += len(stock) + TERMS * len(cells)
        self.slack, self.size = size, size + 1  # how far inside: only with the stock fixed
        self.rows: list[Integers] = []
        self.columns: list[Integers] = []
        self.values: list[Array] = []
        self.low: list[float] = []
        self.high: list[float] = []
        self.integer = np.zeros(self.size)
        self.objective = np.zeros(self.size)
        upper = np.full(self.size, np.inf)
        lower = np.zeros(self.size)
        for i, stock in enumerate(self.allowed):
            x = np.arange(self.x0[i], self.c0[i])
            y = self.c0[i] + TERMS * np.arange(len(self.cells[i]))
            self.integer[x] = self.integer[y] = 1
            upper[x] = upper[y] = 1
            if fixed is None:
                self.objective[x] = r.cost[stock]
        upper[self.slack] = 0.0 if fixed is None else 1.0
        if fixed is not None:
            self.objective[self.slack] = -1.0
        self.bounds = Bounds(lower, upper)  # type: ignore[arg-type]  # the stubs want one number
        for i in range(len(self.allowed)):
            self._spring(i)
        self._balance()
        for pull in r.pulls:
            self._pull(pull)
        for out in r.excluded if fixed is None else ():
            self._exclude(out)

    def add(self, entries: Sequence[tuple[Integers | int, Array | float]], low: float, high: float) -> None:
        """One row of the constraints."""
        for columns, values in entries:
            at = np.atleast_1d(columns)
            self.columns.append(at)
            self.values.append(np.broadcast_to(np.asarray(values, float), at.shape))
            self.rows.append(np.full(len(at), len(self.low)))
        self.low.append(low)
        self.high.append(high)

    def matrix(self) -> csr_array:
        """The constraints' matrix."""
        from scipy.sparse import csr_array

        rows, columns, values = (np.concatenate(x) for x in (self.rows, self.columns, self.values))
        return csr_array((values, (rows, columns)), shape=(len(self.low), self.size))

    def sums(self, i: int) -> tuple[Integers, Integers, Integers, Integers]:
        """Columns of k, u, v, w in all cells of spring `i`."""
        first = self.c0[i] + TERMS * np.arange(len(self.cells[i]))
        return first + 1, first + 2, first + 3, first + 4

    def _spring(self, i: int) -> None:
        k_stock = self.r.stiffness[self.allowed[i]] / self.r.movable.springs[i].stiffness
        x = np.arange(self.x0[i], self.c0[i])
        k, *_ = self.sums(i)
        self.add([(x, 1.0)], 1, 1)
        self.add([(k - 1, 1.0)], 1, 1)
        self.add([(k, 1.0), (x, -k_stock)], 0, 0)
        for j, (p, q, r, s) in enumerate(self.cells[i]):
            y = self.c0[i] + TERMS * j
            K, U, V, W = y + 1, y + 2, y + 3, y + 4
            self.add([(K, 1.0), (y, -k_stock.max())], -np.inf, 0)
            for side, low, high in ((U, p, q), (V, r, s)):
                self.add([(side, 1.0), (K, -low)], 0, np.inf)
                self.add([(side, 1.0), (K, -high)], -np.inf, 0)
            self.add([(W, 1.0), (V, -p), (U, -r), (K, p * r)], 0, np.inf)
            self.add([(W, 1.0), (V, -q), (U, -s), (K, q * s)], 0, np.inf)
            self.add([(W, 1.0), (V, -q), (U, -r), (K, q * r)], -np.inf, 0)
            self.add([(W, 1.0), (V, -p), (U, -s), (K, p * s)], -np.inf, 0)
        if self.fixed is not None:
            low, high = self.r.movable.low[i], self.r.movable.high[i]
            for j, side in enumerate(self.sums(i)[1:3]):
                width = float(k_stock[0] * (high[j] - low[j]))
                self.add([(side, 1.0), (k, -low[j]), (self.slack, -width)], 0, np.inf)
                self.add([(side, 1.0), (k, -high[j]), (self.slack, width)], -np.inf, 0)

    def _balance(self) -> None:
        for row in self.r.movable.rows:
            entries = [(at, row[i, j]) for i in range(len(row)) for j, at in enumerate(self.sums(i))]
            self.add(entries, row.sum(), row.sum())

    def _pull(self, pull: Pull) -> None:
        i = pull.spring
        x, force = np.arange(self.x0[i], self.c0[i]), self.r.force[self.allowed[i]]
        entries = [(at, term / force.max()) for at, term in zip(self.sums(i)[:3], pull.terms, strict=True)]
        inside = [] if self.fixed is None else [(self.slack, 1.0)]
        self.add([*entries, (x, -force / force.max()), *inside], -np.inf, 0)

    def _exclude(self, out: tuple[int, ...]) -> None:
        """Not all of these at once."""
        entries = []
        for i, stock in enumerate(out):
            at = np.flatnonzero(self.allowed[i] == stock)
            if not len(at):
                return
            entries.append((self.x0[i] + at, 1.0))
        self.add(entries, -np.inf, len(out) - 1)

    def read(self, values: Array, cost: float, bound: float) -> Relaxed:
        """The solution in the terms of the relaxation."""
        stock, shares = [], np.empty((len(self.allowed), 2))
        for i, allowed in enumerate(self.allowed):
            stock.append(int(allowed[np.argmax(values[self.x0[i] : self.c0[i]])]))
            k, u, v, _ = (values[at].sum() for at in self.sums(i))
            shares[i] = u / k, v / k
        return Relaxed(tuple(stock), shares, cost, bound)


def _cells(a: Array, b: Array) -> list[tuple[float, float, float, float]]:
    """(p, q, r, s) of every cell."""
    return [(float(p), float(q), float(r), float(s)) for p, q in pairwise(a) for r, s in pairwise(b)]
