"""A cable around a profile, or a roller on it, by polygons and convex hulls: nothing is shared with the program's way.

The profile is the polygon of the written points. A taut cable from its first point to the fixed point runs along the
convex hull of both; a roller rests where it first meets a corner or a side.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Wrapped(NamedTuple):
    """At one angle: length of the cable or height of the roller [m], its lever [m], and the corner where it touches."""

    length: float
    lever: float
    corner: int


def hull(points: list[tuple[float, float]]) -> list[int]:
    """Numbers of the corners of the convex hull, to the left all around (Andrew's monotone chain)."""
    order = sorted(range(len(points)), key=lambda i: points[i])

    def half(numbers: list[int]) -> list[int]:
        chain: list[int] = []
        for i in numbers:
            while len(chain) > 1 and _turn(points[chain[-2]], points[chain[-1]], points[i]) <= 0:
                chain.pop()
            chain.append(i)
        return chain[:-1]

    return half(order) + half(order[::-1])


def cable(profile: list[tuple[float, float]], fixed: tuple[float, float], turned: float) -> Wrapped:
    """A cable to a fixed point when the profile is turned by so much [rad]."""
    c, s = np.cos(turned), np.sin(turned)
    x, y = fixed
    end = (float(c * x + s * y), float(c * y - s * x))  # in the profile's axes
    corners = hull([*profile, end])
    here, start = corners.index(len(profile)), corners.index(0)
    left = _area(profile) > 0
    around = corners if left else corners[::-1]
    here, start = around.index(len(profile)), around.index(0)
    way = [around[(start + i) % len(around)] for i in range((here - start) % len(around) + 1)]
    places = np.array([*profile, end])[way]
    last, touch = places[-1], places[-2]
    along = (last - touch) / np.hypot(*(last - touch))
    lever = touch[0] * along[1] - touch[1] * along[0]
    return Wrapped(float(np.hypot(*np.diff(places, axis=0).T).sum()), float(lever), way[-2])


def roller(profile: list[tuple[float, float]], radius: float, direction: float, offset: float, turned: float) -> float:
    """How far from the axis the centre of a roller is along its line [m]."""
    angle = direction - turned
    u, m = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    P = np.array(profile)
    s, e = P @ u, P @ m - offset
    found = []
    near = np.abs(e) <= radius
    found += (s[near] + np.sqrt(radius**2 - e[near] ** 2)).tolist()  # on a corner
    for i in range(len(P) - 1):  # on a side
        d = np.array([s[i + 1] - s[i], e[i + 1] - e[i]])
        size = np.hypot(*d)
        for side in (1.0, -1.0):
            n = side * np.array([-d[1], d[0]]) / size
            if n[0] <= 0:
                continue
            # the centre (x, 0): its foot on the side is (x, 0) - radius n
            if abs(d[1]) < 1e-15:
                continue
            t = (-radius * n[1] - e[i]) / d[1]
            if 0 <= t <= 1:
                found.append(s[i] + t * d[0] + radius * n[0])
    return max(found)


def spring(law: dict[str, Any], drawn: float) -> tuple[float, float, float]:
    """Length [m], force [N] and energy [J] of the spring of a file, which is so long where it pulls, and so short where
    it pushes."""
    if law["kind"] == "gas":
        slope = (law["force_shortest"] - law["force"]) / (law["longest"] - law["shortest"])
        force = law["force"] + slope * (law["longest"] + drawn)
        return -drawn, force, force**2 / (2 * slope)
    if law["kind"] == "compression":
        force = law["stiffness"] * (law["free_length"] + drawn)
        return -drawn, force, force**2 / (2 * law["stiffness"])
    free = law["body_length"] if law["kind"] == "extension" else law["free_length"]
    force = law.get("initial_tension", 0.0) + law["stiffness"] * (drawn - free)
    return drawn, force, force**2 / (2 * law["stiffness"])


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _area(points: list[tuple[float, float]]) -> float:
    x, y = np.array(points).T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
