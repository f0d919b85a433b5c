"""The numbers that lin2010 prints: Tables 1 to 4."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

PAPER = "lin2010"
Printed = tuple[str, str, str]

# Table 1: d [m], a [m], alpha; auxiliary link 1 is 0.1 m above link 1, the others lie along theirs.
TABLE_1 = {
    1: (0.0, 0.1, pi / 2),
    2: (0.0, 0.4, 0.0),
    3: (0.0, 0.0, pi / 2),
    4: (0.5, 0.0, -pi / 2),
    5: (0.0, 0.0, pi / 2),
    6: (0.27, 0.0, 0.0),
}
HEIGHT = 0.1  # [m] d of frame 1^ less that of frame 1


@dataclass(frozen=True)
class Link:
    """A row of Table 2: masses [kg] and points in frame i [m], as printed; a number without a point is exact.

    Where such a number is a result, the zero of sigma_i.x, it is written here with the digits of its row.
    """

    m: str
    m_base: str  # of the pseudobase
    m_hat: str  # of the auxiliary link
    s: Printed
    s_hat: Printed
    c: Printed
    mu: str
    sigma: Printed


TABLE_2 = {
    2: Link("23.21", "0.47", "2.38", ("-0.20", "0.00", "-0.1"), ("-0.17", "0.07", "0.06"), ("-0.3", "0.1", "-0.1"),
            "105.92", ("0.25", "0.00", "-0.02")),
    3: Link("24.51", "0.47", "0.81", ("0", "0", "0"), ("0", "0.02", "0.10"), ("0", "0.06", "0.09"),
            "79.59", ("0.00", "0.00", "0.00")),
    4: Link("15.13", "0.47", "1.58", ("0", "0.16", "0.00"), ("0", "0.13", "0.00"), ("0", "0.21", "0.06"),
            "45.21", ("0.00", "-0.25", "0.00")),
    5: Link("6.12", "0.47", "1.32", ("0", "0.02", "0.11"), ("0", "0.01", "0.09"), ("0", "-0.1", "0.1"),
            "18.76", ("0.00", "0.00", "0.05")),
    6: Link("2.20", "0.47", "0.27", ("0", "0.00", "-0.02"), ("0", "-0.02", "-0.08"), ("0", "-0.06", "-0.06"),
            "5.88", ("0.00", "-0.01", "0.12")),
}  # fmt: skip


@dataclass(frozen=True)
class Balancer:
    """A row of Table 3: K [N/m] and l_CA [m] are chosen, l_CB [m] and the ends in frame i [m] follow."""

    K: float
    l_CA: float
    l_CB: str
    a: Printed
    b: Printed


TABLE_3 = {
    2: Balancer(20e3, 0.1, "0.13", ("-0.2", "0.1", "-0.1"), ("-0.17", "0.10", "-0.11")),
    3: Balancer(2e3, 0.08, "0.01", ("0.08", "0.06", "0.09"), ("0.00", "0.06", "0.09")),
    4: Balancer(15e3, 0.08, "0.09", ("0.08", "0.21", "0.06"), ("0.00", "0.12", "0.06")),
    5: Balancer(2e3, 0.08, "0.05", ("0.08", "-0.1", "0.1"), ("0.00", "-0.09", "0.15")),
    6: Balancer(1e3, 0.08, "0.09", ("0.08", "-0.06", "-0.06"), ("0.00", "-0.06", "0.03")),
}

# Table 4: t_I, t_F [s], theta_I, theta_F [rad], and the coefficients of the cubic as printed
TABLE_4 = {
    1: (0, 5, 1.57, -0.42, ("1.57", "0.0000", "-0.2388", "0.0318")),
    2: (0, 5, 1.57, 0.57, ("1.57", "0.0000", "-0.12", "0.016")),
    3: (0, 5, 0, 1, ("0", "0", "0.12", "-0.016")),
    4: (1, 3, 0, 1, ("1", "-2.25", "1.5", "-0.25")),
    5: (5, 9, 0, 1.2, ("10.3125", "-5.0625", "0.7875", "-0.0375")),
    6: (5, 9, 0, 2.5, ("21.4844", "-10.5429", "1.6406", "-0.0781")),
}


def point(printed: Printed) -> tuple[float, float, float]:
    """A printed point [m]."""
    x, y, z = map(float, printed)
    return x, y, z
