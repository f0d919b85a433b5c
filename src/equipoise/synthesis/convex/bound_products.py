"""What the bounds of an attachment's coordinates say together: products of bounds, linear in the moment matrix.

The mean of u_i^2 alone leaves the program far from what springs in a box can do. Where ``-1 <= u_i <= 1`` and
``-1 <= u_j <= 1``, also ``(1 + s u_i)(1 + t u_j) >= 0`` for the four signs s, t: the reformulation-linearisation of
Sherali and Adams. For two coordinates this is exact (Anstreicher and Burer 2010). Of three coordinates
``(1 + a)(1 + b)(1 + c) + (1 - a)(1 - b)(1 - c) >= 0`` has no cubic term: a b + b c + a c >= -1, for all signs. And a
coordinate's bound times a ball is a second-order cone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, product

import numpy as np

from ...model.arrays import Array

SIGNS = (1.0, -1.0)


def of_two(limited: Sequence[int], one: int, side: int) -> Iterator[Array]:
    """(side, side) A for every two limited entries of y and their signs: ``y' A y >= 0``, where ``y[one]`` is 1."""
    for i, j in combinations(limited, 2):
        for s, t in product(SIGNS, SIGNS):
            yield _pairs(side, {(one, one): 1.0, (one, i): s, (one, j): t, (i, j): s * t})


def of_three(limited: Sequence[int], one: int, side: int) -> Iterator[Array]:
    """(side, side) A for every three limited entries of y and the signs that differ."""
    for i, j, k in combinations(limited, 3):
        for s, t in product(SIGNS, SIGNS):
            yield _pairs(side, {(one, one): 1.0, (i, j): s, (i, k): t, (j, k): s * t})


def with_balls(limited: Sequence[int], ball: Sequence[int], one: int, side: int) -> Iterator[Array]:
    """(1 + len(ball), side, side) A: ``y' A[0] y`` is at least the norm of the others, limited entries times a ball."""
    for i, s in product(limited, SIGNS):
        first = _pairs(side, {(one, one): 1.0, (one, i): s})
        yield np.stack([first, *(_pairs(side, {(one, j): 1.0, (i, j): s}) for j in ball)])


def _pairs(side: int, factors: dict[tuple[int, int], float]) -> Array:
    """The symmetric A with ``y' A y`` the sum of these factors times y_i y_j."""
    A = np.zeros((side, side))
    for (i, j), factor in factors.items():
        A[i, j] += factor / 2
        A[j, i] += factor / 2
    return A
