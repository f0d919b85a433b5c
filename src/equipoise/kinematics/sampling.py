"""Random configurations inside the joint ranges, dependent joints included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from ..model.arrays import Array, Booleans
from ..model.errors import Fault, InputError
from .tree import Tree

SLIDE = 1.0  # [m] a prismatic joint without a range is sampled over +-SLIDE
LEAST_RATIO = 1e-9  # a smaller coupling ratio turns nothing
TRIES = 200  # rounds of rejection sampling before the ranges are called contradictory


def slowest(tree: Tree) -> Array:
    """(n,) the least ratio at which each angle turns any joint, at most 1: how far a gear reduces. 1 for a slide."""
    ratios = np.abs(tree.C[tree.rotates])
    ratios = np.where(ratios > LEAST_RATIO, ratios, np.inf)
    return np.where(tree.turns, ratios.min(axis=0, initial=1.0), 1.0)


def bounds(tree: Tree) -> tuple[Array, Array]:
    """Box (n,), (n,) that configurations are drawn from: the range; +-1 m for a slide without one.

    An angle without a range gets +-pi, or what turns the slowest joint that it drives by +-pi. With loops it is
    narrowed to what can be reached.
    """
    rows = tree.coordinate_rows
    free = np.where(tree.turns, np.pi / slowest(tree), SLIDE)
    lower, upper = tree.lower[rows], tree.upper[rows]
    return tree.narrow(np.where(np.isinf(lower), -free, lower), np.where(np.isinf(upper), free, upper))


def whole_turns(tree: Tree, periods: ArrayLike = 1) -> bool:
    """Whether every coordinate is an angle, unlimited or over whole turns, and no dependent joint is limited.

    Then averages over the ranges are averages over all configurations. `periods` (n,) says how many turns of each
    coordinate bring the mechanism back to where it was: more than one where a coupling has a fractional ratio.
    """
    rows = tree.coordinate_rows
    width = tree.upper[rows] - tree.lower[rows]
    turns = np.where(np.isinf(width), 1.0, width / (2 * np.pi * np.asarray(periods)))
    whole = (np.rint(turns) > 0) & (np.abs(turns - np.rint(turns)) < 1e-6)
    dependent = np.setdiff1d(np.arange(len(tree.lower)), rows)
    limited = np.isfinite(tree.lower[dependent]) | np.isfinite(tree.upper[dependent])
    return bool(tree.turns.all() and whole.all() and not limited.any())


def inside(tree: Tree, q: Array, slack: float = 1e-12) -> Booleans:
    """(N,) whether every joint, dependent ones included, is inside its range at `q` (N, n)."""
    s = tree.values(q)
    return np.asarray(((s >= tree.lower - slack) & (s <= tree.upper + slack)).all(axis=1))


def sample(tree: Tree, count: int, seed: int | Sequence[int] = 0) -> Array:
    """`count` configurations (count, n), uniform over the joint ranges; the same for the same seed.

    Raises:
        InputError: the ranges of dependent joints and the loops leave (almost) no configuration.
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
    if tree.mechanism.loops:
        raise InputError(Fault(("loops",), "they and the joint ranges exclude nearly every configuration"))
    names = ", ".join(coupling.joint for coupling in tree.mechanism.couplings)
    raise InputError(
        Fault(("couplings",), f"the ranges of the coupled joints ({names}) exclude nearly every configuration")
    )
