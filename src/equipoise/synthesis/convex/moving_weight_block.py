"""A counterweight in a motion: its inertia goes with m p p', so its unknowns are the matrix [[m, m p'], [m p, m p p']].

That is the moment matrix of a weight, as N = k y y' is that of a spring, with y = [1; p / radius]: positive
semidefinite, and within the ball on the average (docs/theory.md).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...energy.inertial import point_torque
from ...kinematics.moving import Moving
from ...model.arrays import Array
from .blocks import Cone
from .counterweight_block import SIZE, CounterweightBlock
from .rank_one import factor
from .spring_block import Upper, smat, svec

LIMIT = np.diag([1.0, -1.0, -1.0, -1.0])
"""``y' LIMIT y`` is at least 0 in the ball."""


@dataclass(frozen=True)
class MovingWeightBlock(CounterweightBlock):
    """A mass on `body`, within `radius` [m] of its origin, that a motion has to move.

    The unknowns are svec(N) [kg]; a part is a weight, its shape p / radius.
    """

    @property
    def unknowns(self) -> int:
        return SIZE * (SIZE + 1) // 2

    @property
    def shape(self) -> int:
        return SIZE - 1

    def driven(self, moving: Moving) -> Array:
        body = moving.tree.index[self.body]
        return np.stack([point_torque(moving, body, p) for p in self._ends()], axis=-1) @ self._rows()

    @staticmethod
    def _shapes() -> Array:
        one = np.eye(3)
        return np.vstack([np.zeros(3), one, -one, one + np.roll(one, 1, axis=0)])

    def cones(self) -> Iterable[Cone]:
        yield Cone("semidefinite", np.eye(self.unknowns))
        yield Cone("nonnegative", svec(LIMIT[None]))

    def part(self, u: Array) -> Array:
        upper, y = Upper.of(SIZE), self._y(u)
        return y[:, upper.row] * y[:, upper.column] * upper.weight

    def slopes(self, u: Array) -> Array:
        slopes = Upper.of(SIZE).slopes[:, 1:].reshape(SIZE, -1)
        return (self._y(u) @ slopes).reshape(len(u), self.shape, self.unknowns)

    def weights(self, x: Array, eps: float) -> Array:
        return svec(np.linalg.inv(smat(x) + eps * np.eye(SIZE)))

    def split(self, x: Array, least: float) -> tuple[Array, Array]:
        y = factor(smat(x), LIMIT[None], least).T
        y = y[y[:, 0] ** 2 >= least]
        return y[:, 0] ** 2, y[:, 1:] / y[:, :1]

    def cost(self, energy: Array) -> Array:
        return super().cost(energy)[0] * self.amount

    def enlarged(self, factor: float) -> tuple[MovingWeightBlock, Array]:
        upper, scale = Upper.of(SIZE), np.array([1.0, factor, factor, factor])
        return MovingWeightBlock(self.body, factor * self.radius), scale[upper.row] * scale[upper.column]

    @staticmethod
    def _y(u: Array) -> Array:
        return np.hstack([np.ones((len(u), 1)), u])
