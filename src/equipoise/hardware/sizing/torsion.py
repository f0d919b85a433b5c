"""Helical torsion springs by EN 13906-3: cold coiled of round wire, wound up by a moment, which bends the wire."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from ...model.errors import Fault, InputError
from .helical import Helical
from .limits import BENDING, Limits
from .winding import REACHED, STEP
from .wire import MM, Quantity, Wire

LEAST_COILS = 2.0  # EN 13906-3, table 1
PLAY = 1.05  # of the inner diameter over the mandrel's when it is wound up


@dataclass(frozen=True)
class TorsionCoil(Helical):
    """A torsion spring; `n` are its coils when nothing turns it."""

    @property
    def rate(self) -> Quantity:
        """R_M [N m/rad], EN 13906-3: E d^4 / (64 D n), or 3667 in the place of 64 for degrees."""
        return self.wire.youngs_modulus * self.d**4 / (64 * self.D * self.n)

    @property
    def bending_correction(self) -> Quantity:
        """q of the greatest stress, at the inside: (w + 0.07) / (w - 0.75), EN 13906-3."""
        return (self.index + 0.07) / (self.index - 0.75)

    def bending(self, moment: Quantity) -> Quantity:
        """Bending stress sigma [Pa] at a moment [N m], uncorrected, which counts for static load."""
        return 32 * moment / (pi * self.d**3)

    def static_margin(self, moment: Quantity, limits: Limits) -> Quantity:
        """Permissible over present stress."""
        return limits.bending * self.strength / self.bending(moment)

    def fatigue_margin(self, least: Quantity, most: Quantity, limits: Limits) -> Quantity:
        """Goodman margin of a moment that changes between two values [N m]: 1 lasts for the limits' cycles."""
        top, bottom = (self.bending_correction * self.bending(moment) for moment in (most, least))
        endured = limits.endured(self.strength, BENDING)
        with np.errstate(divide="ignore"):
            return 1 / ((top - bottom) / 2 / endured + (top + bottom) / 2 / self.strength)

    def mandrel(self, turned: float) -> Quantity:
        """[m] the thickest mandrel when it is turned by so much [rad]: it gets narrower."""
        return (self.D * self.n / (self.n + turned / (2 * pi)) - self.d) / PLAY

    def body(self, turned: float) -> Quantity:
        """[m] length of its coils when it is turned by so much [rad]."""
        return (self.n + 1.5 + turned / (2 * pi)) * self.d

    @property
    def mass(self) -> Quantity:
        """[kg], with legs of one coil diameter."""
        return self.coil_mass(self.n + 2 / pi)


@dataclass(frozen=True)
class Coiled:
    """The answer: the lightest torsion spring that does it, or the nearest, with what each margin reaches."""

    spring: TorsionCoil
    static: float
    fatigue: float
    feasible: bool


def torsion(
    rate: float, least: float, most: float, wires: Sequence[Wire], limits: Limits, outer: float = np.inf
) -> Coiled:
    """The lightest torsion spring of a rate [N m/rad] for moments [N m] from least to most, all in one direction.

    Args:
        outer: greatest outer diameter [m].

    Raises:
        InputError: no rate, no moment, or no wire that can be wound within the diameter.
    """
    if not (rate > 0 and 0 <= least <= most and most > 0):
        raise InputError(
            Fault(("need",), f"a torsion spring needs a rate and moments, found {rate:g}, {least:g} to {most:g}")
        )
    best: tuple[tuple[bool, float], Coiled] | None = None
    for wire in wires:
        low, high = limits.index
        d, w = (x.ravel() for x in np.meshgrid(wire.preferred, np.arange(low, high + 0.5, 0.5)))
        D = np.round(w * d / STEP) * STEP
        n = wire.youngs_modulus * d**4 / (64 * D * rate)
        good = (D + d <= outer) & (n >= LEAST_COILS) & (D / d >= low * (1 - REACHED))
        if not good.any():
            continue
        s = TorsionCoil(wire, d[good], D[good], n[good])
        static, fatigue = s.static_margin(most, limits), s.fatigue_margin(least, most, limits)
        reached = static / limits.safety
        if limits.fatigue:
            reached = np.minimum(reached, fatigue / limits.fatigue)
        reached = np.minimum(reached, 1.0)
        i = int(np.lexsort((s.mass, -reached))[0])
        one = TorsionCoil(wire, float(s.d[i]), float(s.D[i]), float(s.n[i]))
        coiled = Coiled(one, float(static[i]), float(fatigue[i]), bool(reached[i] >= 1 - REACHED))
        key = (not coiled.feasible, float(one.mass) if coiled.feasible else -float(reached[i]))
        if best is None or key < best[0]:
            best = key, coiled
    if best is None:
        raise InputError(
            Fault(("envelope",), f"no preferred wire gives this rate within an outer diameter of {outer / MM:g} mm")
        )
    return best[1]
