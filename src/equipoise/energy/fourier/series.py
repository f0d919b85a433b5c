"""Finite series ``sum_t coef_t prod_j q_j^degree_tj exp(i frequency_tj q_j)`` with array coefficients.

Rotations bring the exponentials, prismatic joints the powers. The frequencies are integers here; what one unit of
each coordinate's frequency means is up to the caller.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...model.arrays import Complexes, Integers


@dataclass(frozen=True)
class Series:
    """Terms `keys` (T, 2n), frequencies first, then degrees; `coef` (T, ...) complex. A term may occur twice."""

    keys: Integers
    coef: Complexes

    @staticmethod
    def constant(value: ArrayLike, n: int) -> Series:
        """The series of one constant term over n coordinates."""
        return Series(np.zeros((1, 2 * n), np.int32), np.asarray(value, complex)[None])

    @staticmethod
    def sum(parts: Iterable[Series]) -> Series:
        """The sum, equal terms collected."""
        parts = list(parts)
        return Series(np.concatenate([p.keys for p in parts]), np.concatenate([p.coef for p in parts])).collected()

    def __len__(self) -> int:
        return len(self.keys)

    def __matmul__(self, other: Series) -> Series:
        """The matrix product, term by term."""
        keys = (self.keys[:, None] + other.keys[None]).reshape(len(self) * len(other), self.keys.shape[1])
        product = np.einsum("sij,tjk->stik", self.coef, other.coef)
        return Series(keys, product.reshape(len(keys), *product.shape[2:]))

    def scaled(self, factor: complex) -> Series:
        """Every coefficient times `factor`."""
        return Series(self.keys, self.coef * factor)

    @property
    def T(self) -> Series:
        """Every coefficient transposed (not conjugated)."""
        return Series(self.keys, np.swapaxes(self.coef, -1, -2))

    def collected(self) -> Series:
        """The same series with each term once, in lexicographic order."""
        active = np.flatnonzero(self.keys.any(axis=0))
        if not len(active):
            return Series(self.keys[:1], self.coef.sum(axis=0, keepdims=True))
        unique, inverse = np.unique(self.keys[:, active], axis=0, return_inverse=True)
        keys = np.zeros((len(unique), self.keys.shape[1]), np.int32)
        keys[:, active] = unique
        coef = np.zeros((len(unique), *self.coef.shape[1:]), complex)
        np.add.at(coef, inverse.ravel(), self.coef)
        return Series(keys, coef)
