"""A force in pieces, each a polynomial of degree three at most: what interpolates between points."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array, Integers

if TYPE_CHECKING:
    from ....energy.kernel.trace import Trace, Value


class Pieces:
    """``dU/ds = sum_p a_p (s - s_i)^p`` between knots s_i and s_{i+1}; beyond the ends the force stays as it is there.

    Args:
        knots: (n + 1,) increasing [m or rad].
        coefficients: (4, n), a_3 first [N/m^p or N m/rad^p], as scipy's piecewise polynomials have them.
        start: the energy at the first knot [J].
    """

    def __init__(self, knots: Array, coefficients: Array, start: float = 0.0) -> None:
        self.knots, self.start = knots, start
        self.a = np.vstack([np.zeros((4 - len(coefficients), len(knots) - 1)), coefficients])[::-1]
        self.width = np.diff(knots)
        powers = self.width[None] ** np.arange(1, 5)[:, None]
        self.below = start + np.concatenate(
            [[0.0], np.cumsum((self.a / np.arange(1, 5)[:, None] * powers).sum(axis=0))]
        )

    def _find(self, s: Array) -> tuple[Integers, Array]:
        """The number of the piece where each path is, and how far in that is."""
        i = np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.width) - 1)
        return i, np.clip(s, self.knots[0], self.knots[-1]) - self.knots[i]

    def pull(self, s: Array) -> Array:
        """[N or N m] at paths s of any shape."""
        i, u = self._find(s)
        a0, a1, a2, a3 = self.a[:, i]
        return a0 + u * (a1 + u * (a2 + u * a3))

    def energy(self, s: Array) -> Array:
        """[J] at paths s of any shape."""
        i, u = self._find(s)
        a0, a1, a2, a3 = self.a[:, i]
        first, last = self.ends
        outside = first * np.minimum(s - self.knots[0], 0) + last * np.maximum(s - self.knots[-1], 0)
        return self.below[i] + u * (a0 + u * (a1 / 2 + u * (a2 / 3 + u * a3 / 4))) + outside

    @cached_property
    def ends(self) -> tuple[float, float]:
        """The force at both ends."""
        first, last = (float(x) for x in self.pull(self.knots[[0, -1]]))
        return first, last

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        """Energy and force as sums over what each piece has added so far: no branch, and nothing large cancels."""
        first, last = self.ends
        from_start = t.add(s, -float(self.knots[0]))
        before = t.sub(from_start, t.clamp(s, float(self.knots[0])))
        after = t.clamp(s, float(self.knots[-1]))
        energies = [self.start, t.mul(first, before), t.mul(last, after)]
        forces: list[Value] = [first]
        for knot, width, own in zip(self.knots.tolist(), self.width.tolist(), self.a.T.tolist(), strict=False):
            a0, a1, a2, a3 = own
            u = t.clamp(s, knot, width)
            forces.append(t.mul(u, _horner(t, u, (a1, a2, a3))))
            energies.append(t.mul(u, _horner(t, u, (a0, a1 / 2, a2 / 3, a3 / 4))))
        return t.total(energies), t.total(forces)

    def extremes(self, low: float, high: float) -> tuple[float, float]:
        """Least and greatest force between two paths: at the ends, at knots, or where a piece has no slope."""
        places = [low, high, *self.knots, *self._level()]
        found = self.pull(np.array([s for s in places if low <= s <= high]))
        return float(found.min()), float(found.max())

    def _level(self) -> Iterator[float]:
        for knot, width, (_, a1, a2, a3) in zip(self.knots, self.width, self.a.T, strict=False):
            for root in np.roots([3 * a3, 2 * a2, a1]):
                if abs(root.imag) < 1e-12 and 0 < root.real < width:
                    yield float(knot + root.real)


def _horner(t: Trace, u: Value, coefficients: tuple[float, ...]) -> Value:
    value: Value = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        value = t.add(t.mul(u, value), coefficient)
    return value
