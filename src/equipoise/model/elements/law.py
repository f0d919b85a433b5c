"""Laws: the force of an element as a function of its path, with its energy, as numbers and as symbols."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..arrays import Array

if TYPE_CHECKING:
    from ...energy.kernel.trace import Trace, Value


class Law(Protocol):
    """What every law answers; s is the path [m or rad], the force pulls towards a smaller s."""

    def energy(self, s: Array) -> Array:
        """[J] at paths s of any shape."""
        ...

    def force(self, s: Array) -> Array:
        """dU/ds [N or N m]."""
        ...

    def over(self, s: Array) -> Array:
        """``force / s``; 0 where a path that is a length vanishes and has no direction."""
        ...

    @property
    def polynomial(self) -> tuple[float, float, float] | None:
        """(c0, c1, c2) where the energy is ``c0 + c1 s + c2 s^2`` for every s, else None."""
        ...

    @property
    def scale(self) -> float:
        """What the kernel multiplies lengths by before it squares them: what makes the law cheapest."""
        ...

    def of_square(self, t: Trace, square: Value) -> tuple[Value, Value, Value]:
        """From the square of a length times `scale`: length [m], energy [J], and ``force / length / scale^2``."""
        ...

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        """Energy [J] and force [N or N m] from the path itself."""
        ...

    def extremes(self, low: float, high: float) -> tuple[float, float]:
        """Least and greatest force [N or N m] on the paths from `low` to `high`."""
        ...


@dataclass(frozen=True)
class Linear:
    """``stiffness (s - rest)``, both ways."""

    stiffness: float
    rest: float = 0.0

    def energy(self, s: Array) -> Array:
        return 0.5 * self.stiffness * (s - self.rest) ** 2

    def force(self, s: Array) -> Array:
        return self.stiffness * (s - self.rest)

    def over(self, s: Array) -> Array:
        if not self.rest:
            return np.full_like(s, self.stiffness)
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.stiffness * np.where(s > 0, 1 - self.rest / s, 0.0)

    @property
    def polynomial(self) -> tuple[float, float, float]:
        k, s0 = self.stiffness, self.rest
        return k / 2 * s0**2, -k * s0, k / 2

    @property
    def scale(self) -> float:
        return sqrt(self.stiffness)

    def of_square(self, t: Trace, square: Value) -> tuple[Value, Value, Value]:
        size = t.sqrt(square)
        length = t.mul(1 / self.scale, size)
        if not self.rest:
            return length, t.mul(0.5, square), 1.0
        free = self.rest * self.scale
        over = t.add(size, -free)
        return length, t.mul(0.5, t.mul(over, over)), t.share(size, free)

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        over = t.add(s, -self.rest)
        return t.mul(self.stiffness / 2, t.mul(over, over)), t.mul(self.stiffness, over)

    def extremes(self, low: float, high: float) -> tuple[float, float]:
        return self.stiffness * (low - self.rest), self.stiffness * (high - self.rest)
