"""The example robots, loaded without their known inertia warnings, and the arm of lee2014."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path

import equipoise as eq
from equipoise.model.errors import EquipoiseWarning
from equipoise.synthesis import Design
from equipoise.synthesis.planar.arm import Installation, PlanarArm

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"


@cache
def robot(name: str) -> eq.Mechanism:
    """An example robot by name: ur5, ur10, panda, xarm7 or human."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)
        return eq.load(ROBOTS / f"{name}.urdf")


@cache
def balanced(name: str = "ur5", radius: float = 0.15) -> Design:
    """A UR, made weightless by three springs: the search takes seconds, so tests share it."""
    return eq.design(robot(name), span=3, radius=radius, shape="box", springs=3)


def planar_arm(masses: list[float], lengths: list[float], centres: list[float]) -> eq.Mechanism:
    """Links 2, 3, ... in the x-z plane, each turning about y, as in lee2014 (link 1 is the ground)."""
    names = ["world", *(f"link{i}" for i in range(2, len(masses) + 2))]
    offsets = [0.0, *lengths[:-1]]
    return eq.Mechanism(
        "planar arm",
        bodies=tuple(eq.Body(n, m, (s, 0, 0)) for n, m, s in zip(names[1:], masses, centres, strict=True)),
        joints=tuple(
            eq.Joint(f"joint{i + 2}", "revolute", names[i], names[i + 1], xyz=(x, 0, 0), axis=(0, -1, 0))
            for i, x in enumerate(offsets)
        ),
    )


def lee_chen() -> eq.Mechanism:
    """The three-link arm of lee2014, Table 4."""
    return planar_arm([0.848, 0.848, 1.330], [0.180, 0.180, 0.070], [0.090, 0.090, 0.060])


def lee_chen_springs(k13: float = 590.0, k1: float = 78.0, k2: float = 160.0, apart: float = 0.16) -> eq.Mechanism:
    """The arm of Table 4 with three springs by lee2014's Eqs. (39)-(43), exact for any stiffnesses [N/m].

    Args:
        apart: [m] by which the two springs 1-4 are apart on the ground, which the equations leave free.
    """
    g, (m2, m3, m4), r, s4 = 9.81, (0.848, 0.848, 1.330), 0.180, 0.060
    G2, G3, G4 = (0.5 * m2 + m3 + m4) * g, (0.5 * m3 + m4) * g, s4 * m4 * g
    b13 = r * (k1 + k2) / k13  # (42)
    a13 = (G2 - G3) / (k13 * (1 + b13 / r))  # (39) - (40)
    a2 = (G3 + k13 * a13 * b13 / r - k1 * apart) / (k1 + k2)  # (40)
    c = G4 / apart  # (41) with (43): k1 b1 = k2 b2 = c
    found = (
        Installation(1, 3, k13, 1j * a13, -b13),
        Installation(1, 4, k1, 1j * (a2 + apart), c / k1),
        Installation(1, 4, k2, 1j * a2, -c / k2),
    )
    return lee_chen().with_springs(PlanarArm.of(lee_chen()).springs(found))


TABLE_5A = (
    Installation(1, 3, 590, 0.010j, -0.073),
    Installation(1, 4, 78, 0.190j, 0.063),
    Installation(1, 4, 160, 0.030j, -0.031),
)
TABLE_5B = (
    Installation(1, 2, 93, 0.134j, 0.120),
    Installation(1, 4, 128, 0.134j, 0.045),
    Installation(2, 4, 320, 0.072, 0.045),
    Installation(3, 4, 400, -0.262, -0.035),
)
