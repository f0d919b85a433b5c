"""Closed poses by Newton along straight paths of the independent coordinates.

Each pose starts from a closed one and steps towards its own goal: a step along the tangent, then Newton on the loop
equations with the independent coordinates held. A step counts only if the closed pose is near where the tangent led
and the Jacobian has kept its orientation: so the path never jumps to another way of assembling the mechanism. A step
that does not count is halved.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from ..model.arrays import Array, Booleans, Integers, frozen
from .closure import Closure
from .tolerances import SHORTEST


@frozen
class Split:
    """Which coordinates of the tree are independent (m of them) and which depend on them (d)."""

    independent: Integers
    dependent: Integers


@frozen
class Closed:
    """Closed poses `q` (N, n) and how they go on.

    Attributes:
        T: (N, d, m) how dependent coordinates follow the independent ones, in units of their scales.
        J: (N, d, count) derivative of the loop equations by the dependent coordinates.
        condition: (N,) its condition number, by Frobenius' norm.
    """

    q: Array
    T: Array
    J: Array
    condition: Array

    def __getitem__(self, which: Booleans) -> Closed:
        return Closed(self.q[which], self.T[which], self.J[which], self.condition[which])

    def with_more(self, other: Closed) -> Closed:
        """These, and then the others."""
        return Closed(*(np.concatenate([getattr(self, f.name), getattr(other, f.name)]) for f in fields(self)))


def tangents(closure: Closure, split: Split, q: Array) -> Closed:
    """The tangents at closed poses `q` (N, n), by orthogonal factors, so that no digits are lost to squaring."""
    from . import closing

    N, d, m = len(q), len(split.dependent), len(split.independent)
    found = Closed(np.ascontiguousarray(q, float), np.empty((N, d, m)), np.empty((N, d, closure.count)), np.empty(N))
    table = closure.table._replace(independent=split.independent, dependent=split.dependent)
    closing.tangents(table, found.q, len(closure.tree.names), found.T, found.J, found.condition)
    return found


def follow(
    closure: Closure, split: Split, start: Closed, which: Integers, goal: Array, shortest: float = SHORTEST
) -> tuple[Array, Booleans]:
    """Follow straight paths of the independent coordinates from closed poses.

    Args:
        which: (N,) the pose of `start` that each path begins at.
        goal: (N, m) values of the independent coordinates.
        shortest: the least step [rad, or share of the size]; close to a singular pose only short ones count.

    Returns:
        (N, n) closed poses at the goals, and (N,) which of them were reached; the others are anywhere.
    """
    from . import paths

    q, done = np.empty((len(goal), closure.tree.n)), np.zeros(len(goal), bool)
    table = closure.table._replace(independent=split.independent, dependent=split.dependent)
    goal = np.ascontiguousarray(goal, float)
    paths.follow(table, len(closure.tree.names), start.q, start.T, start.J, which, goal, shortest, q, done)
    return q, done
