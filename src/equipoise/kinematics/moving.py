"""Bodies in motion: their velocities and accelerations where the coordinates have rates and accelerations."""

from __future__ import annotations

import numpy as np

from ..model.arrays import Array, frozen
from .tree import Poses, Tree, Velocities

STEP = 1e-3  # [rad or m] of the differences along the motion


@frozen
class Moving:
    """A mechanism at configurations that it passes.

    Attributes:
        q, rate, acceleration: (N, n) of the independent coordinates [rad or m, per s, per s^2].
        poses, velocities: there; the latter per unit rate of each coordinate.
        turn, spin: (N, bodies, 3) angular velocity and acceleration of each body in the world [rad/s, rad/s^2].
        lift: (N, bodies, 3) acceleration of each body's origin [m/s^2].
    """

    tree: Tree
    q: Array
    rate: Array
    acceleration: Array
    poses: Poses
    velocities: Velocities
    turn: Array
    spin: Array
    lift: Array

    @staticmethod
    def of(tree: Tree, q: Array, rate: Array, acceleration: Array) -> Moving:
        """At configurations (N, n) with rates and accelerations (N, n).

        What the bodies' velocities per unit rate change by is a difference of order four along the motion, which is
        good to 1e-11 and the same for trees and loops.
        """
        poses = tree.poses(q)
        velocities = tree.velocities(q, poses)
        step = STEP / np.maximum(np.abs(rate).max(axis=1, initial=0.0), 1e-12)[:, None]

        def along(times: float) -> tuple[Array, Array]:
            there = q + times * step * rate
            own = tree.velocities(there, tree.poses(there))
            return _rate(own.w, rate), _rate(own.v, rate)

        (w1, v1), (w_1, v_1), (w2, v2), (w_2, v_2) = (along(times) for times in (1, -1, 2, -2))
        change = [
            (8 * (one - other) - (far - back)) / (12 * step[:, :, None])
            for one, other, far, back in ((w1, w_1, w2, w_2), (v1, v_1, v2, v_2))
        ]
        spin, lift = _rate(velocities.w, acceleration) + change[0], _rate(velocities.v, acceleration) + change[1]
        return Moving(tree, q, rate, acceleration, poses, velocities, _rate(velocities.w, rate), spin, lift)

    def point(self, body: int, p: Array) -> Array:
        """Acceleration (N, 3) of the point `p` (3,) fixed in `body` [m/s^2]."""
        arm = self.poses.R[:, body] @ p
        turn = self.turn[:, body]
        return self.lift[:, body] + np.cross(self.spin[:, body], arm) + np.cross(turn, np.cross(turn, arm))


def _rate(each: Array, rate: Array) -> Array:
    """(N, bodies, 3, n) per unit rate and rates (N, n) -> (N, bodies, 3)."""
    return np.einsum("nbij,nj->nbi", each, rate)
