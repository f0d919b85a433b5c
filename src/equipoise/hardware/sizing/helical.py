"""Cylindrical helical springs of round wire, cold coiled: what EN 13906-1 and -2 have in common.

The sizes may be arrays, of as many candidate springs: every property then is one too, and one formula serves the single
spring and the enumeration.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from .limits import Limits
from .wire import Quantity, Wire


@dataclass(frozen=True)
class Helical:
    """The coils of a spring.

    Attributes:
        wire: its grade.
        d: wire diameter [m].
        D: mean coil diameter [m].
        n: active coils.
    """

    wire: Wire
    d: Quantity
    D: Quantity
    n: Quantity

    @property
    def index(self) -> Quantity:
        """Spring index w = D/d."""
        return self.D / self.d

    @property
    def outer(self) -> Quantity:
        """Outer diameter [m]."""
        return self.D + self.d

    @property
    def inner(self) -> Quantity:
        """Inner diameter [m]."""
        return self.D - self.d

    @property
    def rate(self) -> Quantity:
        """R [N/m], EN 13906-1 (7), -2 (9.5)."""
        return self.wire.shear_modulus * self.d**4 / (8 * self.D**3 * self.n)

    @property
    def correction(self) -> Quantity:
        """k of the greatest stress, at the inside of a coil: Bergstraesser's (w + 0.5)/(w - 0.75), EN 13906-1, 6."""
        w = self.index
        return (w + 0.5) / (w - 0.75)

    @property
    def strength(self) -> Quantity:
        """Tensile strength Rm of the wire [Pa]."""
        return self.wire.strength(self.d)

    def stress(self, force: Quantity) -> Quantity:
        """Torsional stress tau [Pa] at a force [N], uncorrected, which counts for static load."""
        return 8 * self.D * force / (pi * self.d**3)

    def corrected(self, force: Quantity) -> Quantity:
        """Greatest torsional stress tau_k = k tau [Pa], which counts for alternating load."""
        return self.correction * self.stress(force)

    def force_at(self, stress: Quantity) -> Quantity:
        """Force [N] at an uncorrected stress [Pa]."""
        return pi * self.d**3 * stress / (8 * self.D)

    def coil_mass(self, coils: Quantity) -> Quantity:
        """Mass [kg] of a number of coils."""
        return self.wire.density * (pi / 4 * self.d**2) * (pi * self.D * coils)

    @property
    def frequency(self) -> Quantity:
        """Lowest natural frequency [Hz] of the coils with both ends held, EN 13906-1, 9.9."""
        return self.d / (2 * pi * self.n * self.D**2) * np.sqrt(self.wire.shear_modulus / (2 * self.wire.density))

    def fatigue_margin(self, least: Quantity, most: Quantity, limits: Limits) -> Quantity:
        """Goodman margin of a force that changes between two values [N]: 1 lasts for the limits' cycles, less breaks.

        The line runs from the endured amplitude at no mean stress to the ultimate shear strength.
        """
        top, bottom = self.corrected(most), self.corrected(least)
        ultimate = limits.shear_strength * self.strength
        endured = limits.endured(ultimate)
        with np.errstate(divide="ignore"):
            return 1 / ((top - bottom) / 2 / endured + (top + bottom) / 2 / ultimate)


def coils_for(wire: Wire, d: Quantity, D: Quantity, rate: Quantity) -> Quantity:
    """Active coils that give a rate [N/m]."""
    return wire.shear_modulus * d**4 / (8 * D**3 * rate)
