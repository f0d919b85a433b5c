"""Splitting a moment matrix into springs: terms of rank one, each within the regions as far as that can be.

A positive semidefinite N = F F' has as many factors as there are rotations, F R. One in which every column keeps one
quadratic constraint always exists (Sturm and Zhang 2003, Procedure 1), and one for two constraints does from rank three
on but for some exceptions (Ai and Zhang 2009, Theorem 2.3). Rotations in the planes of two columns, as in their proofs,
are turned here to where the constraints are violated least; what is left over is for the polish to repair.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ...model.arrays import Array

ANGLES = np.linspace(0, np.pi / 2, 90, endpoint=False)  # a quarter turn swaps the columns
COS, SIN = np.cos(ANGLES), np.sin(ANGLES)
SWEEPS = 6


def factor(N: Array, limits: Array, least: float) -> Array:
    """(s, r) F, F F' nearly N, whose columns y have ``y' A y >= 0`` for every A of `limits` as far as may be.

    Args:
        N: (s, s) positive semidefinite up to rounding; limits: (m, s, s).
        least: eigenvalues up to this are left out.
    """
    values, vectors = np.linalg.eigh(N)
    chosen = values > least
    F = vectors[:, chosen] * np.sqrt(values[chosen])
    own = np.einsum("si,mst,tj->ijm", F, limits, F)  # the constraints in the columns of F
    for _ in range(SWEEPS):
        turned = False
        for i, j in combinations(range(F.shape[1]), 2):
            a, b, c = own[i, i], own[i, j], own[j, j]
            first = np.outer(COS**2, a) + np.outer(2 * SIN * COS, b) + np.outer(SIN**2, c)
            violated = (np.minimum(first, 0) ** 2 + np.minimum(a + c - first, 0) ** 2).sum(axis=1)
            best = int(violated.argmin())
            if violated[best] < violated[0] * (1 - 1e-9):
                turned = True
                R = np.array([[COS[best], -SIN[best]], [SIN[best], COS[best]]])
                F[:, [i, j]] = F[:, [i, j]] @ R
                own[[i, j]] = np.einsum("jlm,jk->klm", own[[i, j]], R)
                own[:, [i, j]] = np.einsum("ljm,jk->lkm", own[:, [i, j]], R)
        if not turned:
            break
    return F
