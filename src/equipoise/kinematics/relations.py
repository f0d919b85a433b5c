"""Linear relations between joint angles on closed poses, such as those of a parallelogram.

The poses of one branch are an analytic set, so a relation that holds at random ones near each other, to rounding, holds
on all of the branch, beyond the poses where it folds and meets another branch.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from ..model.arrays import Array
from ..model.mechanism import Coupling

HOLDS = 1e-9  # [rad or m] a relation holds
RATIO = 24  # largest denominator of a relation's coefficients


def relations(
    q: Array, single: Sequence[bool], names: Sequence[str], first: Sequence[int] = (), share: float = HOLDS
) -> Iterator[Coupling]:
    """Coordinates that are a constant plus a fixed rational combination of earlier ones, at all of `q` (N, n).

    Args:
        single: which coordinates are those of joints with one, between which relations are looked for.
        first: the coordinates that come before the others, in whose terms the others are.
    """
    free: list[int] = []  # coordinates that no relation gives
    for j in (*first, *(j for j in range(q.shape[1]) if j not in first)):
        A = np.column_stack([np.ones(len(q)), q[:, free]])
        x = np.linalg.lstsq(A, q[:, j], rcond=1e-10)[0]
        ratios = [float(Fraction(value).limit_denominator(RATIO)) for value in x[1:]]
        given = q[:, j] - q[:, free] @ np.array(ratios)
        related = single[j] and j not in first
        if related and all(single[i] for i, r in zip(free, ratios, strict=True) if r) and np.ptp(given) < share:
            terms = tuple((names[i], r) for i, r in zip(free, ratios, strict=True) if r)
            offset = float(given.mean())
            yield Coupling(names[j], terms, offset if abs(offset) > share else 0.0)
        else:
            free.append(j)
