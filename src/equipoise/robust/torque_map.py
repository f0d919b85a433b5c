"""The residual torque of many builds at fixed poses, exactly and fast.

Orientations do not depend on lengths, so every point is an affine function of what scatters, with matrices that only
the pose decides. The torque is then linear in products of the build's own numbers: k c c' of each spring, m c of each
mass (docs/theory.md, section 1). The poses are compressed once; a build costs one small matrix product.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..energy.evaluate import Potential
from ..kinematics import Poses, Tree, Velocities
from ..model.arrays import Array, frozen
from ..model.elements import lines
from ..model.mechanism import Mechanism
from ..model.rotation import skew
from .scatter import Scatter, ScatteredValue, ScatterModel

RANK = 1e-11  # singular values below this share of the largest do nothing
STEP = 1e-30  # of the complex step: what it differentiates are polynomials and square roots
Numbers: TypeAlias = NDArray[Any]  # real, or complex for a derivative


@frozen
class Affine:
    """Coefficients ``c = start + x E'`` (builds, m) of pose-dependent columns: [an origin; a rotation each]."""

    start: Array
    E: Array

    def __call__(self, x: Numbers) -> Numbers:
        return self.start + x @ self.E.T


@frozen
class Soft:
    """What a free length takes away, ``k L0 (dL^2/dq / 2) / L``: `length` (r, N), `rate` (r, n N), `W` (F, r)."""

    free: float
    length: Array
    rate: Array
    W: Array


class TorqueMap:
    """Torque at poses `q` (N, n) as a function of the builds' deviations.

    Attributes:
        parameters: what scatters.
        nominal: (n N,) torque of the drawing, coordinate by coordinate [N m or N].
    """

    def __init__(self, mechanism: Mechanism, q: Array, scatter: Scatter) -> None:
        tree = Tree.of(mechanism)
        self.drawing = ScatterModel(mechanism, scatter)
        self.parameters: tuple[ScatteredValue, ...] = tuple(self.drawing.parameters)
        self.deviation = np.array([p.deviation for p in self.parameters])
        self.stiffness = np.array([s.stiffness for s in lines(mechanism, "tolerance")])
        self.nominal = Potential(mechanism)(q).torque.T.ravel()
        self._tree = tree
        self._path = _paths(tree)
        poses = tree.poses(q)
        columns = _Columns(poses, tree.velocities(q, poses))
        self._springs: list[Affine] = []
        self._soft: list[Soft | None] = []
        blocks = [self._gravity(columns, np.array(mechanism.gravity))]
        for i, spring in enumerate(lines(mechanism, "tolerance")):
            A, B = tree.index[spring.body_a], tree.index[spring.body_b]
            bodies, affine = self._stretch(A, B, np.array(spring.p_a), np.array(spring.p_b), self.drawing.ends[i])
            rate, length = columns.squared(A, B, bodies)
            self._springs.append(affine)
            self._soft.append(_soft(spring.free_length, length, rate) if spring.free_length else None)
            blocks.append(rate)
        U, S, Vt = np.linalg.svd(np.concatenate(blocks, axis=1), full_matrices=False)
        rank = int((RANK * S[0] < S).sum()) if len(S) else 0
        self._A = U[:, :rank] * S[:rank]
        self._A_single = self._A.astype(np.float32)
        self._W = np.split(Vt[:rank].T, np.cumsum([b.shape[1] for b in blocks])[:-1])
        self._start = self._features(np.zeros((1, len(self.parameters))))

    def __call__(self, x: Numbers) -> Numbers:
        """(n N, builds) torque of builds whose parameters are off by `x` (builds, parameters) [SI]."""
        features = (self._features(x) - self._start).T
        if np.iscomplexobj(x):
            return self._softened(x, self.nominal[:, None] + self._A @ features)
        # the difference from the drawing in single precision: 1e-7 of the scatter, at twice the speed
        torque = self._A_single @ features.astype(np.float32)
        torque += self.nominal[:, None].astype(np.float32)
        return self._softened(x, torque)

    def jacobian(self) -> Array:
        """(n N, parameters) change of the torque per standard deviation of each parameter."""
        return np.imag(self(1j * STEP * np.diag(self.deviation))) / STEP

    def _features(self, x: Numbers) -> Numbers:
        """(builds, rank) of gravity and springs as if they all had zero free length."""
        total = self._weights(x) @ self._W[0]
        for i, W in enumerate(self._W[1:]):
            total = total + self._rate(i, x)[:, None] * (_products(self._springs[i](x)) @ W)
        return total

    def _softened(self, x: Numbers, torque: Numbers) -> Numbers:
        """With what the free lengths take away, less what they take away in the drawing, which `nominal` holds."""
        for i, soft in enumerate(self._soft):
            if soft is not None:
                zero = np.zeros((1, len(self.parameters)))
                torque = torque - self._pull(i, soft, x) + self._pull(i, soft, zero).astype(torque.dtype)
        return torque

    def _pull(self, i: int, soft: Soft, x: Numbers) -> Numbers:
        y = (_products(self._springs[i](x)) @ soft.W).T
        length = np.sqrt(soft.length.T @ y)
        share = np.divide(self._rate(i, x) * soft.free, length, out=np.zeros_like(length), where=length != 0)
        rate = (soft.rate.T @ y).reshape(-1, *length.shape)
        return (share * rate).reshape(-1, len(x))

    def _rate(self, i: int, x: Numbers) -> Numbers:
        number = self.drawing.stiffness[i]
        return self.stiffness[i] * (1 + (x[:, number] if number is not None else np.zeros(len(x))))

    def _weights(self, x: Numbers) -> Numbers:
        """(builds, 4 bodies) mass, and mass times place, in the frame of every body."""
        total = np.zeros((len(x), 4 * len(self._tree.names)), x.dtype)
        for lump in self.drawing.lumps:
            mass = lump.mass * (1 + (x[:, lump.relative] if lump.relative is not None else np.zeros(len(x))))
            total[:, lump.body] += mass
            for body, p, numbers in [(lump.body, lump.point, lump.place), *self._shifts(lump.body)]:
                at = len(self._tree.names) + 3 * body
                total[:, at : at + 3] += mass[:, None] * (p + (x[:, list(numbers)] if numbers else 0.0))
        return total

    def _shifts(self, body: int) -> list[tuple[int, float, tuple[int, ...]]]:
        """The joints that carry a body, as (body in whose frame they are placed, 0, parameters)."""
        offsets = self.drawing.offsets
        return [(parent, 0.0, offsets[child]) for child, parent in self._path[body] if offsets.get(child)]

    def _gravity(self, columns: _Columns, g: Array) -> Array:
        bodies = range(len(self._tree.names))
        origin = np.stack([-(columns.v[:, :, b] @ g).T.ravel() for b in bodies], axis=1)
        turned = [-np.einsum("i,njia->jna", g, columns.dR(b)).reshape(-1, 3) for b in bodies]
        return np.concatenate([origin, *turned], axis=1)

    def _stretch(self, A: int, B: int, p_a: Array, p_b: Array, ends: Any) -> tuple[list[int], Affine]:
        """The bodies whose rotations a stretch is made of, and its coefficients."""
        common = set(self._path[A]) & set(self._path[B])
        terms = [(A, -1.0, p_a, ends[0]), (B, 1.0, p_b, ends[1])]
        for end, sign in ((A, -1.0), (B, 1.0)):
            chain = [step for step in self._path[end] if step not in common]
            terms += [(parent, sign, np.zeros(3), self.drawing.offsets.get(child, ())) for child, parent in chain]
        bodies = list(dict.fromkeys(body for body, _, p, numbers in terms if numbers or p.any()))
        start, E = np.zeros(1 + 3 * len(bodies)), np.zeros((1 + 3 * len(bodies), len(self.parameters)))
        start[0] = 1.0
        for body, sign, p, numbers in terms:
            if body in bodies:
                at = 1 + 3 * bodies.index(body)
                start[at : at + 3] += sign * p
                for row, number in enumerate(numbers):
                    E[at + row, number] += sign
        return bodies, Affine(start, E)


class _Columns:
    """Rotations and origins of all bodies with their derivatives by each coordinate."""

    def __init__(self, poses: Poses, velocities: Velocities) -> None:
        self.poses = poses
        self.w = velocities.w.transpose(0, 3, 1, 2)  # (N, n, bodies, 3)
        self.v = velocities.v.transpose(0, 3, 1, 2)

    def dR(self, body: int) -> Array:
        """(N, n, 3, 3)."""
        return skew(self.w[:, :, body]) @ self.poses.R[:, None, body]

    def squared(self, A: int, B: int, bodies: list[int]) -> tuple[Array, Array]:
        """Rows for ``dL^2/dq / 2`` (n N, F) and ``L^2`` (N, F), F products of the coefficients."""
        p, R = self.poses.p, self.poses.R
        V = np.concatenate([(p[:, B] - p[:, A])[..., None], *(R[:, b] for b in bodies)], axis=2)
        dV = np.concatenate([(self.v[:, :, B] - self.v[:, :, A])[..., None], *(self.dR(b) for b in bodies)], axis=3)
        half = np.einsum("nia,njib->jnab", V, dV)
        half = (half + np.swapaxes(half, -1, -2)) / 2
        i, j = np.triu_indices(V.shape[2])
        weight = np.where(i == j, 1.0, 2.0)
        full = np.einsum("nia,nib->nab", V, V)
        return (half[..., i, j] * weight).reshape(-1, len(i)), full[:, i, j] * weight


def _soft(free: float, length: Array, rate: Array) -> Soft:
    """Both maps in as few numbers as they have."""
    rows = np.concatenate([length, rate])
    _, S, Vt = np.linalg.svd(np.linalg.qr(rows, mode="r"))
    W = Vt[: int((RANK * S[0] < S).sum())].T
    return Soft(free, (length @ W).T, (rate @ W).T, W)


def _products(c: Numbers) -> Numbers:
    i, j = np.triu_indices(c.shape[1])
    return c[:, i] * c[:, j]


def _paths(tree: Tree) -> list[list[tuple[int, int]]]:
    """Of each body, the (body, parent) steps up to the world."""
    found: list[list[tuple[int, int]]] = [[] for _ in tree.names]
    for link in tree.links:
        found[link.body] = [(link.body, link.parent), *found[link.parent]]
    return found
