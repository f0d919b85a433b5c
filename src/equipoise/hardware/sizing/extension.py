"""Helical extension springs by EN 13906-2: close wound with initial tension, with full loops at both ends."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from .helical import Helical
from .limits import Limits
from .wire import Quantity

LOOP = 0.8  # of the inner diameter: the shortest full (German) loop of EN 13906-2, annex A, 0.8 to 1.1
LOOP_COILS = 1.0  # wire in one full loop, in coils


@dataclass(frozen=True)
class ExtensionSpring(Helical):
    """An extension spring.

    Attributes:
        initial_stress: tau_0 [Pa] that the coils are wound with.
        hook: L_H [m], from the body to the inside of the loop, at each end.
    """

    initial_stress: Quantity = 0.0
    hook: Quantity = 0.0

    @property
    def initial_tension(self) -> Quantity:
        """F_0 [N], at which the coils begin to part, EN 13906-2, 9.10."""
        return self.force_at(self.initial_stress)

    @property
    def body(self) -> Quantity:
        """L_K [m], the length of the closed coils."""
        return (self.n + 1) * self.d

    @property
    def free_length(self) -> Quantity:
        """L_0 [m], unloaded, between the insides of the loops."""
        return self.body + 2 * self.hook

    @property
    def left_over(self) -> Quantity:
        """Free length [m] of the line F = k (L - left_over) of the open spring: 0 is a zero-free-length spring."""
        return self.free_length - self.initial_tension / self.rate

    @property
    def mass(self) -> Quantity:
        """[kg], loops included; what loops are longer than full ones is a straight piece of wire."""
        straight = 2 * np.maximum(self.hook - LOOP * self.inner, 0.0)
        loops = self.coil_mass(self.n + 2 * LOOP_COILS)
        return loops + self.wire.density * (pi / 4) * self.d**2 * straight

    def length(self, force: Quantity) -> Quantity:
        """[m] between the insides of the loops at a force [N]."""
        return self.free_length + np.maximum(force - self.initial_tension, 0.0) / self.rate

    def hook_bending(self, force: Quantity) -> Quantity:
        """Greatest bending stress in a full loop [Pa], Shigley eq. 10-34: bent with radius D/2."""
        w = self.index
        k = (4 * w**2 - w - 1) / (4 * w * (w - 1))
        return force * (k * 16 * self.D / (pi * self.d**3) + 4 / (pi * self.d**2))

    def hook_torsion(self, force: Quantity) -> Quantity:
        """Greatest torsional stress where the loop leaves the body [Pa], Shigley eq. 10-36, bent with radius D/4."""
        c = self.index / 2
        return (4 * c - 1) / (4 * c - 4) * self.stress(force)

    def hook_margin(self, force: Quantity, limits: Limits) -> Quantity:
        """The smaller of the loop's two margins."""
        bending = limits.hook_bending * self.strength / self.hook_bending(force)
        torsion = limits.hook_torsion * self.strength / self.hook_torsion(force)
        return np.minimum(bending, torsion)

    def static_margin(self, force: Quantity, limits: Limits) -> Quantity:
        """Permissible over present stress of the coils; the loops have their own."""
        return limits.extension * self.strength / self.stress(force)
