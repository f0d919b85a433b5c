"""The least torque that any choice of parts can leave: a convex program (docs/theory.md, sections 1 and 4).

Unknowns are those of the blocks, each in its cone. Any set of parts, however many, is a feasible point, so the optimum
is a lower bound for every design on these blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from math import isqrt
from typing import Any

import numpy as np

from ...model.arrays import Array, Integers, frozen
from ...model.errors import EquipoiseError
from .least_squares_form import LeastSquaresForm

LINEAR = ("zero", "nonnegative")
FINE, COARSE = 1e-9, 1e-6  # tolerances of a bound, and of where parts are looked for
LARGE, STRETCH = 100.0, 1000.0  # unknowns so large want other units; how much larger these are
SAFE = 10.0  # times what the solver still violates: so far its optimum may be off
STALLED = 1e-4  # violation of the constraints that is still close to the optimum


@frozen
class Bound:
    """The least torque that any parts of the blocks can leave.

    Attributes:
        value: as a share of the unbalanced torque (rms or peak): the lesser of the program's primal and dual optimum,
            valid up to the solver's tolerance.
        x: the unknowns of each block that (nearly) reach it.
    """

    value: float
    x: tuple[Array, ...]


class Program:
    """The blocks' unknowns in their cones, and `extra` more at the end; then rows ``b - A x`` in cones of their own.

    Each block's unknowns are in a unit that makes its columns of size one, `stretch` times as large.
    """

    def __init__(self, reduced: LeastSquaresForm, extra: int, stretch: float = 1.0) -> None:
        self.reduced = reduced
        self.scale = [stretch / max(float(np.linalg.norm(own, axis=(0, 1))), 1e-300) for own in reduced.columns]
        self.starts = np.cumsum([0, *(block.unknowns for block in reduced.blocks)]).tolist()
        self.width = self.starts[-1] + extra
        self.columns = [  # as pieces of rows
            (0, start, own * scale) for start, own, scale in zip(self.starts, reduced.columns, self.scale, strict=False)
        ]
        self.entries: list[tuple[Integers, Integers, Array]] = []
        self.b: list[Array] = []
        self.cones: list[object] = []
        self.height = 0
        cones = [
            (start, cone, np.zeros(len(cone.F)) if cone.g is None else cone.g / scale)
            for block, start, scale in zip(reduced.blocks, self.starts, self.scale, strict=False)
            for cone in block.cones()
        ]
        for start, cone, g in cones:
            if cone.kind not in LINEAR:
                self.add(cone.kind, g, [(0, start, -cone.F)])
        for kind in LINEAR:  # one cone for all blocks
            own = [(start, -cone.F, g) for start, cone, g in cones if cone.kind == kind]
            rows = np.cumsum([0, *(len(g) for _, _, g in own)]).tolist()
            if own:
                pieces = [(row, start, A) for row, (start, A, _) in zip(rows, own, strict=False)]
                self.add(kind, np.concatenate([g for _, _, g in own]), pieces)

        for limit in reduced.limits:
            charge = [
                (0, start, (own * scale)[None])
                for own, scale, start in zip(limit.charge, self.scale, self.starts, strict=False)
            ]
            self.add("nonnegative", np.ones(1), charge)

    def add(self, kind: str, b: Array, pieces: Iterable[tuple[int, int, Array]]) -> None:
        """Rows with ``b - A x`` in a cone; A is zero but for pieces (its first row, its first unknown, the piece)."""
        for row, start, A in pieces:
            i, j = np.nonzero(A)
            self.entries.append((i + self.height + row, j + start, A[i, j]))
        self.b.append(b)
        self.cones.append(_cone(kind, len(b)))
        self.height += len(b)

    def solve(self) -> Bound:
        """Minimise the last unknown.

        Raises:
            EquipoiseError: the solver stopped far from the optimum.
        """
        solution = self._compiled(FINE).solve()
        # close to the optimum the solver may stall: then what it violates is taken off the bound, to stay safe
        violation = self._violation(solution)
        least = min(solution.obj_val, solution.obj_val_dual) - SAFE * violation
        return Bound(max(0.0, least), self._unknowns(solution))

    def far(self, found: Bound) -> bool:
        """Whether an unknown is far beyond the program's units."""
        each = (np.abs(own / scale).max(initial=0.0) for own, scale in zip(found.x, self.scale, strict=True))
        return max(each, default=0.0) > LARGE

    def priced(self, weights: Sequence[Array]) -> tuple[Array, ...]:
        """The unknowns in the program's units that minimise the last unknown plus weights times those of each block.

        The program is compiled the first time: other weights cost no more than the iterations.

        Raises:
            EquipoiseError: the solver stopped far from the optimum.
        """
        self._coarse.update(q=np.concatenate([*weights, np.zeros(self.width - self.starts[-1] - 1), [1.0]]))
        solution = self._coarse.solve()
        self._violation(solution)
        return tuple(own / scale for own, scale in zip(self._unknowns(solution), self.scale, strict=True))

    def reaches(self, value: float) -> bool:
        """Whether the optimum is below `value`; it takes fewer iterations than the optimum itself.

        Raises:
            EquipoiseError: the solver stopped before that was clear.
        """
        solver = self._compiled(FINE)
        solver.set_termination_callback(
            lambda now: now.cost_dual > value + SAFE * max(now.res_primal, now.res_dual, now.gap_abs)
        )
        solution = solver.solve()
        if str(solution.status) != "CallbackTerminated":
            self._violation(solution)
        return min(solution.obj_val, solution.obj_val_dual) < value

    def _violation(self, solution: Any) -> float:
        violation = 0.0 if str(solution.status) == "Solved" else max(solution.r_prim, solution.r_dual)
        if not violation < STALLED:
            raise EquipoiseError(
                f"the convex solver stopped with '{solution.status}': the problem is badly scaled; try a larger radius"
            )
        return violation

    def _unknowns(self, solution: Any) -> tuple[Array, ...]:
        parts = np.split(np.array(solution.x)[: self.starts[-1]], self.starts[1:-1])
        return tuple(own * scale for own, scale in zip(parts, self.scale, strict=True))

    @cached_property
    def _coarse(self) -> Any:
        return self._compiled(COARSE)

    def _compiled(self, tolerance: float) -> Any:
        from scipy import sparse

        clarabel = conic_solver()
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
        settings.presolve_enable = settings.chordal_decomposition_enable = False  # they forbid another objective
        n, (i, j, values) = self.width, (np.concatenate(part) for part in zip(*self.entries, strict=True))
        A, b = sparse.csc_matrix((values, (i, j)), (self.height, n)), np.concatenate(self.b)
        objective = np.append(np.zeros(n - 1), 1.0)
        return clarabel.DefaultSolver(sparse.csc_matrix((n, n)), objective, A, b, self.cones, settings)


def least(make: Callable[[float], Program]) -> Bound:
    """The optimum of a program, given its stretch.

    Where it is so flat that unknowns far beyond their units are best, a solver stops above it: then it is solved again
    in larger units, and the lesser optimum counts.

    Raises:
        EquipoiseError: the solver stopped far from the optimum.
    """
    program = make(1.0)
    found = program.solve()
    if not program.far(found):
        return found
    try:
        again = make(STRETCH).solve()
    except EquipoiseError:
        return found
    return min(found, again, key=lambda bound: bound.value)


def least_rms(reduced: LeastSquaresForm) -> Bound:
    """The bound for the root mean square torque of all joints together (rest included)."""
    return least(lambda stretch: rms_program(reduced, stretch))


def rms_program(reduced: LeastSquaresForm, stretch: float = 1.0) -> Program:
    """The program whose optimum is the least root mean square torque."""
    program = Program(reduced, 1, stretch)
    t = program.width - 1
    norm = np.concatenate([[0.0], reduced.d, [reduced.rest]])
    columns = [(1, start, -own) for _, start, own in program.columns]
    program.add("second order", norm, [*columns, (0, t, -np.eye(1))])
    return program


def peak_program(reduced: LeastSquaresForm, L: Array, low: Array, high: Array, stretch: float = 1.0) -> Program:
    """The program whose optimum is the least of the largest torques, see `Peak`, with ``w = reduced.times(x)``.

    Args:
        L: (rows, len(w)), low, high: (rows,): torques from ``L w + low`` to ``L w + high``, as shares of any unit.
    """
    r = L.shape[1]
    program = Program(reduced, r + 1, stretch)  # w, and the peak t
    w, t = program.width - r - 1, program.width - 1
    program.add("zero", np.zeros(r), [*program.columns, (0, w, -np.eye(r))])
    for sign, load in ((1.0, high), (-1.0, low)):
        program.add("nonnegative", -sign * load, [(0, w, sign * L), (0, t, -np.ones((len(load), 1)))])
    return program


def _cone(kind: str, rows: int) -> object:
    clarabel = conic_solver()
    if kind == "semidefinite":
        return clarabel.PSDTriangleConeT((isqrt(8 * rows + 1) - 1) // 2)
    name = {"zero": "ZeroConeT", "nonnegative": "NonnegativeConeT", "second order": "SecondOrderConeT"}[kind]
    return getattr(clarabel, name)(rows)


def conic_solver() -> Any:
    """The module of the solver."""
    import clarabel  # a compiled module without type information

    return clarabel
