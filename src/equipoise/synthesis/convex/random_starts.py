"""The last resort of the search for few parts: random starts on sets of blocks."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations_with_replacement, islice

import numpy as np

from .least_squares_form import LeastSquaresForm
from .polish import Parts, best_amounts, polish, shape

STARTS = 128  # on each set of blocks
SPLITS = 6  # ways to distribute the parts over the blocks of a set
SHORT = 30  # iterations for all starts
KEPT = 32  # starts of each set that are given


def random_parts(reduced: LeastSquaresForm, chosen: Iterable[int], count: int, seed: int) -> Parts:
    """Sets of `count` parts on every one of the chosen blocks, near local optima of the root mean square torque."""
    places = tuple(chosen)
    rng = np.random.default_rng([seed, count, *places])
    splits = list(islice(combinations_with_replacement(places, count - len(places)), SPLITS))
    block = np.tile([[*places, *extra] for extra in splits], (-(-STARTS // len(splits)), 1))
    start = Parts.at(reduced, block, np.ones(block.shape), rng.uniform(-1, 1, (*block.shape, shape(reduced))))
    parts, value = polish(reduced, best_amounts(reduced, start), SHORT)
    return parts[np.argsort(value, kind="stable")[:KEPT]]
