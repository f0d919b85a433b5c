"""The smooth curve through points of a plane."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ...arrays import Array, frozen

FINE = 8  # parts between two points


@frozen
class Curve:
    """The smooth curve through points: places, directions, curvature (more than 0 turns left) and length from the
    first one, (n, 2), (n, 2), (n,) and (n,)."""

    at: Array
    along: Array
    curvature: Array
    length: Array

    @staticmethod
    def through(points: Sequence[tuple[float, float]]) -> Curve:
        from scipy.interpolate import CubicSpline

        knots = np.array(points, float)
        t = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(knots, axis=0).T))])
        spline = CubicSpline(t, knots)
        fine = np.concatenate([np.linspace(a, b, FINE, endpoint=False) for a, b in pairwise(t)])
        fine = np.append(fine, t[-1])
        first, second = spline(fine, 1), spline(fine, 2)
        speed = np.hypot(*first.T)
        middle = np.hypot(*spline((fine[1:] + fine[:-1]) / 2, 1).T)
        steps = np.diff(fine) * (speed[1:] + 4 * middle + speed[:-1]) / 6  # Simpson
        curvature = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / speed**3
        return Curve(spline(fine), first / speed[:, None], curvature, np.concatenate([[0.0], np.cumsum(steps)]))
