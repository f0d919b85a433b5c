"""Least squares for moves that have a limit: the best partial adjustment."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from ..model.arrays import Array

SINGULAR = 1e-9  # of the largest: directions that do nothing


def limited(J: Array, r: Array, widths: Sequence[int], done: Array, most: float) -> Array:
    """The step x (unknowns,) that minimises ``|J x + r|`` with every move within `most` [m] in all.

    Args:
        widths: how many of the unknowns each move has; done: (unknowns,) how far they have moved already.
    """
    free = np.asarray(np.linalg.lstsq(J, -r, rcond=SINGULAR)[0], float)
    if most == inf or all(np.linalg.norm(part) <= most for part in _parts(done + free, widths)):
        return free
    from scipy import sparse

    from ..synthesis.convex.semidefinite import conic_solver

    clarabel = conic_solver()

    unit = float(np.linalg.norm(J, 2)) or 1.0
    H, g = J.T @ J / unit**2, J.T @ (r - J @ done) / unit**2
    n, start, rows, sides = len(done), 0, [], []
    for width in widths:
        rows.append(np.vstack([np.zeros((1, n)), -np.eye(n)[start : start + width]]))
        sides.append(np.append(most, np.zeros(width)))
        start += width
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-13
    cones = [clarabel.SecondOrderConeT(width + 1) for width in widths]
    upper = sparse.triu(sparse.csc_matrix(H + 1e-12 * np.eye(n)), format="csc")
    solution = clarabel.DefaultSolver(
        upper, g, sparse.csc_matrix(np.vstack(rows)), np.concatenate(sides), cones, settings
    ).solve()
    x = np.array(solution.x)
    shrunk = [part * min(1.0, most / max(float(np.linalg.norm(part)), 1e-300)) for part in _parts(x, widths)]
    return np.concatenate(shrunk) - done


def _parts(x: Array, widths: Sequence[int]) -> list[Array]:
    return np.split(x, np.cumsum(widths)[:-1])
