"""Blocks of unknowns: what the convex program may choose, one class in one file for each kind of element.

Every torque is linear in the unknowns x of the blocks, and each block's x lies in a cone. The cone is spanned by
*parts*, single elements that can be built: a part is an amount k >= 0 times `Block.part` of its shape u, a point of
[-1, 1]^shape. The program bounds what any number of parts can do; its optimum is split into few of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

from ...energy.fourier.frames import Frames
from ...energy.fourier.series import Series
from ...kinematics import Poses, Tree, Velocities
from ...kinematics.moving import Moving
from ...model.arrays import Array, frozen
from ...model.errors import InputError
from ...model.mechanism import Mechanism
from ..region import RIM

FITTED = 5  # steps that fit a shape to unknowns; one does where parts are linear in their shape


@frozen
class Cone:
    """``F x + g`` lies in a cone: F (rows, unknowns), g (rows,), zero when None.

    Second order: the first row is at least the norm of the others. Semidefinite: the rows are the upper triangle of a
    symmetric matrix, column by column, with what is off the diagonal times the square root of two.
    """

    kind: Literal["zero", "nonnegative", "second order", "semidefinite"]
    F: Array
    g: Array | None = None


class Block(ABC):
    """The unknowns of one place: two bodies, or a joint.

    Attributes:
        weighs: whether they have weight, so that what they do depends on gravity.
    """

    weighs: ClassVar[bool] = False

    @property
    @abstractmethod
    def unknowns(self) -> int:
        """How many there are."""

    @property
    @abstractmethod
    def shape(self) -> int:
        """How many coordinates the shape of a part has."""

    @property
    @abstractmethod
    def place(self) -> tuple[str, ...]:
        """The names of the bodies or joints that it acts between."""

    @abstractmethod
    def series(self, frames: Frames) -> Series:
        """The energy for each unknown: coefficients (T, unknowns) [J], each term once.

        Raises:
            NoFourierForm: it has none; then samples are taken.
        """

    @abstractmethod
    def sampled(self, tree: Tree, q: Array, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        """At configurations q (N, n): torque (N, n, unknowns) [N m or N], and energy summed over q (unknowns,) [J]."""

    def driven(self, moving: Moving) -> Array:
        """In a motion: the torque (N, n, unknowns) that moves the masses of the unknowns [N m or N].

        Raises:
            InputError: they have weight, and what moves it is not known.
        """
        if self.weighs:
            raise InputError(
                f"a motion does not go with the weights on {', '.join(self.place)}: their inertia is not known"
            )
        return np.zeros((*moving.q.shape, self.unknowns))

    @abstractmethod
    def cones(self) -> Iterable[Cone]:
        """Where the unknowns lie."""

    @abstractmethod
    def part(self, u: Array) -> Array:
        """(N, unknowns) of one unit of a part with shape u (N, shape)."""

    @abstractmethod
    def slopes(self, u: Array) -> Array:
        """(N, shape, unknowns) derivative of `part`."""

    def form(self, columns: Array) -> Array:
        """(rows, unknowns) -> (rows, ...): what unknowns do, as `acts` wants it; linear."""
        return columns

    def columns(self, form: Array) -> Array:
        """The inverse of `form`."""
        return form

    def acts(self, form: Array, u: Array) -> tuple[Array, Array]:
        """(N, rows) what one unit of a part with shape u (N, shape) does, and (N, rows, shape) its derivative."""
        return self.part(u) @ form.T, np.swapaxes(self.slopes(u) @ form.T, 1, 2)

    @abstractmethod
    def add(self, mechanism: Mechanism, k: float, u: Array) -> Mechanism:
        """The mechanism with `k` units of a part of shape u (shape,)."""

    @cached_property
    def amount(self) -> Array:
        """(unknowns,) the linear form that is 1 for one unit of a part, whatever its shape."""
        u = np.vstack([np.zeros(self.shape), np.eye(self.shape), -np.eye(self.shape)])
        return np.asarray(np.linalg.lstsq(self.part(u), np.ones(len(u)), rcond=None)[0], float)

    def weights(self, x: Array, eps: float) -> Array:
        """(unknowns,) the slope at x of a concave count of its parts: of the logarithm of the amount plus eps."""
        return self.amount / (self.amount @ x + eps)

    def split(self, x: Array, least: float) -> tuple[Array, Array]:
        """The few parts that add up to about x: amounts (n,) and shapes (n, shape), without amounts below `least`.

        One where a block does not know better, fitted to x by Gauss-Newton steps.
        """
        k, u = float(self.amount @ x), np.zeros((1, self.shape))
        if k < least:
            return np.zeros(0), u[:0]
        for _ in range(FITTED):
            off = self.part(u)[0] - x / k
            u = self.project(u - np.linalg.lstsq(self.slopes(u)[0].T, off, rcond=None)[0])
        return np.array([k]), u

    def project(self, u: Array) -> Array:
        """The nearest possible shapes, u (N, shape)."""
        return np.clip(u, -1, 1)

    def free(self, u: Array, gradient: Array) -> Array:
        """(N, shape, shape) projectors onto the steps that lead to possible shapes, downhill of `gradient`."""
        return np.where((np.abs(u) >= RIM) & (gradient * u < 0), 0.0, 1.0)[..., None] * np.eye(self.shape)

    def within(self, u: Array) -> tuple[Array, Array]:
        """(rows, shape) A and (rows,) b of one shape u (shape,): a step s with ``A s <= b`` stays possible, nearly.

        Beside -1 <= u + s <= 1, and to first order in s.
        """
        return np.zeros((0, self.shape)), np.zeros(0)

    def cost(self, energy: Array) -> Array:
        """(unknowns,) [J] what equal designs should have little of, given the mean energy (unknowns,) [J]."""
        return energy

    def enlarged(self, factor: float) -> tuple[Block, Array]:
        """The block with regions so much larger, and what that multiplies each unknown's columns by (unknowns,)."""
        return self, np.ones(self.unknowns)
