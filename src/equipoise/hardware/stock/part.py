"""A part of a list, and what it endures."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import inf
from typing import Any

import numpy as np

from ..sizing.helical import Helical
from ..sizing.limits import Limits
from ..sizing.wire import wire

WIRE = "SH"
"""Grade that a part is taken to be wound of where its list does not say (EN 10270-1)."""


@dataclass(frozen=True)
class Stock:
    """A spring that is in stock, in SI units; see `parts.COLUMNS`."""

    part: str
    kind: str
    rate: float = 0.0
    max_force: float = 0.0
    free_length: float = 0.0
    outer_diameter: float = 0.0
    wire_diameter: float = 0.0
    mass: float = 0.0
    initial_tension: float = 0.0
    price: float = 0.0
    max_length: float = inf
    min_length: float = 0.0
    wire: str = ""
    force: float = 0.0
    progression: float = 0.0
    torsional_rate: float = 0.0
    max_torque: float = 0.0

    @property
    def stroke(self) -> float:
        """[m] that it may be stretched or compressed."""
        if self.kind == "gas":
            return self.free_length - self.min_length
        return (self.max_force - self.initial_tension) / self.rate


def endurance(part: Stock, limits: Limits) -> tuple[float, float]:
    """(top, bottom) [1/N]: it lasts while ``top * largest - bottom * least`` force is at most 1.

    (0, 0) where fatigue is not asked for, or where its wire is not known.
    """
    d, D = part.wire_diameter, part.outer_diameter - part.wire_diameter
    if not limits.fatigue or not d > 0 or not d < D:
        return 0.0, 0.0
    coils = Helical(wire(part.wire or WIRE), d, D, 1.0)
    ultimate = limits.shear_strength * coils.strength
    if not np.isfinite(ultimate):
        return 0.0, 0.0
    stress, endured = limits.fatigue * float(coils.corrected(1.0)), float(limits.endured(ultimate))
    return stress / 2 * (1 / endured + 1 / ultimate), stress / 2 * (1 / endured - 1 / ultimate)


def said(part: Stock) -> dict[str, Any]:
    """As a file or JSON has it."""
    return {name: None if value == inf else value for name, value in asdict(part).items()}


Catalogue = tuple[Stock, ...]
