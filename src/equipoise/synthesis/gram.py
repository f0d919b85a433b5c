"""The design problem as one small least-squares problem: the Gram form.

All torques are linear in the moment matrices M_p = sum k z z' of the body pairs (THEORY section 1), so the mean square
torque over any set of configurations is ``|sum_p <Q_p, N_p> + d|^2 + rest^2`` with N_p the moment matrices in the
regions' own coordinates. Once the configurations are compressed into Q and d, by averaging a Fourier series exactly or
by an orthogonal reduction of samples, their number no longer matters.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans, Complexes, frozen
from ..energy.fourier import gravity_series, spring_series
from ..energy.frames import Frames, NoFourierForm
from ..energy.potential import CHUNK_ENTRIES, Potential
from ..energy.series import Series
from ..errors import InputError
from ..kinematics import Poses, Tree, Velocities, sample
from ..kinematics.sampling import whole_turns
from ..rotation import skew
from .problem import Pair, Problem, Progress

RANK = 1e-12  # singular values below this share of the largest are rounding
_I, _J = np.triu_indices(7)
_COLUMN = np.lexsort((_I, _J))  # columns of the upper triangle, as the cone solver stacks them
TRI_I, TRI_J = _I[_COLUMN], _J[_COLUMN]
TRI_WEIGHT = np.where(TRI_I == TRI_J, 1.0, np.sqrt(2.0))
TRI = len(TRI_I)  # 28


def svec(M: NDArray[Any]) -> NDArray[Any]:
    """Symmetric (..., 7, 7), real or complex, -> (..., 28) with ``svec(A) . svec(B) == trace(A B)``."""
    return M[..., TRI_I, TRI_J] * TRI_WEIGHT


def smat(v: Array) -> Array:
    """The inverse of `svec`."""
    M = np.zeros((*v.shape[:-1], 7, 7))
    M[..., TRI_I, TRI_J] = M[..., TRI_J, TRI_I] = v / TRI_WEIGHT
    return M


@frozen
class Gram:
    """The compressed problem, in units of the unbalanced torque.

    Attributes:
        Q: (pairs, rows, 7, 7), d: (rows,), rest: the root mean square torque over `unbalanced` of springs with moment
            matrices N_p is ``sqrt(|sum_p <Q_p, N_p> + d|^2 + rest^2)``.
        store: (pairs, 7, 7), mean stored energy of the springs ``sum_p <store_p, N_p>`` [J].
        unbalanced: [N m] root mean square torque to be balanced, all joints together.
        averaged: the averages are exact over all configurations, not over samples.
    """

    problem: Problem
    Q: Array
    d: Array
    rest: float
    store: Array
    unbalanced: float
    averaged: bool

    def on(self, chosen: list[int]) -> Gram:
        """The same problem restricted to some of its pairs (by number)."""
        pairs = tuple(self.problem.pairs[i] for i in chosen)
        return replace(self, problem=replace(self.problem, pairs=pairs), Q=self.Q[chosen], store=self.store[chosen])

    @property
    def box(self) -> Booleans:
        """(pairs, 2) whether the region at each end is a box; else it is a ball."""
        regions = self.problem.regions
        return np.array([[regions[name].shape == "box" for name in pair] for pair in self.problem.pairs])

    def enlarged(self, factor: float) -> Gram:
        """The same problem with every region `factor` times as large about its centre."""
        D = np.array([factor] * 3 + [1.0] + [factor] * 3)
        scale = D[:, None] * D
        return replace(self, problem=self.problem.enlarged(factor), Q=self.Q * scale, store=self.store * scale)

    @property
    def useful(self) -> list[int]:
        """The pairs whose springs have any effect: between the ground and a vertical axis there is none."""
        strength = np.linalg.norm(self.Q.reshape(len(self.Q), -1), axis=1)
        return [i for i, s in enumerate(strength) if s > 1e-9 * strength.max(initial=0)]


def build(problem: Problem, progress: Progress | None = None) -> Gram:
    """Compress a problem.

    Exact averages need revolute and spherical joints, unlimited or limited to whole turns; else samples are taken.

    Raises:
        InputError: its loops cannot be closed, its numbers or regions are so large that the torques overflow.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        rows = None if problem.samples is not None else _averages(problem)
        averaged = rows is not None
        R, store = rows or _samples(problem, progress)
        finite = np.isfinite(R**2).all()
    if not finite:
        raise InputError(f"mechanism '{problem.mechanism.name}' has numbers so large that its torques overflow")
    U, S, Vt = np.linalg.svd(R[:, :-1], full_matrices=False)
    rank = int((RANK * S[0] < S).sum()) if len(S) and S[0] > 0 else 0
    d = (U.T @ R[:, -1])[:rank]
    total = float(np.linalg.norm(R[:, -1]))
    rest = np.linalg.norm(R[:, -1] - U[:, :rank] @ d)
    unit = total or 1.0
    Q = smat((S[:rank, None] * Vt[:rank]).reshape(rank, len(problem.pairs), TRI).transpose(1, 0, 2))
    return Gram(problem, Q / unit, d / unit, float(rest) / unit, store, total, averaged)


def _averages(problem: Problem) -> tuple[Array, Array] | None:
    """By Parseval: the mean square of a Fourier series' derivative is the sum of |k_j c_k|^2."""
    mechanism = problem.mechanism
    tree = Tree.of(mechanism)
    try:
        frames = Frames(tree)
        if not whole_turns(tree, frames.denominators):
            return None
        load = Series.sum([gravity_series(frames), *(spring_series(frames, s) for s in mechanism.springs)])
        forms = [_form(frames, problem, pair) for pair in problem.pairs]
    except NoFourierForm:
        return None
    keys, inverse = np.unique(np.concatenate([s.keys for s in (load, *forms)]), axis=0, return_inverse=True)
    inverse = inverse.ravel()
    A: Complexes = np.zeros((len(keys), TRI * len(forms) + 1), complex)
    A[inverse[: len(load)], -1] = load.coef[:, 0, 0]
    at = len(load)
    for p, form in enumerate(forms):
        A[inverse[at : at + len(form)], TRI * p : TRI * (p + 1)] = svec(form.coef)
        at += len(form)
    k = keys[:, : tree.n] / frames.denominators
    constant = ~keys.any(axis=1)
    store = smat(A.real[constant, :-1].reshape(-1, len(forms), TRI).sum(axis=0))
    A *= np.linalg.norm(k * problem.weights, axis=1)[:, None]
    return _triangle(np.vstack([A.real, A.imag])), store


def _form(frames: Frames, problem: Problem, pair: Pair) -> Series:
    """``1/2 Z'Z`` of a pair in the regions' own coordinates."""
    V = frames.stretch(*(frames.tree.index[name] for name in pair))
    lift = Series.constant(problem.lift(pair), frames.tree.n)
    return frames.quadratic({X: v @ lift for X, v in V.items()}).scaled(0.5)


def _samples(problem: Problem, progress: Progress | None) -> tuple[Array, Array]:
    count = problem.count
    width = TRI * len(problem.pairs) + 1
    R, store, done = np.zeros((0, width)), np.zeros((len(problem.pairs), 7, 7)), 0
    for torque, load, energy in torque_rows(problem, sample(Tree.of(problem.mechanism), count, problem.seed)):
        rows = np.concatenate([torque, load[..., None]], axis=-1) * problem.weights[:, None] / np.sqrt(count)
        R = _triangle(np.vstack([R, rows.reshape(-1, width)]))
        store += energy / count
        done += len(torque)
        if progress:
            progress("reducing samples", done / count)
    return R, store


def _triangle(rows: Array) -> Array:
    """The triangular factor: the same Gram matrix in as few rows as there are columns."""
    return np.asarray(np.linalg.qr(rows, mode="r"))


def torque_rows(problem: Problem, q: Array) -> Iterator[tuple[Array, Array, Array]]:
    """Torques at `q` (N, n) as linear functions of the moment matrices, in chunks of configurations.

    Yields:
        (chunk, n, 28 pairs) torque per entry of svec(N), (chunk, n) torque of gravity and present springs
        [N m or N], and (pairs, 7, 7) the sum over the chunk of the stored-energy matrices ``1/2 Z'Z`` [J].
    """
    tree = Tree.of(problem.mechanism)
    load = Potential(problem.mechanism)
    lifts = [problem.lift(pair) for pair in problem.pairs]
    size = max(1, CHUNK_ENTRIES // max(1, tree.n * TRI * len(lifts)))
    for start in range(0, len(q), size):
        chunk = q[start : start + size]
        poses = tree.poses(chunk)
        velocities = tree.velocities(chunk, poses)
        torque = np.empty((len(chunk), tree.n, len(lifts), TRI))
        energy = np.empty((len(lifts), 7, 7))
        for p, (pair, lift) in enumerate(zip(problem.pairs, lifts, strict=True)):
            A, B = (tree.index[name] for name in pair)
            Z, dZ = stretch(poses, velocities, A, B)
            Z, dZ = Z @ lift, dZ @ lift
            half = np.einsum("nia,njib->njab", Z, dZ)
            torque[:, :, p] = svec((half + np.swapaxes(half, -1, -2)) / 2)
            energy[p] = 0.5 * np.einsum("nia,nib->ab", Z, Z)
        yield torque.reshape(len(chunk), tree.n, -1), load(chunk).torque, energy


def stretch(poses: Poses, velocities: Velocities, A: int, B: int) -> tuple[Array, Array]:
    """Z (N, 3, 7) of THEORY section 1 and its derivative (N, n, 3, 7)."""
    Z = np.concatenate([-poses.R[:, A], (poses.p[:, B] - poses.p[:, A])[:, :, None], poses.R[:, B]], axis=2)

    def turned(body: int) -> Array:
        return skew(velocities.w[:, body].transpose(0, 2, 1)) @ poses.R[:, None, body]

    origin = (velocities.v[:, B] - velocities.v[:, A]).transpose(0, 2, 1)[..., None]
    return Z, np.concatenate([-turned(A), origin, turned(B)], axis=3)
