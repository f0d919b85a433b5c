"""The least largest torque over what can be set, with a proof, and of all that reach it what is nearest to the file.

The torque is ``A x + b``, with x in a polygon for each item: a linear program. Its dual is a set of torques with
weights y, ``sum |y| = 1``: for every x the largest torque is at least ``y (A x + b)``, whose least value over the
corners of the polygons is computed without trust in the solver.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...model.arrays import Array, Booleans, Integers, frozen
from ...model.errors import EquipoiseError
from ..convex.semidefinite import conic_solver
from ..dials import Dial

FIRST, CUTS, ROUNDS = 600, 100, 50  # rows of the first program, rows added to it at a time, and how often
CLOSE = 1e-9  # relative: the worst row of all is as good as the worst of the chosen ones
NOTHING = 1e-9  # of the largest torque: exact to the solver, and worth making exact to rounding
HELD = 1e-6  # of a size: so near a limit or the largest torque counts as on it
SETTLED = 3  # times that the rest of the equations is taken up
RANK = 1e-12  # of the largest: equations that say the same


@frozen
class Least:
    """The least largest torque.

    Attributes:
        x: unknowns that reach it.
        value: [N m or N] the largest torque with them; bound: no others leave less.
        rows: those that prove it, with their weights: ``bound = min over x of weights @ (A x + b)[rows]``.
    """

    x: Array
    value: float
    bound: float
    rows: Integers
    weights: Array


@frozen
class Held:
    """Torques ``A x + b`` that must stay within `most` either way."""

    A: Array
    b: Array
    most: float

    @property
    def unit(self) -> float:
        """What they are without anything."""
        return float(np.abs(self.b).max(initial=0.0)) or 1.0

    @property
    def exact(self) -> bool:
        """Whether they must vanish."""
        return self.most <= 10 * NOTHING * self.unit

    def over(self, x: Array) -> float:
        """How many times as large as they may be they are."""
        return float(np.abs(self.A @ x + self.b).max(initial=0.0)) / max(self.most, 10 * NOTHING * self.unit)


def least(A: Array, b: Array, dials: Sequence[Dial], held: Held | None = None) -> Least:
    """The least of ``max |A x + b|`` over the dials: A (rows, unknowns), b (rows,).

    Args:
        held: other torques that stay small; they are no part of the proof.

    Raises:
        EquipoiseError: the solver finds nothing.
    """
    from scipy.optimize import linprog

    size = np.concatenate([dial.size for dial in dials])
    S, unit = A * size / (np.abs(b).max(initial=0.0) or 1.0), float(np.abs(b).max(initial=0.0)) or 1.0
    limits, sides = _polygons(dials)
    limits = limits * size
    if held is not None:
        kept = held.A * size / held.unit
        most = max(held.most * (1 + CLOSE), NOTHING * held.unit) / held.unit
        limits = np.vstack([limits, kept, -kept])
        sides = np.concatenate([sides, most - held.b / held.unit, most + held.b / held.unit])
    fixed = np.hstack([limits, np.zeros((len(limits), 1))])
    chosen = np.zeros(len(b), bool)
    chosen[np.argsort(-np.abs(b), kind="stable")[:FIRST]] = True
    rounds = 0
    while True:
        rounds += 1
        rows, one = np.flatnonzero(chosen), np.ones((int(chosen.sum()), 1))
        found = linprog(
            np.append(np.zeros(len(size)), 1.0),
            np.vstack([np.hstack([S[rows], -one]), np.hstack([-S[rows], -one]), fixed]),
            np.concatenate([-b[rows] / unit, b[rows] / unit, sides]),
            bounds=(None, None),
        )
        if found.x is None:
            raise EquipoiseError(f"the linear solver stopped: {found.message}")
        x = found.x[:-1] * size
        left = np.abs(A @ x + b)
        close = left.max(initial=0.0) <= found.fun * unit * (1 + CLOSE) + NOTHING * unit
        if close or chosen.all() or rounds == ROUNDS:
            break
        chosen[np.argsort(-left, kind="stable")[:CUTS]] = True
    y = found.ineqlin.marginals
    weights = y[len(rows) : 2 * len(rows)] - y[: len(rows)]  # of rows that are least at -t and at t
    used = np.flatnonzero(weights)
    weights, rows = weights[used], rows[used]
    total = float(np.abs(weights).sum())
    weights = weights / total if total else weights
    bound = max(0.0, proved(A[rows], b[rows], weights, dials)) if held is None else 0.0
    return Least(x, float(left.max(initial=0.0)), bound, rows, weights)


def proved(A: Array, b: Array, weights: Array, dials: Sequence[Dial]) -> float:
    """What the largest of ``|A x + b|`` is at least, whatever the dials: the weights add up to 1, signs aside."""
    slope, value, start = weights @ A, float(weights @ b), 0
    for dial in dials:
        own = slope[start : start + len(dial.settings)]
        start += len(own)
        value += float((dial.corners @ own).min())
    return value


def nearest(groups: Sequence[Held], dials: Sequence[Dial], start: Array) -> Array:
    """Of the unknowns that keep all torques as small as they must be, those nearest to the file.

    Distances are in shares of what the file has. Torques that must vanish do, to rounding.

    Args:
        start: unknowns that are known to do it; given back where the solver finds nothing better.
    """
    size, now = np.concatenate([dial.size for dial in dials]), np.concatenate([dial.now for dial in dials])
    P, p = _polygons(dials)
    if (P @ now <= p).all() and max(group.over(now) for group in groups) <= 1 + CLOSE:
        return now
    limits, zero, one = np.column_stack([P * size, -p]), np.zeros((0, len(size) + 1)), np.eye(len(size) + 1)[-1]
    every = []  # as many rows of the others as matter
    for group in groups:
        rows = np.column_stack([group.A * size, group.b])
        if group.exact:  # the same in as few rows as can be
            zero = np.vstack([zero, np.linalg.qr(rows / group.unit, mode="r")])
        else:
            every.append(rows / (group.most * (1 + CLOSE)))
    rows = np.vstack([*every, zero[:0]])
    chosen = np.abs(rows @ np.append(start / size, 1.0)) > 0.5
    rounds = 0
    while True:
        rounds += 1
        within = np.vstack([rows[chosen] - one, -rows[chosen] - one, limits])
        z = _least_distance(now / size, zero, within)
        if z is None:
            return start
        over = np.abs(rows @ np.append(z, 1.0)) > 1 + CLOSE
        if not (over & ~chosen).any() or rounds == ROUNDS:
            break
        chosen |= over
    for x in (_projected(now / size, z, zero, within) * size, z * size):
        if max(group.over(x) for group in groups) <= 1 + HELD:
            return x
    return start


def _polygons(dials: Sequence[Dial]) -> tuple[Array, Array]:
    """All polygons as ``P x <= p``, every row in units of its item."""
    from scipy.linalg import block_diag

    each = [dial.polygon for dial in dials]
    scale = np.concatenate([np.abs(A * dial.size).max(axis=1) for (A, _), dial in zip(each, dials, strict=True)])
    return block_diag(*(A for A, _ in each)) / scale[:, None], np.concatenate([b for _, b in each]) / scale


def _least_distance(z0: Array, zero: Array, limits: Array) -> Array | None:
    """The point nearest to z0 with ``zero @ [z, 1] = 0`` and ``limits @ [z, 1] <= 0``; None where none is found."""
    from scipy import sparse

    clarabel = conic_solver()
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    rows = np.vstack([zero, limits])
    cones = [clarabel.ZeroConeT(len(zero)), clarabel.NonnegativeConeT(len(limits))]
    n = len(z0)
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix(np.eye(n)), -z0, sparse.csc_matrix(rows[:, :-1]), -rows[:, -1], cones, settings
    )
    solution = solver.solve()
    return np.array(solution.x) if str(solution.status) in ("Solved", "AlmostSolved") else None


def _projected(z0: Array, z: Array, zero: Array, limits: Array) -> Array:
    """The point nearest to z0 on the equations and on the limits that z is on, to rounding."""
    on: Booleans = limits @ np.append(z, 1.0) > -HELD
    rows = np.vstack([zero, limits[on]])
    for _ in range(SETTLED):
        z0 = z0 - np.linalg.lstsq(rows[:, :-1], rows @ np.append(z0, 1.0), rcond=RANK)[0]
    return z0
