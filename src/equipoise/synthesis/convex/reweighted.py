"""Few parts from the convex program: reweighted trace.

The program's optimum is not unique, and a solver returns one with as many parts as there can be. A price on them, in
torque, thins them out: the price of a part is the concave count of its block, linearised where the last solve ended
(Fazel, Hindi and Boyd 2003, the log-determinant heuristic), and eps, below which a part is nothing, falls tenfold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...model.arrays import Array
from .goal import Goal
from .polish import Parts, shape

EPS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)  # of the largest amount, after each solve
LEAST = 1e-4  # of the largest amount: a block or part with less is left out
FIRST = 0.3  # by which the logarithm of a block's first price scatters


def few_parts(goal: Goal, price: float, rng: np.random.Generator) -> Parts | None:
    """A set of few parts close to an optimum at a price for each, as a share of the unbalanced torque; None: no parts.

    Args:
        rng: for the first weights; others lead to other sets.

    Raises:
        EquipoiseError: the solver stopped far from the optimum.
    """
    blocks = goal.reduced.blocks
    weights = [price * np.exp(FIRST * rng.normal()) * block.weights(np.zeros(block.unknowns), 1.0) for block in blocks]
    on = goal
    for eps in EPS:
        x = on.program.priced(weights)
        amounts = np.array([block.amount @ own for block, own in zip(on.reduced.blocks, x, strict=True)])
        unit = amounts.max()
        if unit <= 0:
            return None
        chosen = np.flatnonzero(amounts > LEAST * unit).tolist()
        if len(chosen) < len(amounts):
            on = on.on(chosen)
        weights = [
            price / unit * block.weights(x[i] / unit, eps) for i, block in zip(chosen, on.reduced.blocks, strict=True)
        ]
    parts = split(on, on.program.priced(weights))
    where = np.searchsorted(goal.numbers, on.numbers)
    return None if parts is None else replace(parts, block=where[parts.block])


def split(goal: Goal, x: Sequence[Array]) -> Parts | None:
    """The parts that unknowns, in the units of the goal's program, add up to, as a batch of one set."""
    reduced, scale = goal.reduced, goal.program.scale
    width = shape(reduced)
    unit = max(float(block.amount @ own) for block, own in zip(reduced.blocks, x, strict=True))
    numbers: list[int] = []
    amounts: list[float] = []
    shapes: list[Array] = []
    for number, (block, own) in enumerate(zip(reduced.blocks, x, strict=True)):
        k, u = block.split(own, LEAST * unit)
        numbers += [number] * len(k)
        amounts += (k * scale[number]).tolist()
        shapes += [np.pad(one, (0, width - block.shape)) for one in u]
    if not numbers:
        return None
    return Parts.at(reduced, np.array([numbers]), np.array([amounts]), np.array([shapes]))
