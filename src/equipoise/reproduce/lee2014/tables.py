"""The numbers that lee2014 prints: Tables 2 to 5 and the poses of section 8."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...synthesis.planar.arm import Installation
from ...synthesis.planar.exclusion import Layout
from ...synthesis.planar.installing import A, B

# Table 4: m [kg], r [m], s [m]
TABLE_4 = {2: (0.848, 0.180, 0.090), 3: (0.848, 0.180, 0.090), 4: (1.330, 0.070, 0.060)}


@dataclass(frozen=True)
class Printed:
    """A row of Table 5: a, b [m] as printed; k [N/m] was chosen, and the angles in quarter turns."""

    i: int
    k: int
    stiffness: float
    a: str
    b: str
    alpha: int
    beta: int

    def installed(self, a: float, b: float) -> Installation:
        """The spring with ends `a` and `b` [m] from their joints."""
        return Installation(self.i, self.k, self.stiffness, a * 1j**self.alpha, b * 1j**self.beta)


@dataclass(frozen=True)
class Case:
    """One half of Table 5.

    Attributes:
        energy: [N m] the total that is printed.
        free: (row, A or B) lengths that the design equations leave free; the others follow from them.
    """

    letter: str
    rows: tuple[Printed, ...]
    energy: str
    free: tuple[tuple[int, int], ...]

    @property
    def layout(self) -> Layout:
        return tuple((row.i, row.k) for row in self.rows)

    @property
    def free_texts(self) -> list[str]:
        return [(self.rows[s].a, self.rows[s].b)[which - A] for s, which in self.free]


CASES = (
    Case(
        "a",
        (
            Printed(1, 3, 590, "0.010", "0.073", 1, 2),
            Printed(1, 4, 78, "0.190", "0.063", 1, 0),
            Printed(1, 4, 160, "0.030", "0.031", 1, 2),
        ),
        "20.56",
        ((1, B),),
    ),
    Case(
        "b",
        (
            Printed(1, 2, 93, "0.134", "0.120", 1, 0),
            Printed(1, 4, 128, "0.134", "0.045", 1, 0),
            Printed(2, 4, 320, "0.072", "0.045", 0, 0),
            Printed(3, 4, 400, "0.262", "0.035", 2, 2),
        ),
        "27.27",
        ((0, B), (3, A)),
    ),
)

# Tables 2 and 3; to the latter, as far as it can be read, the layouts with springs 23 and 24, or 24 and 34,
# that the last but one paragraph of section 7.2 adds
TABLE_2 = {2: ("12",), 3: ("13,23", "13,13"), 4: ("13,14,24", "13,14,14"), 5: ("13,14,15,25", "13,14,15,15")}
TABLE_3 = {
    3: ("13,23",),
    4: ("13,14,24", "12,14,23,24", "12,14,24,34"),
    5: ("13,14,15,25", "12,14,15,23,25", "13,15,23,24,25", "13,15,24,25,34"),
}
THIRD = ((1, 2), (1, 3), (1, 5), (2, 4), (2, 5), (3, 5), (4, 5))  # Table 3, n = 5, third matrix as printed

# Section 8: theta_2, theta_3, theta_4 [deg] at the times 0, 1 and 2
POSES = ((135, 225, 270), (90, 270, 270), (90, 315, 45))
TIMES = np.linspace(0, 2, 401)
