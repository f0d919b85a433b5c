"""Mechanisms with loops of which much is known in closed form. Conventions of the zoo."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from zoo import LIFT, hinge

from equipoise.model.elements import Spring
from equipoise.model.mechanism import Body, Joint, Loop, Mechanism

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


# More ----------------------------------------------------------------------------------------------------------------


def slider_crank(crank: float = 0.2, rod: float = 0.5) -> Mechanism:
    """The piston, 0.6 kg, slides along x through the crank's axis; a point closure, since the rod's axis is across."""
    bodies = (Body("crank", 1.0, (crank / 2, 0, 0)), Body("rod", 0.8, (rod / 2, 0, 0.03)), Body("piston", 0.6))
    joints = (
        hinge("crank", "world", "crank"),
        hinge("rod", "crank", "rod", crank),
        Joint("piston", "prismatic", "world", "piston", axis=(2.0, 0.0, 0.0), range=(0.1, 1.0)),
    )
    loop = Loop("rod", (rod, 0.0, 0.0), "piston", (0.0, 0.0, 0.0))
    spring = Spring("s", "world", (0.1, 0.2, 0.4), "rod", (0.2, 0.0, 0.05), 80.0, 0.1)
    return Mechanism("slider-crank", bodies, joints, loops=(loop,), springs=(spring,), assembly=(("piston", 0.7),))


def spatial_parallelogram() -> Mechanism:
    """Two equal bars on parallel axes that are level with nothing, a coupler between their ends: hinges, redundant."""
    axis, side = (0.3, -1.0, 0.2), (0.0, 0.0, 0.15)
    bodies = (Body("bar", 1.0, (0.2, 0.1, 0)), Body("twin", 0.7, (0.2, 0.1, 0)), Body("coupler", 0.5, (0, 0.02, 0.07)))
    joints = (
        Joint("bar", "revolute", "world", "bar", (0.1, 0.2, 0.3), axis=axis, range=(-1.0, 1.0)),
        Joint("twin", "revolute", "world", "twin", (0.1, 0.2, 0.45), axis=axis),
        Joint("coupler", "revolute", "bar", "coupler", (0.4, 0.2, 0.1), axis=axis),
    )
    loop = Loop("twin", (0.4, 0.2, 0.1), "coupler", side, axis, axis)
    spring = Spring("s", "world", (0.2, 0.1, 0.6), "coupler", (0.0, 0.0, 0.1), 120.0)
    return Mechanism("spatial parallelogram", bodies, joints, loops=(loop,), springs=(spring,))


def rod_leg() -> Mechanism:
    """A knee that a crank drives through a rod, three hinges at each end of it, on a hip; open at zero, no ranges.

    The rod's spin matters to nothing; the crank turns as far as the rod reaches.
    """
    bodies = (
        Body("thigh", 7.2, (0.02, 0, -0.15)),
        Body("crank", 0.6, (0.02, 0, 0)),
        Body("shin", 3.4, (0, 0, -0.2)),
        *(Body(name) for name in ("upper x", "upper y", "lower x", "lower y", "end")),
        Body("rod", 0.44, (0, 0, -0.15)),
    )
    joints = [hinge("hip", "world", "thigh")]
    joints += [
        Joint(name, "revolute", "thigh", name, (0, 0, z), axis=LIFT) for name, z in (("crank", -0.1), ("shin", -0.4))
    ]
    for place, parent, last in (("upper", "crank", "rod"), ("lower", "shin", "end")):
        chain = (parent, f"{place} x", f"{place} y", last)
        for i, axis in enumerate(np.eye(3).tolist()):
            at = (0.06, 0.02, 0.0) if i == 0 else (0.0, 0.0, 0.0)
            name = f"{place} {'xyz'[i]}"
            joints.append(Joint(name, "revolute", chain[i], chain[i + 1], at, axis=(axis[0], axis[1], axis[2])))
    side = ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0))
    loops = tuple(Loop("rod", (x, y, -0.25), "end", (x, y, 0.0)) for x, y, _ in side)
    return Mechanism("leg with a rod", bodies, tuple(joints), loops=loops)


def gough_stewart() -> Mechanism:
    """Six legs of a hinge, a hinge and a strut, on ball joints under the platform; the struts are the actuators.

    `swing` turns about x and `hip` about -y, so that at zero a strut points up.
    """
    bodies, joints, loops = [], [], []
    for i in range(1, 7):
        foot, head = STEWART_FEET[i - 1], STEWART_HEADS[i - 1]
        up = (0.0, -pi / 2, 0.0)  # the strut's x axis
        bodies += [Body(f"yoke {i}"), Body(f"lower {i}", 0.7, (0.15, 0, 0)), Body(f"upper {i}", 0.5, (-0.2, 0, 0))]
        joints += [
            Joint(f"strut {i}", "prismatic", f"lower {i}", f"upper {i}", axis=(1.0, 0.0, 0.0), range=(0.45, 0.65)),
            Joint(f"swing {i}", "revolute", "world", f"yoke {i}", tuple(foot), axis=(1.0, 0.0, 0.0)),
            Joint(f"hip {i}", "revolute", f"yoke {i}", f"lower {i}", rpy=up, axis=LIFT),
        ]
        if i == 1:
            joints.append(Joint("ball", "spherical", "upper 1", "ball", rpy=(0.0, pi / 2, 0.0)))
            joints.append(Joint("plate", "fixed", "ball", "platform", tuple(-head)))
        else:
            loops.append(Loop(f"upper {i}", (0.0, 0.0, 0.0), "platform", tuple(head)))
    bodies += [Body("ball"), Body("platform", 4.0, (0.01, 0.02, 0.03))]
    springs = (Spring("s", "world", (0.0, 0.0, 1.2), "platform", (0.05, 0.0, 0.0), 90.0),)
    names = tuple(f"strut {i}" for i in range(1, 7))
    assembly = tuple((name, 0.53) for name in names)
    return Mechanism("Gough-Stewart platform", tuple(bodies), tuple(joints), loops=tuple(loops), springs=springs,
                     independent=names, assembly=assembly)  # fmt: skip


def _ring(radius: float, half: float, turn: float) -> np.ndarray:
    angles = np.array([2 * pi / 3 * (i // 2) + turn + half * (-1, 1)[i % 2] for i in range(6)])
    return radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(6)])


STEWART_FEET, STEWART_HEADS = _ring(0.3, 0.2, 0.0), _ring(0.2, 0.8, 0.0)


def _examples() -> Any:
    path = Path(__file__).parents[1] / "examples" / "mechanisms" / "make.py"
    spec = spec_from_file_location("make_examples", path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


EXAMPLES = _examples()
"""examples/mechanisms/make.py, which builds the example files with loops."""

LOOPED: dict[str, Callable[[], Mechanism]] = {
    "four-bar": lambda: replace(
        four_bar(), springs=(Spring("s", "world", (0.1, 0.0, 0.5), "coupler", (0.3, 0.0, 0.1), 150.0),)
    ),
    "slider-crank": slider_crank,
    "parallelogram": spatial_parallelogram,
    "RSSR": EXAMPLES.rssr,
    "DELTA": delta,
    "rod leg": rod_leg,
    "Gough-Stewart": gough_stewart,
    "hexapod": EXAMPLES.hexapod,
}
"""One of each kind, some of them balanced."""
