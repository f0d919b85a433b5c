"""The example robots, loaded without their known inertia warnings, and the arm of lee2014."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path

import equipoise as eq
from equipoise.errors import EquipoiseWarning

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"


@cache
def robot(name: str) -> eq.Mechanism:
    """An example robot by name: ur5, ur10, panda, xarm7 or human."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)
        return eq.load(ROBOTS / f"{name}.urdf")


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
