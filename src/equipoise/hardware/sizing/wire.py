"""Spring wire: strength, moduli, density and preferred diameters, by EN 10270 and EN 13906.

Lengths in m, stresses in Pa; only inside the strength formulas is the diameter in mm and the strength in MPa, as in the
standards.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...model.errors import Fault, InputError, nearest
from ...model.units import Amount, quantity

Quantity = Any  # a float, or an array of as many values as there are candidate springs

MM = 1e-3
MPA = 1e6
ROUNDED = 10.0  # [MPa] EN 10270-1 states its strengths in steps of this

# EN 10270-1, nominal diameters [mm], from the thinnest that is coiled into a balancing spring
DIAMETERS = np.array([
    0.30, 0.32, 0.34, 0.36, 0.38, 0.40, 0.43, 0.45, 0.48, 0.50, 0.53, 0.56, 0.60, 0.63, 0.65, 0.70, 0.75, 0.80,
    0.85, 0.90, 0.95, 1.00, 1.05, 1.10, 1.20, 1.25, 1.30, 1.40, 1.50, 1.60, 1.70, 1.80, 1.90, 2.00, 2.10, 2.25,
    2.40, 2.50, 2.60, 2.80, 3.00, 3.20, 3.40, 3.60, 3.80, 4.00, 4.25, 4.50, 4.75, 5.00, 5.30, 5.60, 6.00, 6.30,
    6.50, 7.00, 7.50, 8.00, 8.50, 9.00, 9.50, 10.00, 10.50, 11.00, 12.00, 12.50, 13.00, 14.00, 15.00, 16.00,
    17.00, 18.00, 19.00, 20.00,
]) * MM  # fmt: skip


@dataclass(frozen=True)
class Wire:
    """A grade of spring wire.

    Attributes:
        name: grade, as it is ordered.
        standard: that its strength is taken from.
        shear_modulus, youngs_modulus: [Pa], EN 13906-1 and -2, section 8.
        density: [kg/m^3], the same.
        diameters: [m] the thinnest and the thickest that the standard has.
        line: (a, b) of Rm = a - b log10 d [MPa, mm].
        steps: (d, Rm) [mm, MPa]: Rm holds up to and with d.
        given: [Pa] a strength that overrides the standard's.
    """

    name: str
    standard: str
    shear_modulus: float
    youngs_modulus: float
    density: float
    diameters: tuple[float, float]
    line: tuple[float, float] | None = None
    steps: tuple[tuple[float, float], ...] = ()
    given: float | None = None

    def strength(self, d: Quantity) -> Quantity:
        """Least tensile strength Rm [Pa] of wire of diameter `d` [m]; NaN outside the standard's diameters.

        Raises:
            InputError: the grade has no strength of its own, and none is given.
        """
        d_mm = np.asarray(d, float) / MM
        if self.given is not None:
            rm = np.full_like(d_mm, self.given / MPA)
        elif self.line is not None:
            a, b = self.line
            rm = ROUNDED * np.round((a - b * np.log10(d_mm)) / ROUNDED)
        elif self.steps:
            upto, values = (np.array(column) for column in zip(*self.steps, strict=True))
            rm = values[np.minimum(np.searchsorted(upto, d_mm - 1e-9), len(upto) - 1)]
        else:
            raise InputError(Fault(("strength",), f"the tensile strength of {self.name} wire must be given [Pa]"))
        low, high = self.diameters
        inside = (d_mm * MM >= low * (1 - 1e-9)) & (d_mm * MM <= high * (1 + 1e-9))
        rm = np.where(inside, rm * MPA, np.nan)
        return rm if rm.ndim else float(rm)

    @property
    def preferred(self) -> np.ndarray:
        """Preferred diameters [m] that the grade is drawn to."""
        low, high = self.diameters
        return DIAMETERS[(low * (1 - 1e-9) <= DIAMETERS) & (high * (1 + 1e-9) >= DIAMETERS)]

    def with_strength(self, strength: float | None) -> Wire:
        """The same wire with another tensile strength [Pa], from a certificate for example."""
        return replace(self, given=strength)


def _carbon(name: str, line: tuple[float, float], diameters: tuple[float, float]) -> Wire:
    low, high = diameters
    return Wire(name, "EN 10270-1", 81.5e9, 206e9, 7850.0, (low * MM, high * MM), line)


# EN 10270-3, table 2, 1.4310 of normal (NS) and of high (HS) strength: up to d [mm], Rm [MPa]
_NS = (
    (0.20, 2200), (0.30, 2150), (0.40, 2100), (0.50, 2050), (0.65, 2000), (0.80, 1950), (1.00, 1900), (1.25, 1850),
    (1.50, 1800), (1.75, 1750), (2.00, 1700), (2.50, 1650), (3.00, 1600), (3.50, 1550), (4.25, 1500), (5.00, 1450),
    (6.00, 1400), (7.00, 1350), (8.50, 1300), (10.00, 1250),
)  # fmt: skip
_HS = tuple((d, rm + (150 if d <= 2.0 else 100)) for d, rm in _NS)


def _stainless(name: str, steps: tuple[tuple[float, float], ...]) -> Wire:
    return Wire(name, "EN 10270-3", 70e9, 180e9, 7900.0, (0.2 * MM, 10 * MM), steps=steps)


WIRES: dict[str, Wire] = {
    wire.name: wire
    for wire in (
        _carbon("SL", (1720, 660), (1.0, 10.0)),
        _carbon("SM", (1980, 740), (0.3, 20.0)),
        _carbon("DM", (1980, 740), (0.3, 20.0)),
        _carbon("SH", (2230, 820), (0.3, 20.0)),
        _carbon("DH", (2230, 820), (0.3, 20.0)),
        Wire("oil-hardened", "EN 10270-2", 79.5e9, 206e9, 7850.0, (0.5 * MM, 17 * MM)),  # its strength must be given
        _stainless("1.4310", _HS),
        _stainless("1.4310-NS", _NS),
    )
}


def wire(name: str, strength: Amount | None = None) -> Wire:
    """A grade by name, with its standard's strength or a given one [Pa].

    Raises:
        InputError: no such grade, or a strength that is not positive.
    """
    if name not in WIRES:
        raise InputError(Fault(("wire",), f"unknown grade {nearest(name, WIRES)}", tuple(WIRES)))
    given = None if strength is None else quantity(strength, "stress", "strength")
    if given is not None and given <= 0:
        raise InputError(Fault(("strength",), f"must be more than 0 Pa, found {given:g}"))
    found = WIRES[name]
    if given is None and found.line is None and not found.steps:
        raise InputError(Fault(("strength",), f"the tensile strength of {name} wire must be given"))
    return found if given is None else found.with_strength(given)
