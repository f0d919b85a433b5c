"""Singular poses of loops inside the ranges: beside them torques are as large as one likes.

Not so where relations between joints (a parallelogram's) lead through: there torques are what they are elsewhere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..model.arrays import Array, Booleans, frozen
from .linkage import Linkage
from .tree import Tree

CLOSE = 30  # times nearer to a singular pose than usual: what is computed there says more about it than about the rest


@frozen
class Singular:
    """A singular pose of a mechanism with loops inside its ranges.

    Attributes:
        configuration: (n,) the nearest pose met [rad or m].
        passed: whether relations between joints lead through all that were met, so that nothing is left out.
        nearer: poses that are so many times nearer to a singular one than usual are left out everywhere.
        left_out: how many of the random poses that is.
    """

    configuration: Array
    passed: bool
    nearer: float
    left_out: int

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers and lists."""
        return {**vars(self), "configuration": self.configuration.tolist()}


class Avoided:
    """Leaves out what is close to singular poses of loops, and remembers the closest. Without loops nothing is."""

    def __init__(self, tree: Tree) -> None:
        self.tree, self.passed = tree, True
        self.most, self.configuration = 0.0, np.zeros(tree.n)

    def without(self, q: Array) -> Array:
        """Those of the poses `q` (N, n) that are not close to one; all of them, if none is left."""
        far = ~self._close(q)
        return q[far] if far.any() else q

    def nowhere(self, q: Array, values: Array) -> Array:
        """`values` (N, m) at `q` (N, n), -inf where it is close to one."""
        return np.where(self._close(q)[:, None], -np.inf, values)

    def found(self, left_out: int) -> Singular | None:
        """The closest, when any is close."""
        return Singular(self.configuration, self.passed, CLOSE, left_out) if self.most > CLOSE else None

    def _close(self, q: Array) -> Booleans:
        if not isinstance(self.tree, Linkage) or not len(q):
            return np.zeros(len(q), bool)
        times, every = self.tree.close(q)
        close = times > CLOSE
        named = times if close.any() else every
        rank = bool(close.any()), float(named.max())  # one that nothing leads through comes first
        if rank > (not self.passed, self.most):
            (met, self.most), self.configuration = rank, q[int(named.argmax())]
            self.passed = not met
        return close
