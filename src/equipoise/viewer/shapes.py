"""Shapes as meshes: capsules for links, coils for springs; and the colour of a force."""

from __future__ import annotations

from functools import cache

import numpy as np

from ..model.arrays import Array, Integers

SIDES, STEPS = 6, 12  # of a coil's wire: round it, and along each turn
STRAIGHT = 0.12  # of a spring's length at each end
COOL, MIDDLE, HOT = np.array([38, 110, 190]), np.array([240, 180, 40]), np.array([205, 45, 35])


def capsule(a: Array, b: Array, radius: float, around: int = 20) -> tuple[Array, Integers]:
    """Vertices and faces of a rounded rod from `a` to `b` (3,) [m]."""
    along, length = _unit(b - a)
    x, y = across(along)
    rings = 8
    angle = np.linspace(-np.pi / 2, np.pi / 2, 2 * rings)
    height = np.where(angle < 0, 0.0, length) + radius * np.sin(angle)
    turn = 2 * np.pi * np.arange(around) / around
    circle = np.outer(np.cos(turn), x) + np.outer(np.sin(turn), y)
    points = a + height[:, None, None] * along + (radius * np.cos(angle))[:, None, None] * circle
    return points.reshape(-1, 3), _faces(len(angle), around)


def coil(a: Array, b: Array, radius: float, wire: float, turns: int) -> tuple[Array, Integers]:
    """Vertices and faces of a coil spring from `a` to `b` (3,) [m]; the faces are the same for the same `turns`."""
    along, length = _unit(b - a)
    x, y = across(along)
    count = STEPS * turns
    phase = 2 * np.pi * np.arange(count + 1) / STEPS
    ramp = np.clip(np.minimum(np.arange(count + 1), np.arange(count, -1, -1)) / (STEPS / 2), 0, 1)
    share = STRAIGHT + (1 - 2 * STRAIGHT) * np.arange(count + 1) / count
    offset = (radius * ramp)[:, None] * (np.cos(phase)[:, None] * x + np.sin(phase)[:, None] * y)
    middle = a + (share * length)[:, None] * along + offset
    line = np.vstack([a, middle, b])
    return _tube(line, x, wire), _faces(len(line), SIDES)


def wire(line: Array, radius: float) -> tuple[Array, Integers]:
    """Vertices and faces of a wire along a line (points, 3) [m]."""
    normal = np.linalg.svd(line - line.mean(axis=0))[2][-1]
    return _tube(line, normal, radius), _faces(len(line), SIDES)


def strut(a: Array, b: Array, radius: float) -> tuple[Array, Integers]:
    """Vertices and faces of a gas spring from `a` to `b` (3,) [m]: a cylinder over half the way, and a thin rod."""
    cylinder, faces = capsule(a, a + 0.55 * (b - a), radius)
    rod, more = capsule(a, b, 0.35 * radius)
    return np.vstack([cylinder, rod]), np.vstack([faces, more + len(cylinder)]).astype(np.uint32)


def colour(share: float) -> tuple[int, int, int]:
    """From blue for no force over yellow to red for `share` 1 of the largest."""
    share = float(np.clip(share, 0, 1))
    near, far, s = (COOL, MIDDLE, 2 * share) if share < 0.5 else (MIDDLE, HOT, 2 * share - 1)
    r, g, b = (int(v) for v in near + s * (far - near))
    return r, g, b


def _unit(d: Array) -> tuple[Array, float]:
    length = float(np.linalg.norm(d))
    return (d / length, length) if length > 1e-9 else (np.array([0.0, 0.0, 1.0]), 0.0)


def across(along: Array) -> tuple[Array, Array]:
    """Two unit vectors (3,) that make a right-handed frame with the unit vector `along` (3,)."""
    x: Array = np.asarray(np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))]), float)
    x /= np.linalg.norm(x)
    return x, np.asarray(np.cross(along, x), float)


def _tube(line: Array, first: Array, radius: float) -> Array:
    """(points * SIDES, 3) rings round a line (points, 3)."""
    tangent = np.gradient(line, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-12)
    side = np.cross(tangent, np.roll(tangent, 1, axis=1) + first)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    other = np.cross(tangent, side)
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    ring = np.cos(turn)[None, :, None] * side[:, None] + np.sin(turn)[None, :, None] * other[:, None]
    return (line[:, None] + radius * ring).reshape(-1, 3)


@cache
def _faces(rings: int, around: int) -> Integers:
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    c, d = a + around, b + around
    quads = np.stack([np.stack([a, b, d], axis=-1), np.stack([a, d, c], axis=-1)])
    return quads.reshape(-1, 3).astype(np.uint32)
