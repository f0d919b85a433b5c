"""The profile that gives a wanted energy with a spring: the envelope of the lines that the cable runs along.

A spring whose force goes with its travel, ``F = F0 + k u``, has done ``F^2 = F0^2 + 2 k U`` of work U. So the force at
each angle is known, and the cable's lever about the axis is ``h = -U' / F``: its line passes the axis at that distance
and runs to the fixed point at the distance a. In the axes of the profile these lines turn; the profile is their
envelope. With ``g = sqrt(a^2 - h^2)``, slopes by the angle that the profile is turned:

    direction of the line's normal    theta = alpha - acos(h / a) - angle,    theta' = (h' - g) / g
    where the cable leaves            h n + h' g / (h' - g) n',   n' the direction along the cable
    free length of the cable          g^2 / (g - h')
    radius of curvature               h - (g^3 h'' + h h'^3) / (h' - g)^3

The cable stays ahead of the profile where ``h' < g``, and wraps it where the radius keeps its sign.

A roller that slides on a line, the offset e beside the axis, has its centre at ``s = s0 + u``, ``s' = U' / F``. In the
profile's axes its centre draws the pitch curve, and the profile is the parallel curve at the roller's radius. The
pressure leans ``atan((s' + e) / s)`` off the line.

Source: derived here; the support function of a convex curve is classical. The same idea for springs of zero free
length and for computing pulleys by points is in the literature on gravity compensation with noncircular pulleys.
"""

from __future__ import annotations

import numpy as np

from ...model.arrays import Array, frozen
from .wanted import Wanted


@frozen
class Drive:
    """Springs on a wanted energy: C of them at m angles that the profile is turned by.

    Attributes:
        angle: (m,) [rad]; force: (C, m) [N]; travel: from where it begins (C, m) [m].
        h, dh, ddh: the lever and its slopes (C, m) [m/rad^n].
    """

    angle: Array
    force: Array
    travel: Array
    h: Array
    dh: Array
    ddh: Array


def drive(wanted: Wanted, turn: float, F0: Array, k: Array, angles: Array) -> Drive:
    """What springs of preload F0 (C,) [N] and rate k (C,) [N/m] do.

    Args:
        turn: 1 where the profile turns with the joint's angle, -1 against it.
        angles: (m,) of the joint.
    """
    U, d1 = wanted.energy(angles), turn * wanted.torque(angles)
    d2, d3 = wanted.torque.deriv()(angles), turn * wanted.torque.deriv(2)(angles)
    k, F0 = k[:, None], F0[:, None]
    F = np.sqrt(F0**2 + 2 * k * np.maximum(U, 0.0))
    dF = k * d1 / F
    ddF = k * d2 / F - dF**2 / F
    h = -d1 / F
    dh = -d2 / F + d1 * dF / F**2
    ddh = -d3 / F + 2 * d2 * dF / F**2 + d1 * ddF / F**2 - 2 * d1 * dF**2 / F**3
    return Drive(turn * angles, F, (F - F0) / k, h, dh, ddh)


@frozen
class Envelope:
    """Profiles (C, m) as far as they do not depend on where the fixed point or the roller's line are around the axis.

    Attributes:
        ahead, aside: a profile's point in the axes of what runs on it [m]: along the cable and off it, to the right of
            its direction; or along the roller's line and to the left of it.
        radius: of curvature, more than 0 where the cable wraps, or where the profile bulges to the roller [m].
        free: of the cable, or from the axis to the roller's centre along its line [m]; not a number where none is.
        lean: of a roller's pressure [rad], 0 of a cable.
        turn: (C, m) slope by which the line turns in the profile's axes.
    """

    ahead: Array
    aside: Array
    radius: Array
    free: Array
    lean: Array
    turn: Array

    @property
    def reach(self) -> Array:
        """(C, m) from the axis to the profile [m]."""
        return np.hypot(self.ahead, self.aside)


def of_cable(d: Drive, a: Array) -> Envelope:
    """Pulleys whose cable runs to a point at the distance a (C,) [m] from the axis."""
    h, dh = d.h, d.dh
    with np.errstate(invalid="ignore", divide="ignore"):
        g = np.sqrt(a[:, None] ** 2 - h**2)
        behind = dh - g
        radius = h - (g**3 * d.ddh + h * dh**3) / behind**3
        free = np.where(behind < 0, -(g**2) / behind, np.nan)
        radius = np.sign(np.median(radius, axis=1))[:, None] * radius
        return Envelope(dh * g / behind, h, radius, free, np.zeros_like(h), behind / g)


def of_roller(d: Drive, s0: Array, r: float, e: float) -> Envelope:
    """Cams under a roller of radius r and offset e [m], whose centre begins at s0 (C,) [m]."""
    s, ds, dds = s0[:, None] + d.travel, -d.h, -d.dh
    w = np.hypot(ds + e, s)
    bend = (s * (dds - s) - (ds + e) * (2 * ds + e)) / w**3  # of the pitch curve, to the left; clockwise if convex
    with np.errstate(divide="ignore"):
        radius = -1 / bend
    free = np.where(s > 0, s, np.nan)
    return Envelope(s * (1 - r / w), e - r * (ds + e) / w, radius - r, free, np.arctan2(ds + e, s), -np.ones_like(s))


def drawn(d: Drive, e: Envelope, a: float, bearing: float, roller: bool) -> tuple[Array, Array]:
    """Points (m, 2) of one profile in its own axes [m], and unit vectors (m, 2) along it.

    Along a cable's profile they are the way that the cable leaves it.

    Args:
        a, bearing: of the fixed point from the axis [m], [rad]; of a roller `bearing` is the direction of its line.
    """
    ahead, aside = e.ahead[0], e.aside[0]
    if roller:
        u = _unit(bearing - d.angle)
        left = np.stack([-u[:, 1], u[:, 0]], axis=1)
        points = ahead[:, None] * u + aside[:, None] * left
        way = np.tan(e.lean[0])[:, None] * u - left
        return points, way / np.hypot(*way.T)[:, None]
    normal = _unit(bearing - np.arccos(d.h[0] / a) - d.angle)
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    return aside[:, None] * normal + ahead[:, None] * along, along


def _unit(angle: Array) -> Array:
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)
