"""Planar arms and the pairs of their links, the ground being link 1."""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians, sin

import equipoise as eq
from equipoise.synthesis.planar.layouts import example_arm


def pairs(n: int) -> list[tuple[int, int]]:
    return [(i, k) for i in range(1, n + 1) for k in range(i + 1, n + 1)]


def crooked(n: int, angle: float = radians(20)) -> eq.Mechanism:
    """Mass centres off the link lines."""
    arm = example_arm(n)
    com = (0.1 * cos(angle), 0.0, 0.1 * sin(angle))
    return replace(arm, bodies=tuple(replace(body, com=com) for body in arm.bodies))
