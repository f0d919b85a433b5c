"""The least torque that any springs can leave: a convex program (THEORY sections 1 and 4).

Unknowns are the moment matrices N_p >= 0 of the body pairs, 7 x 7 in the regions' own coordinates. Attachments inside
the regions give linear constraints on N_p: a spring's N is k y y' with y = [u_a; 1; u_b], and summed over springs the
mean of |u|^2 stays within the ball, or that of u_i^2 within the box. Any set of springs, however many, is a feasible
point, so the optimum is a lower bound for every design on these pairs and regions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array, frozen
from ..errors import EquipoiseError
from .gram import TRI, TRI_I, TRI_J, Gram, smat, svec

ONE = int(np.flatnonzero((TRI_I == 3) & (TRI_J == 3))[0])  # the entry of svec(N) that is the sum of stiffnesses
STALLED = 1e-4  # violation of the constraints that is still close to the optimum
ENDS = ((0, 1, 2), (4, 5, 6))


@frozen
class Bound:
    """The least torque that any springs on the pairs can leave.

    Attributes:
        value: as a share of the unbalanced torque (rms or peak): the lesser of the program's primal and dual optimum,
            valid up to the solver's tolerance.
        N: (pairs, 7, 7) moment matrices that (nearly) reach it.
    """

    value: float
    N: Array


class Rows:
    """Linear constraints ``s = b - A x`` in the solver's form, block by block, with a cone for each."""

    def __init__(self, width: int) -> None:
        self.width = width
        self.A: list[Array] = []
        self.b: list[Array] = []
        self.cones: list[object] = []

    def add(self, A: Array, b: Array, cone: object) -> None:
        """Append rows with ``b - A x`` in `cone`."""
        self.A.append(A)
        self.b.append(b)
        self.cones.append(cone)


def least_rms(gram: Gram) -> Bound:
    """The bound for the root mean square torque of all joints together (rest included)."""
    clarabel = _solver()
    R, scale = _scaled(gram)
    rows, objective = _moments(gram)
    t = rows.width - 1
    A = np.zeros((len(gram.d) + 2, rows.width))
    A[0, t], A[1:-1, :t] = -1.0, -R
    rows.add(A, np.concatenate([[0.0], gram.d, [gram.rest]]), clarabel.SecondOrderConeT(len(A)))
    objective[t] = 1.0
    return _solve(rows, objective, scale)


def least_peak(gram: Gram, L: Array, load: Array) -> Bound:
    """The bound for the largest of the torques ``|L w + load|`` with ``w = sum_p <Q_p, N_p>``.

    Args:
        L: (rows, len(w)), load: (rows,), as shares of any unit: see `minimax.Peak`.
    """
    clarabel = _solver()
    r = L.shape[1]
    R, scale = _scaled(gram)
    rows, objective = _moments(gram, extra=r + 1)  # w, and the peak t
    v, t = rows.width - r - 1, rows.width - 1
    tie = np.zeros((r, rows.width))
    tie[:, :v], tie[:, v:t] = R, -np.eye(r)
    rows.add(tie, np.zeros(r), clarabel.ZeroConeT(r))
    for sign in (1.0, -1.0):
        A = np.zeros((len(load), rows.width))
        A[:, v:t], A[:, t] = sign * L, -1.0
        rows.add(A, -sign * load, clarabel.NonnegativeConeT(len(load)))
    objective[t] = 1.0
    return _solve(rows, objective, scale)


def _moments(gram: Gram, extra: int = 1) -> tuple[Rows, Array]:
    """Every N_p positive semidefinite and its attachments in their regions; `extra` more unknowns at the end."""
    clarabel = _solver()
    pairs = gram.problem.pairs
    rows = Rows(TRI * len(pairs) + extra)
    for p in range(len(pairs)):
        block = np.zeros((TRI, rows.width))
        block[:, TRI * p : TRI * (p + 1)] = -np.eye(TRI)
        rows.add(block, np.zeros(TRI), clarabel.PSDTriangleConeT(7))
    limits = [
        (p, entries)
        for p, pair in enumerate(pairs)
        for name, end in zip(pair, ENDS, strict=True)
        for entries in ([end] if gram.problem.regions[name].shape == "ball" else [(i,) for i in end])
    ]
    A = np.zeros((len(limits), rows.width))
    for row, (p, entries) in enumerate(limits):
        for i in entries:
            A[row, TRI * p + int(np.flatnonzero((i == TRI_I) & (i == TRI_J))[0])] = 1.0
        A[row, TRI * p + ONE] = -1.0
    rows.add(A, np.zeros(len(limits)), clarabel.NonnegativeConeT(len(limits)))
    return rows, np.zeros(rows.width)


def _scaled(gram: Gram) -> tuple[Array, Array]:
    """The map (len(w), 28 pairs) from entries of svec(N) to w, and each pair's unit (pairs,) that makes it size one."""
    R = svec(gram.Q)
    scale = 1 / np.maximum(np.linalg.norm(R, axis=(1, 2)), 1e-300)
    return (R * scale[:, None, None]).transpose(1, 0, 2).reshape(len(gram.d), -1), scale


def _solver() -> Any:
    import clarabel  # a compiled module without type information

    return clarabel


def _solve(rows: Rows, objective: Array, scale: Array) -> Bound:
    from scipy import sparse

    clarabel = _solver()
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-9
    n = len(objective)
    A, b = sparse.csc_matrix(np.vstack(rows.A)), np.concatenate(rows.b)
    solution = clarabel.DefaultSolver(sparse.csc_matrix((n, n)), objective, A, b, rows.cones, settings).solve()
    # close to the optimum the solver may stall: then what it violates is taken off the bound, to stay on the safe side
    violation = 0.0 if str(solution.status) == "Solved" else max(solution.r_prim, solution.r_dual)
    if not violation < STALLED:
        raise EquipoiseError(
            f"the convex solver stopped with '{solution.status}': the problem is badly scaled; try a larger radius"
        )
    N = smat(np.array(solution.x)[: TRI * len(scale)].reshape(-1, TRI)) * scale[:, None, None]
    return Bound(max(0.0, min(solution.obj_val, solution.obj_val_dual) - 10 * violation), N)
