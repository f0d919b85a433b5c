"""Random configurations inside the joint ranges, dependent joints included."""

from __future__ import annotations

import numpy as np

from ..errors import Fault, InputError
from ..rotation import Array
from .tree import Tree

SLIDE = 1.0  # [m] a prismatic joint without a range is sampled over +-SLIDE
TRIES = 200  # rounds of rejection sampling before the ranges are called contradictory


def bounds(tree: Tree) -> tuple[Array, Array]:
    """Box (n,), (n,) that configurations are drawn from: the range, +-pi for an unlimited angle, +-1 m for a slide."""
    rows = tree.coordinate_rows
    free = np.where(tree.turns, np.pi, SLIDE)
    lower, upper = tree.lower[rows], tree.upper[rows]
    return np.where(np.isinf(lower), -free, lower), np.where(np.isinf(upper), free, upper)


def inside(tree: Tree, q: Array, slack: float = 1e-12) -> Array:
    """(N,) whether every joint, dependent ones included, is inside its range at `q` (N, n)."""
    s = q @ tree.C.T + tree.s0
    return ((s >= tree.lower - slack) & (s <= tree.upper + slack)).all(axis=1)


def sample(tree: Tree, count: int, seed: int = 0) -> Array:
    """`count` configurations (count, n), uniform over the joint ranges; the same for the same seed.

    Raises:
        InputError: the range of a dependent joint leaves (almost) no configuration.
    """
    rng = np.random.default_rng(seed)
    lower, upper = bounds(tree)
    found: list[Array] = []
    have = 0
    for _ in range(TRIES):
        q = rng.uniform(lower, upper, (count, tree.n))
        q = q[inside(tree, q)]
        found.append(q)
        have += len(q)
        if have >= count:
            return np.concatenate(found)[:count]
    names = ", ".join(coupling.joint for coupling in tree.mechanism.couplings)
    raise InputError(
        Fault(("couplings",), f"the ranges of the coupled joints ({names}) exclude nearly every configuration")
    )
