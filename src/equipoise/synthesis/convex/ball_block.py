"""A block whose parts are one amount times a point of a ball: [1, u], with u in the unit ball."""

from __future__ import annotations

import numpy as np

from ...model.arrays import Array
from ..region import free_directions, project
from .blocks import Block

BALL = np.array(False)  # no box


class BallBlock(Block):
    """Unknowns [k, k u]: the first is the amount, the others are the shape times it, which is in the unit ball."""

    def part(self, u: Array) -> Array:
        return np.hstack([np.ones((len(u), 1)), u])

    def slopes(self, u: Array) -> Array:
        return np.tile(np.eye(self.unknowns)[1:], (len(u), 1, 1))

    def project(self, u: Array) -> Array:
        return project(u, BALL)

    def free(self, u: Array, gradient: Array) -> Array:
        return free_directions(u, gradient, BALL)

    def within(self, u: Array) -> tuple[Array, Array]:
        return 2 * u[None], np.array([1 - u @ u])
