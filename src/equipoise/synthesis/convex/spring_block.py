"""The springs of zero free length between two bodies: their moment matrix is one block of unknowns.

A spring's matrix is ``N = k y y'`` with y = [u_a; 1; u_b], the attachments in the regions' own coordinates; the
matrices of several springs add up. So N >= 0, and the mean of |u|^2 stays within a ball, or that of u_i^2 within a box.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...energy.fourier.frames import Frames
from ...energy.fourier.series import Series
from ...kinematics import Poses, Tree, Velocities
from ...model.arrays import Array, Booleans, vec3
from ...model.elements import Spring
from ...model.mechanism import Mechanism
from ...model.rotation import skew
from ..region import Region, free_directions, project
from .blocks import Block, Cone
from .rank_one import factor

SIDE = 7  # of the moment matrix
ONE = 3  # the entry of y between the ends
ENDS = [0, 1, 2], [4, 5, 6]
_I, _J = np.triu_indices(SIDE)
_COLUMN = np.lexsort((_I, _J))  # columns of the upper triangle, as the cone wants them
ROW, COLUMN = _I[_COLUMN], _J[_COLUMN]
WEIGHT = np.where(ROW == COLUMN, 1.0, np.sqrt(2.0))
_u = np.array([*ENDS[0], *ENDS[1]])[:, None]
_y = np.arange(SIDE)[:, None, None]
SQUARES = np.where((ROW == COLUMN) & (np.arange(SIDE)[:, None] == ROW), 1.0, 0.0)  # (7, 28): picks N_ii
# (7, 6, 28): d svec(y y') / du is linear in y
SMALL = 1e-6  # share of the least amount: of a column that is all end and no spring
SLOPES = WEIGHT * (((_u == ROW) & (_y == COLUMN)) * 1.0 + ((_u == COLUMN) & (_y == ROW)))


def svec(M: NDArray[Any]) -> NDArray[Any]:
    """Symmetric (..., 7, 7), real or complex, -> (..., 28) with ``svec(A) . svec(B) == trace(A B)``."""
    return M[..., ROW, COLUMN] * WEIGHT


def smat(v: Array) -> Array:
    """The inverse of `svec`."""
    M = np.zeros((*v.shape[:-1], SIDE, SIDE))
    M[..., ROW, COLUMN] = M[..., COLUMN, ROW] = v / WEIGHT
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

    @property
    def unknowns(self) -> int:
        return len(ROW)

    @property
    def shape(self) -> int:
        return len(ENDS) * len(ENDS[0])

    @property
    def place(self) -> tuple[str, str]:
        return self.body_a, self.body_b

    @property
    def lift(self) -> Array:
        """(7, 7) maps y to z = [p_a; 1; p_b] in the bodies' coordinates."""
        a, b = self.region_a.lift, self.region_b.lift
        L = np.zeros((SIDE, SIDE))
        L[:4, :4] = a
        L[4:, 4:], L[4:, ONE] = b[:3, :3], b[:3, 3]
        return L

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
        yield Cone("nonnegative", self._limits)

    @property
    def _limits(self) -> Array:
        """(limits, unknowns) what is at least 0 in every region: the square of its size less that of the ends."""
        squares = [
            SQUARES[end].sum(axis=0, keepdims=True) if region.shape == "ball" else SQUARES[end]
            for region, end in zip((self.region_a, self.region_b), ENDS, strict=True)
        ]
        return SQUARES[ONE] - np.vstack(squares)

    def part(self, u: Array) -> Array:
        y = self._y(u)
        return y[:, ROW] * y[:, COLUMN] * WEIGHT

    def slopes(self, u: Array) -> Array:
        return (self._y(u) @ SLOPES.reshape(SIDE, -1)).reshape(len(u), self.shape, self.unknowns)

    def form(self, columns: Array) -> Array:
        return smat(columns)

    def columns(self, form: Array) -> Array:
        return svec(form)

    def acts(self, form: Array, u: Array) -> tuple[Array, Array]:
        """As quadratic forms in y, which are cheaper than their columns."""
        y = self._y(u)[..., None]
        Qy = (form @ y[:, None])[..., 0]
        return (Qy @ y)[..., 0], 2 * Qy[..., [*ENDS[0], *ENDS[1]]]

    def weights(self, x: Array, eps: float) -> Array:
        """Of the logarithm of the determinant, which counts the springs: a matrix of few has few eigenvalues."""
        return svec(np.linalg.inv(smat(x) + eps * np.eye(SIDE)))

    def split(self, x: Array, least: float) -> tuple[Array, Array]:
        y = factor(smat(x), smat(self._limits), least).T
        y = y[y[:, ONE] ** 2 >= least * SMALL]
        return y[:, ONE] ** 2, (y / y[:, [ONE]])[:, [*ENDS[0], *ENDS[1]]]

    def project(self, u: Array) -> Array:
        return project(u.reshape(-1, 2, 3), self._is_box).reshape(u.shape)

    def free(self, u: Array, gradient: Array) -> Array:
        keep = free_directions(u.reshape(-1, 2, 3), gradient.reshape(-1, 2, 3), self._is_box)
        free = np.zeros((len(u), self.shape, self.shape))
        free[:, :3, :3], free[:, 3:, 3:] = keep[:, 0], keep[:, 1]
        return free

    def within(self, u: Array) -> tuple[Array, Array]:
        balls = np.flatnonzero(~self._is_box)
        ends, A = u.reshape(2, 3), np.zeros((2, 2, 3))
        A[balls, balls] = 2 * ends[balls]
        return A[balls].reshape(-1, self.shape), 1 - (ends[balls] ** 2).sum(axis=1)

    def add(self, mechanism: Mechanism, k: float, u: Array) -> Mechanism:
        taken = {spring.name for spring in mechanism.springs}
        name = next(name for i in range(1, len(taken) + 2) if (name := f"spring {i}") not in taken)
        p_a, p_b = vec3(self.region_a.inside(u[:3])), vec3(self.region_b.inside(u[3:]))
        spring = Spring(name, self.body_a, p_a, self.body_b, p_b, k)
        return mechanism.with_springs((*mechanism.springs, spring))

    def enlarged(self, factor: float) -> tuple[SpringBlock, Array]:
        scale = np.where(np.arange(SIDE) == ONE, 1.0, factor)
        larger = replace(self, region_a=self.region_a.times(factor), region_b=self.region_b.times(factor))
        return larger, scale[ROW] * scale[COLUMN]

    @property
    def _is_box(self) -> Booleans:
        return np.array([self.region_a.shape == "box", self.region_b.shape == "box"])

    @staticmethod
    def _y(u: Array) -> Array:
        return between(u.reshape(-1, 2, 3))


def between(ends: Array) -> Array:
    """Two points (..., 2, 3) -> (..., 7) z = [p_a; 1; p_b]."""
    return np.concatenate([ends[..., 0, :], np.ones((*ends.shape[:-2], 1)), ends[..., 1, :]], axis=-1)


def at_ends(z: Array) -> Array:
    """The parts of (..., 7) that belong to the two points (..., 2, 3)."""
    return np.stack([z[..., ENDS[0]], z[..., ENDS[1]]], axis=-2)


def stretch(poses: Poses, velocities: Velocities, A: int, B: int) -> tuple[Array, Array]:
    """Z (N, 3, 7) of THEORY section 1 and its derivative (N, n, 3, 7)."""
    Z = np.concatenate([-poses.R[:, A], (poses.p[:, B] - poses.p[:, A])[:, :, None], poses.R[:, B]], axis=2)

    def turned(body: int) -> Array:
        return skew(velocities.w[:, body].transpose(0, 2, 1)) @ poses.R[:, None, body]

    origin = (velocities.v[:, B] - velocities.v[:, A]).transpose(0, 2, 1)[..., None]
    return Z, np.concatenate([-turned(A), origin, turned(B)], axis=3)
