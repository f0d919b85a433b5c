"""A motion as a function of time: positions, rates and accelerations, and points of time to integrate over."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..model.arrays import Array, frozen
from ..model.motion import Motion
from .tree import Tree

POINTS, MOST = 240, 20  # Gauss-Legendre points of a motion, about, and between two rows at most


@frozen
class Course:
    """Where a motion is at some times.

    Attributes:
        time: (N,) [s]; share: (N,) of the mean over the motion.
        q, rate, acceleration: (N, n) [rad or m, per s, per s^2].
    """

    time: Array
    share: Array
    q: Array
    rate: Array
    acceleration: Array


def course(motion: Motion, tree: Tree, time: Array | None = None) -> Course:
    """The motion at given times (N,) [s], or at those over which sums are means over its time.

    Among the latter are the rows themselves, which count nothing. With a `time` the shares are all the same.
    """
    t, values = np.array(motion.time), np.array(motion.values)
    if time is None:
        count = MOST if motion.stops else min(MOST, -(-POINTS // (len(t) - 1)))
        points, weights = np.polynomial.legendre.leggauss(count)
        middle, half = (t[1:] + t[:-1]) / 2, np.diff(t) / 2
        time = np.append((middle[:, None] + half[:, None] * points).ravel(), t)  # an acceleration is largest at a row
        share = np.append((half[:, None] * weights).ravel() / (t[-1] - t[0]), 0 * t)
    else:
        share = np.full(len(time), 1 / len(time))
    run = _stops(t, values) if motion.stops else _spline(t, values, motion.cyclic)
    found = []
    for order in range(3):
        full = np.tile(tree.rest if order == 0 else np.zeros(tree.n), (len(time), 1))
        full[:, [tree.coordinates.index(name) for name in motion.coordinates]] = run(time, order)
        found.append(full)
    return Course(time, share, *found)


Run = Callable[[Array, int], Array]
"""Values (N, columns) at times (N,), or their first or second derivative."""


def _spline(t: Array, values: Array, cyclic: bool) -> Run:
    from scipy.interpolate import CubicSpline  # half a second, and few have motions

    if cyclic:
        values = values.copy()
        values[-1] = values[0]
    run = CubicSpline(t, values, bc_type="periodic" if cyclic and len(t) > 3 else "not-a-knot")
    return lambda time, order: np.asarray(run(time, order))


def _stops(t: Array, values: Array) -> Run:
    """Minimum jerk from each row to the next (Flash and Hogan 1985): rest at both, no acceleration either."""
    shape = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6])

    def run(time: Array, order: int) -> Array:
        piece = np.clip(np.searchsorted(t, time, side="right") - 1, 0, len(t) - 2)
        length = np.diff(t)[piece]
        s = np.clip((time - t[piece]) / length, 0.0, 1.0)
        part = (shape.deriv(order) if order else shape)(s) / length**order
        step = np.diff(values, axis=0)[piece]
        return (values[piece] if order == 0 else 0.0) + step * part[:, None]

    return run
