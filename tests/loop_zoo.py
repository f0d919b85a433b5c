"""Mechanisms with loops of which much is known in closed form. Conventions of the zoo."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
from zoo import LIFT, hinge

from equipoise.mechanism import Body, Joint, Loop, Mechanism

Y = (0.0, 1.0, 0.0)


def four_bar(a: float = 0.2, b: float = 0.5, c: float = 0.4, d: float = 0.45, **more: object) -> Mechanism:
    """Crank a, coupler b, rocker c, ground d along x; hinges about -y, the coupler's end closed by a hinge."""
    bodies = (
        Body("crank", 1.0, (a / 2, 0, 0)),
        Body("coupler", 1.5, (b / 2, 0.0, 0.05)),
        Body("rocker", 1.2, (c / 2, 0, 0)),
    )
    joints = (
        hinge("crank", "world", "crank"),
        hinge("coupler", "crank", "coupler", a),
        hinge("rocker", "world", "rocker", d),
    )
    loop = Loop("coupler", (b, 0.0, 0.0), "rocker", (c, 0.0, 0.0), LIFT, LIFT)
    assembly = (("coupler", 0.5), ("rocker", 1.8))
    return replace(Mechanism("four-bar", bodies, joints, loops=(loop,), assembly=assembly), **more)  # type: ignore[arg-type]


# DELTA ---------------------------------------------------------------------------------------------------------------

UPPER = LOWER = 0.5  # [m] AB and CD
BASE, PLATFORM, HALF = 0.2, 0.1, 0.05  # [m] radii of the joints A and E, half the distance between the paired rods


def delta(upper: float = UPPER, lower: float = LOWER, base: float = BASE, platform: float = PLATFORM) -> Mechanism:
    """A DELTA hanging under its base, every pair of rods with its own hinges: 16 coordinates, 5 hinge loops.

    Each leg lies in the x-z plane of its own azimuth: A and B turn about -y, C and D about the axis that is normal to
    the rods and to B. At zero the upper link is level; the rods hang down.
    """
    bodies, drives, rest, loops = [], [], [], []
    for i in range(3):
        azimuth = 2 * pi * i / 3
        upper_link, cross, rod, twin, knee = (f"{name} {i + 1}" for name in ("upper", "cross", "rod", "twin", "knee"))
        bodies += [Body(upper_link, 1.225, (upper / 2, 0, 0)), Body(cross, 0.4901), Body(rod, 1.225, (lower / 2, 0, 0))]
        bodies += [Body(twin, 1.225, (lower / 2, 0, 0)), Body(knee, 0.4901)]
        at = (base * np.cos(azimuth), base * np.sin(azimuth), 0.0)
        drives.append(Joint(f"A{i + 1}", "revolute", "world", upper_link, at, (0.0, 0.0, azimuth), LIFT, (-1.2, 1.4)))
        # the cross piece's x axis points along the rods: straight down when the leg is level
        rest.append(Joint(f"B{i + 1}", "revolute", upper_link, cross, (upper, 0, 0), (0.0, pi / 2, 0.0), LIFT))
        rest.append(Joint(f"C{i + 1}", "revolute", cross, rod, (0, HALF, 0), axis=(0.0, 0.0, 1.0)))
        rest.append(Joint(f"C'{i + 1}", "revolute", cross, twin, (0, -HALF, 0), axis=(0.0, 0.0, 1.0)))
        rest.append(Joint(f"D{i + 1}", "revolute", rod, knee, (lower, 0, 0), axis=(0.0, 0.0, 1.0)))
        loops.append(Loop(knee, (0, -2 * HALF, 0), twin, (lower, 0, 0), (0, 0, 1), (0, 0, 1)))
        if i == 0:
            # E: the platform stays level, its origin is its centre
            rest.append(Joint("E1", "revolute", knee, "ankle", (0, -HALF, 0), (0.0, -pi / 2, 0.0), LIFT))
            rest.append(Joint("weld", "fixed", "ankle", "platform", (-platform, 0, 0)))
        else:
            end = (platform * np.cos(azimuth), platform * np.sin(azimuth), 0.0)
            axis = (np.sin(azimuth), -np.cos(azimuth), 0.0)
            loops.append(Loop("platform", end, knee, (0, -HALF, 0), axis, LIFT))
    bodies += [Body("ankle"), Body("platform", 3.687)]
    return Mechanism("DELTA", tuple(bodies), (*drives, *rest), loops=tuple(loops))


def delta_inverse(
    p: np.ndarray, upper: float = UPPER, lower: float = LOWER, offset: float = BASE - PLATFORM
) -> np.ndarray:
    """(N, 3) angles of A for the platform's centre at `p` (N, 3), elbows outwards; NaN where a leg does not reach.

    In each leg's frame ``|p + (platform - base) - upper (cos t, 0, sin t)| = lower``.
    """
    angles = []
    for i in range(3):
        azimuth = 2 * pi * i / 3
        x = p[:, 0] * np.cos(azimuth) + p[:, 1] * np.sin(azimuth) - offset
        y, z = -p[:, 0] * np.sin(azimuth) + p[:, 1] * np.cos(azimuth), p[:, 2]
        c = (x**2 + y**2 + z**2 + upper**2 - lower**2) / (2 * upper)
        with np.errstate(invalid="ignore"):
            angles.append(np.arctan2(z, x) + np.arccos(c / np.hypot(x, z)))
    t = np.stack(angles, axis=1)
    return (t + pi) % (2 * pi) - pi
