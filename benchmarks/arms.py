"""The mechanisms that are measured: a real arm with springs, and chains of any length about skew axes."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

import equipoise as eq
from equipoise.model.errors import EquipoiseWarning

UR5 = Path(__file__).parents[1] / "examples" / "robots" / "ur5.urdf"
LINKS = ("world", "shoulder_link", "upper_arm_link", "forearm_link", "wrist_1_link", "wrist_2_link", "wrist_3_link")
PAIRS = (
    (0, 2),
    (1, 3),
    (2, 4),
    (3, 5),
    (4, 6),
    (1, 2),
    (2, 3),
    (1, 4),
)  # numbers of links; the first five use all joints


def ur5(springs: int = 5) -> eq.Mechanism:
    """A UR5 with zero-free-length springs, most of them over two joints: from two on no joint is idle."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)
        bare = eq.load(UR5)
    rng = np.random.default_rng(0)
    found = []
    for i in range(springs):
        a, b = PAIRS[i % len(PAIRS)]
        p_a, p_b = rng.uniform(-0.15, 0.15, (2, 3)).tolist()
        found.append(eq.Spring(f"s{i}", LINKS[a], tuple(p_a), LINKS[b], tuple(p_b), float(rng.uniform(100, 900))))
    return bare.with_springs(found)


def chain(joints: int) -> eq.Mechanism:
    """So many revolute joints about skew axes, and a spring over the last two joints on every body."""
    rng = np.random.default_rng(0)
    names = ["world", *(f"b{i}" for i in range(1, joints + 1))]

    def vector(size: float) -> tuple[float, float, float]:
        x, y, z = rng.uniform(-size, size, 3).tolist()
        return x, y, z

    return eq.Mechanism(
        f"chain of {joints}",
        tuple(eq.Body(name, 1.0, vector(0.1)) for name in names[1:]),
        tuple(
            eq.Joint(f"j{i}", "revolute", names[i - 1], names[i], vector(0.3), vector(3.0), vector(1.0))
            for i in range(1, joints + 1)
        ),
        springs=tuple(
            eq.Spring(f"s{i}", names[max(0, i - 2)], vector(0.15), names[i], vector(0.15), 100.0)
            for i in range(1, joints + 1)
        ),
    )
