"""Helical compression springs by EN 13906-1: cold coiled, closed and ground ends."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from .helical import Helical
from .limits import Limits
from .wire import MM, Quantity

END_COILS = 2.0  # n_t - n, closed and ground


@dataclass(frozen=True)
class CompressionSpring(Helical):
    """A compression spring.

    Attributes:
        free_length: L_0 [m], unloaded.
    """

    free_length: Quantity = 0.0

    @property
    def solid_length(self) -> Quantity:
        """L_c [m] with all coils touching: n_t d."""
        return (self.n + END_COILS) * self.d

    @property
    def gaps(self) -> Quantity:
        """S_a [m]: the gaps that must be left at the largest force, EN 13906-1, 9.7, static load."""
        return self.n * (0.0015 * self.D**2 / self.d + 0.1 * self.d)

    @property
    def stroke(self) -> Quantity:
        """[m] by which it may be compressed."""
        return self.free_length - self.solid_length - self.gaps

    @property
    def mass(self) -> Quantity:
        """[kg], end coils included."""
        return self.coil_mass(self.n + END_COILS)

    def length(self, force: Quantity) -> Quantity:
        """[m] at a force [N]."""
        return self.free_length - force / self.rate

    def static_margin(self, force: Quantity, limits: Limits) -> Quantity:
        """Permissible over present stress, at the force and when it is pressed solid: the smaller."""
        solid = self.rate * (self.free_length - self.solid_length)
        at_force = limits.compression * self.strength / self.stress(force)
        return np.minimum(at_force, limits.solid * self.strength / self.stress(solid))

    def buckling_stroke(self, seating: float = 0.5) -> Quantity:
        """Stroke [m] at which it buckles when nothing guides it, EN 13906-1, 9.8; infinite for a stocky one.

        Args:
            seating: nu, 0.5 between parallel plates (both ends held), 1 between hinges, 2 with one end free.
        """
        share = 1 - self.wire.shear_modulus / self.wire.youngs_modulus
        other = 0.5 + self.wire.shear_modulus / self.wire.youngs_modulus
        inside = 1 - share / other * (pi * self.D / (seating * self.free_length)) ** 2
        with np.errstate(invalid="ignore"):
            stroke = self.free_length * 0.5 / share * (1 - np.sqrt(inside))
        found = np.where(np.asarray(inside) >= 0, stroke, np.inf)
        return found if found.ndim else float(found)


def least_free_length(coils: Helical, stroke: Quantity) -> Quantity:
    """L_0 [m] of the compression spring that has just this stroke [m], rounded up to 0.5 mm."""
    bare = CompressionSpring(coils.wire, coils.d, coils.D, coils.n, 0.0)
    return np.ceil((stroke + bare.solid_length + bare.gaps) / (0.5 * MM) - 1e-9) * (0.5 * MM)
