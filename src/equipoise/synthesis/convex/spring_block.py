"""The springs of zero free length between two bodies: their moment matrix is one block of unknowns.

A spring's matrix is ``N = k y y'`` with y = [u_a; 1; u_b], the attachments in the regions' own coordinates, without
those that a flat region fixes; the matrices of several springs add up. So N >= 0, and the mean of |u|^2 stays within a
ball, or that of u_i^2 within a box; `bound_products` adds what the bounds say together.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache, cached_property
from math import isqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...energy.fourier.frames import Frames
from ...energy.fourier.series import Series
from ...kinematics import Poses, Tree, Velocities
from ...model.arrays import Array, Booleans, Integers, frozen, vec3
from ...model.elements import Spring, Vec3
from ...model.mechanism import Mechanism
from ...model.rotation import skew
from ..region import Region, free_directions, project
from .blocks import Block, Cone
from .bound_products import of_three, of_two, with_balls
from .rank_one import factor

SMALL = 1e-6  # share of the least amount: of a column that is all end and no spring
WHOLE = 7  # entries of z = [p_a; 1; p_b]


@frozen
class Upper:
    """The upper triangle of a symmetric matrix, column by column, as the cone wants it.

    Attributes:
        row, column: (unknowns,) of each entry; weight: what makes the vectors' inner product that of the matrices.
    """

    row: Integers
    column: Integers
    weight: Array

    @staticmethod
    @cache
    def of(side: int) -> Upper:
        """Of a matrix (side, side)."""
        i, j = np.triu_indices(side)
        order = np.lexsort((i, j))
        row, column = i[order], j[order]
        return Upper(row, column, np.where(row == column, 1.0, np.sqrt(2.0)))

    @cached_property
    def slopes(self) -> Array:
        """(side, side, unknowns): d svec(y y') / dy_i is linear in y, the first index; i is the second."""
        side = int(self.row.max()) + 1
        y, i = np.arange(side)[:, None, None], np.arange(side)[:, None]
        return self.weight * (((i == self.row) & (y == self.column)) * 1.0 + ((i == self.column) & (y == self.row)))


def svec(M: NDArray[Any]) -> NDArray[Any]:
    """Symmetric (..., s, s), real or complex, -> (..., s (s + 1) / 2) with ``svec(A) . svec(B) == trace(A B)``."""
    upper = Upper.of(M.shape[-1])
    return M[..., upper.row, upper.column] * upper.weight


def smat(v: Array) -> Array:
    """The inverse of `svec`."""
    side = (isqrt(8 * v.shape[-1] + 1) - 1) // 2
    upper = Upper.of(side)
    M = np.zeros((*v.shape[:-1], side, side))
    M[..., upper.row, upper.column] = M[..., upper.column, upper.row] = v / upper.weight
    return M


@dataclass(frozen=True)
class SpringBlock(Block):
    """Springs from `body_a`, attached in `region_a`, to `body_b`, attached in `region_b`.

    The unknowns are svec(N) [N/m]; a part is a spring of stiffness k, its shape u_a and u_b.
    """

    body_a: str
    body_b: str
    region_a: Region
    region_b: Region

    @cached_property
    def kept(self) -> tuple[int, ...]:
        """Of z = [p_a; 1; p_b] the entries that y has: those that the regions leave free, and the 1."""
        return (*self.region_a.axes, 3, *(4 + axis for axis in self.region_b.axes))

    @cached_property
    def one(self) -> int:
        """The entry of y between the ends."""
        return len(self.region_a.axes)

    @cached_property
    def side(self) -> int:
        """Of the moment matrix."""
        return len(self.kept)

    @property
    def unknowns(self) -> int:
        return self.side * (self.side + 1) // 2

    @property
    def shape(self) -> int:
        return self.side - 1

    @property
    def place(self) -> tuple[str, str]:
        return self.body_a, self.body_b

    @property
    def lift(self) -> Array:
        """(7, side) maps y to z = [p_a; 1; p_b] in the bodies' coordinates."""
        a, b = self.region_a.lift, self.region_b.lift
        L = np.zeros((WHOLE, WHOLE))
        L[:4, :4] = a
        L[4:, 4:], L[4:, 3] = b[:3, :3], b[:3, 3]
        return L[:, self.kept]

    def series(self, frames: Frames) -> Series:
        V = frames.stretch(*(frames.tree.index[name] for name in self.place))
        lift = Series.constant(self.lift, frames.tree.n)
        form = frames.quadratic({X: v @ lift for X, v in V.items()}).scaled(0.5)
        return Series(form.keys, svec(form.coef))

    def sampled(self, tree: Tree, q: Array, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        Z, dZ = stretch(poses, velocities, *(tree.index[name] for name in self.place))
        Z, dZ = Z @ self.lift, dZ @ self.lift
        half = np.einsum("nia,njib->njab", Z, dZ)
        torque = svec((half + np.swapaxes(half, -1, -2)) / 2)
        return torque, svec(0.5 * np.einsum("nia,nib->ab", Z, Z))

    def cones(self) -> Iterable[Cone]:
        yield Cone("semidefinite", np.eye(self.unknowns))
        yield Cone("nonnegative", svec(self._limits))
        balls = [end for end, region in self._ends if region.shape == "ball"]
        limited = [i for end, region in self._ends if region.shape == "box" for i in end]
        products = [*of_two(limited, self.one, self.side), *of_three(limited, self.one, self.side)]
        if products:
            yield Cone("nonnegative", svec(np.stack(products)))
        for ball in balls:
            for rows in with_balls(limited, ball, self.one, self.side):
                yield Cone("second order", svec(rows))

    @property
    def _ends(self) -> tuple[tuple[list[int], Region], tuple[list[int], Region]]:
        """The entries of y of each end, and its region."""
        return (list(range(self.one)), self.region_a), (list(range(self.one + 1, self.side)), self.region_b)

    @cached_property
    def others(self) -> list[int]:
        """The entries of y that are a shape."""
        return [i for i in range(self.side) if i != self.one]

    @cached_property
    def _of_shape(self) -> tuple[tuple[slice, Booleans], tuple[slice, Booleans]]:
        """The coordinates of a shape of each end, and whether it is in a box."""
        is_box = (np.array(region.shape == "box") for _, region in self._ends)
        return tuple(zip((slice(self.one), slice(self.one, None)), is_box, strict=True))  # type: ignore[return-value]

    @cached_property
    def _limits(self) -> Array:
        """(limits, side, side) A: ``y' A y`` is at least 0, the square of a region's size less that of the end."""
        squares = [
            own for end, region in self._ends for own in ([end] if region.shape == "ball" else [[i] for i in end])
        ]
        A = np.zeros((len(squares), self.side, self.side))
        for limit, own in zip(A, squares, strict=True):
            limit[own, own], limit[self.one, self.one] = -1.0, 1.0
        return A

    def part(self, u: Array) -> Array:
        upper, y = Upper.of(self.side), self.ends(u)
        return y[:, upper.row] * y[:, upper.column] * upper.weight

    def slopes(self, u: Array) -> Array:
        slopes = Upper.of(self.side).slopes[:, self.others].reshape(self.side, -1)
        return (self.ends(u) @ slopes).reshape(len(u), self.shape, self.unknowns)

    def form(self, columns: Array) -> Array:
        return smat(columns)

    def columns(self, form: Array) -> Array:
        return svec(form)

    def acts(self, form: Array, u: Array) -> tuple[Array, Array]:
        """As quadratic forms in y, which are cheaper than their columns."""
        y = self.ends(u)[..., None]
        Qy = (form @ y[:, None])[..., 0]
        return (Qy @ y)[..., 0], 2 * Qy[..., self.others]

    def weights(self, x: Array, eps: float) -> Array:
        """Of the logarithm of the determinant, which counts the springs: a matrix of few has few eigenvalues."""
        return svec(np.linalg.inv(smat(x) + eps * np.eye(self.side)))

    def split(self, x: Array, least: float) -> tuple[Array, Array]:
        y = factor(smat(x), self._limits, least).T
        y = y[y[:, self.one] ** 2 >= least * SMALL]
        return y[:, self.one] ** 2, (y / y[:, [self.one]])[:, self.others]

    def project(self, u: Array) -> Array:
        return np.concatenate([project(u[:, own], is_box) for own, is_box in self._of_shape], axis=1)

    def free(self, u: Array, gradient: Array) -> Array:
        free = np.zeros((len(u), self.shape, self.shape))
        for own, is_box in self._of_shape:
            free[:, own, own] = free_directions(u[:, own], gradient[:, own], is_box)
        return free

    def within(self, u: Array) -> tuple[Array, Array]:
        balls = [own for own, is_box in self._of_shape if not is_box]
        A = np.zeros((len(balls), self.shape))
        for row, own in zip(A, balls, strict=True):
            row[own] = 2 * u[own]
        return A, np.array([1 - (u[own] ** 2).sum() for own in balls])

    def attachments(self, u: Array) -> tuple[Vec3, Vec3]:
        """[m] The ends of a part of shape u (shape,) in their bodies' frames, not outside their regions by rounding."""
        ends = np.zeros(WHOLE)
        ends[list(self.kept)] = self.ends(u[None])[0]
        return vec3(self.region_a.inside(ends[:3])), vec3(self.region_b.inside(ends[4:]))

    def add(self, mechanism: Mechanism, k: float, u: Array) -> Mechanism:
        taken = {spring.name for spring in mechanism.springs}
        name = next(name for i in range(1, len(taken) + 2) if (name := f"spring {i}") not in taken)
        p_a, p_b = self.attachments(u)
        spring = Spring(name, self.body_a, p_a, self.body_b, p_b, k)
        return mechanism.with_springs((*mechanism.springs, spring))

    def enlarged(self, factor: float) -> tuple[SpringBlock, Array]:
        scale, upper = np.full(self.side, factor), Upper.of(self.side)
        scale[self.one] = 1.0
        larger = replace(self, region_a=self.region_a.times(factor), region_b=self.region_b.times(factor))
        return larger, scale[upper.row] * scale[upper.column]

    def ends(self, u: Array) -> Array:
        """(N, side) y = [u_a; 1; u_b] of parts with shapes u (N, shape)."""
        return np.concatenate([u[:, : self.one], np.ones((len(u), 1)), u[:, self.one :]], axis=1)


def between(ends: Array) -> Array:
    """Two points (..., 2, 3) -> (..., 7) z = [p_a; 1; p_b]."""
    return np.concatenate([ends[..., 0, :], np.ones((*ends.shape[:-2], 1)), ends[..., 1, :]], axis=-1)


def at_ends(z: Array) -> Array:
    """The parts of (..., 7) that belong to the two points (..., 2, 3)."""
    return np.stack([z[..., :3], z[..., 4:]], axis=-2)


def stretch(poses: Poses, velocities: Velocities, A: int, B: int) -> tuple[Array, Array]:
    """Z (N, 3, 7) of docs/theory.md, section 1 and its derivative (N, n, 3, 7)."""
    Z = np.concatenate([-poses.R[:, A], (poses.p[:, B] - poses.p[:, A])[:, :, None], poses.R[:, B]], axis=2)

    def turned(body: int) -> Array:
        return skew(velocities.w[:, body].transpose(0, 2, 1)) @ poses.R[:, None, body]

    origin = (velocities.v[:, B] - velocities.v[:, A]).transpose(0, 2, 1)[..., None]
    return Z, np.concatenate([-turned(A), origin, turned(B)], axis=3)
