"""Exact means over a box of joint ranges, without samples.

The energy of each unknown is a finite series of ``q^degree exp(i frequency q)``, and the mean over a box is a product
of means over single ranges. For each coordinate its few functions are written in terms of real functions that are
orthonormal over the range, the constant 1 first: then the mean of a product is the product of coefficients, as
Parseval has it for whole turns. The functions are orthonormalised at Gauss-Legendre points, enough of them to integrate
products to rounding, so that nothing is squared and narrow ranges lose nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...energy.fourier.series import Series
from ...kinematics.sampling import bounds
from ...kinematics.tree import Tree
from ...model.arrays import Array, Complexes, Integers

MOST = 20_000  # terms of one series up to which this is quicker than samples
POINTS, POINTS_PER_RADIAN = 24, 1.0  # of the quadrature; the second times range and frequency


def is_box(tree: Tree) -> bool:
    """Whether configurations fill a box: no dependent joint meets a limit of its own, and there are no loops."""
    if tree.mechanism.loops:
        return False
    lower, upper = bounds(tree)
    middle, half = tree.values((lower + upper)[None] / 2)[0], np.abs(tree.C) @ (upper - lower) / 2
    slack = 1e-9 * (1 + np.abs(middle) + half)
    return bool(((middle - half >= tree.lower - slack) & (middle + half <= tree.upper + slack)).all())


def mean_products(
    tree: Tree, denominators: Integers, parts: Sequence[Series], loads: int, scale: Array
) -> tuple[Array, Array]:
    """Rows of which the squares sum to mean square torques, and the mean energies.

    Args:
        denominators: (n,) of the frequencies.
        parts: energies, each (T, unknowns) [J]; the last `loads` of them have one column each.
        scale: (n,) what each coordinate's torque counts.

    Returns:
        (rows, all columns): ``|rows @ x|^2`` is the mean over the box of the summed squares of the torques times
        `scale` that x times the energies give; and (all columns,) the means of the energies.
    """
    n, ends = tree.n, np.cumsum([0, *(part.coef.shape[1] for part in parts)])
    torques = [[_derivative(part, j, denominators) for part in parts] for j in range(n)]
    bases = _bases(tree, denominators, [*parts, *(one for each in torques for one in each)])
    rows = []
    for j, each in enumerate(torques):
        if scale[j]:
            found = [_expanded(one, bases) for one in each]
            rows.append(scale[j] * _together(found, ends, ends[len(parts) - loads]))
    energy = np.zeros(ends[-1])
    for part, start, end in zip(parts, ends[:-1], ends[1:], strict=True):
        labels, coef = _expanded(part, bases)
        energy[start:end] = coef[~labels.any(axis=1)].sum(axis=0)
    return np.vstack([np.zeros((1, ends[-1])), *rows]), energy


def _derivative(part: Series, j: int, denominators: Integers) -> Series:
    """By coordinate j."""
    n = part.keys.shape[1] // 2
    by_phase = part.coef * (1j * part.keys[:, j] / denominators[j])[:, None]
    power = part.keys[:, n + j]
    lower = part.keys.copy()
    lower[:, n + j] = np.maximum(power - 1, 0)
    keys, coef = np.concatenate([part.keys, lower]), np.concatenate([by_phase, part.coef * power[:, None]])
    used = (coef != 0).any(axis=1)
    return Series(keys[used], coef[used])


Basis = dict[tuple[int, int], Complexes]
"""(frequency, degree) -> the coefficients of that function in the orthonormal ones."""


def _bases(tree: Tree, denominators: Integers, every: Sequence[Series]) -> list[Basis]:
    lower, upper = bounds(tree)
    keys = np.unique(np.concatenate([one.keys for one in every]), axis=0)
    found: list[Basis] = []
    for j in range(tree.n):
        functions = {(int(k), int(d)) for k, d in np.unique(keys[:, [j, tree.n + j]], axis=0)} | {(0, 0)}
        half = (upper[j] - lower[j]) / 2
        most = max(abs(k) for k, _ in functions) / denominators[j]
        points, weights = np.polynomial.legendre.leggauss(POINTS + int(POINTS_PER_RADIAN * 2 * half * most))
        t, root = half * points, np.sqrt(weights / 2)[:, None]
        shift = (lower[j] + upper[j]) / 2
        lower_too = {(abs(k), power) for k, d in functions for power in range(d + 1)}  # a shift brings them
        simple = sorted(lower_too, key=lambda f: (f[0] + f[1], f))
        columns = [
            t**d * wave(k / denominators[j] * t) for k, d in simple for wave in ((np.cos, np.sin) if k else (np.cos,))
        ]
        # a rank of less than full is rounding: a locked joint has one function
        Q, R = np.linalg.qr(root * np.stack(columns, axis=1))
        Q = (Q * np.sign(np.diag(R)))[:, np.abs(np.diag(R)) > 1e-14 * np.abs(R).max(initial=0)]  # 1 stays 1
        q = t + shift
        found.append({
            (k, d): Q.T @ (root[:, 0] * q**d * np.exp(1j * k / denominators[j] * q)) for k, d in functions
        })  # fmt: skip
    return found


def _expanded(part: Series, bases: Sequence[Basis]) -> tuple[Integers, Array]:
    """In orthonormal functions: which one of each coordinate (T', n), and the coefficients (T', m)."""
    n = len(bases)
    labels, coef = part.keys.astype(int), part.coef
    for j, basis in enumerate(bases):
        own = labels[:, [j, n + j]]
        if not own.any():
            continue
        rest = labels.copy()
        rest[:, [j, n + j]] = 0
        others, place = np.unique(rest, axis=0, return_inverse=True)
        count = len(next(iter(basis.values())))
        total = np.zeros((count, len(others), coef.shape[1]), complex)
        for function in np.unique(own, axis=0):
            chosen = (own == function).all(axis=1)
            weights = basis[int(function[0]), int(function[1])]
            for a in np.flatnonzero(weights):
                np.add.at(total[a], place.ravel()[chosen], weights[a] * coef[chosen])
        labels = np.tile(others, (count, 1))
        labels[:, j] = np.repeat(np.arange(count), len(others))
        coef = total.reshape(len(labels), coef.shape[1])
        used = (coef != 0).any(axis=1)
        labels, coef = labels[used], coef[used]
    return labels[:, :n], np.real(coef)


def _together(found: Sequence[tuple[Integers, Array]], ends: Integers, unknowns: int) -> Array:
    """(rows, all columns): what has the same label in one row; rows without an unknown as few as they can be."""
    every, place = np.unique(np.concatenate([labels for labels, _ in found]), axis=0, return_inverse=True)
    A = np.zeros((len(every), ends[-1]))
    starts = np.cumsum([0, *(len(labels) for labels, _ in found)])
    for (_, coef), first, last, start, end in zip(found, starts, starts[1:], ends, ends[1:], strict=False):
        A[place.ravel()[first:last], start:end] = coef
    alone = ~(A[:, :unknowns] != 0).any(axis=1)
    few = np.zeros((A.shape[1] - unknowns, A.shape[1]))
    own = np.linalg.qr(A[alone, unknowns:], mode="r")
    few[: len(own), unknowns:] = own
    return np.vstack([A[~alone], few])
