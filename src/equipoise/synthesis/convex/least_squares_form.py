"""The design problem as one small least-squares problem: the Gram form.

All torques are linear in the unknowns x of the blocks, so the mean square torque over any set of configurations is
``|sum_b columns_b x_b + d|^2 + rest^2``. Once the configurations are compressed into columns and d, by averaging a
Fourier series exactly or by an orthogonal reduction of samples, their number no longer matters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ...energy.evaluate import Potential
from ...energy.fourier.energy import gravity_series
from ...energy.fourier.frames import Frames
from ...energy.fourier.series import Series
from ...energy.reference import CHUNK_ENTRIES
from ...kinematics import Tree, sample
from ...kinematics.sampling import whole_turns
from ...model.arrays import Array, Complexes
from ...model.errors import InputError, NoFourierForm
from ...model.progress import Progress
from ..problem import Problem
from .blocks import Block

RANK = 1e-12  # singular values below this share of the largest are rounding


@dataclass(frozen=True)
class Gram:
    """The compressed problem, in units of the unbalanced torque.

    Attributes:
        blocks: the unknowns; columns: for each (rows, unknowns), d: (rows,), rest: the root mean square torque over
            `unbalanced` at unknowns x_b is ``sqrt(|sum_b columns_b x_b + d|^2 + rest^2)``.
        cost: for each block (unknowns,) [J], what equal designs should have little of: their stored energy, as a rule.
        unbalanced: [N m] root mean square torque to be balanced, all joints together.
        averaged: the averages are exact over all configurations, not over samples.
    """

    problem: Problem
    blocks: tuple[Block, ...]
    columns: tuple[Array, ...]
    d: Array
    rest: float
    cost: tuple[Array, ...]
    unbalanced: float
    averaged: bool

    def on(self, chosen: Sequence[int]) -> Gram:
        """The same problem restricted to some of its blocks (by number)."""
        parts = {name: tuple(getattr(self, name)[i] for i in chosen) for name in ("blocks", "columns", "cost")}
        return replace(self, **parts)

    def times(self, x: Sequence[Array]) -> Array:
        """(rows,) ``sum_b columns_b x_b``: what the unknowns x do."""
        return sum((columns @ own for columns, own in zip(self.columns, x, strict=True)), np.zeros(len(self.d)))

    def enlarged(self, factor: float) -> Gram:
        """The same problem with every region `factor` times as large about its centre."""
        larger = [block.enlarged(factor) for block in self.blocks]
        columns = tuple(own * scale for own, (_, scale) in zip(self.columns, larger, strict=True))
        cost = tuple(own * scale for own, (_, scale) in zip(self.cost, larger, strict=True))
        return replace(self, blocks=tuple(block for block, _ in larger), columns=columns, cost=cost)

    @property
    def useful(self) -> list[int]:
        """The blocks that have any effect: springs between the ground and a vertical axis have none."""
        strength = [float(np.linalg.norm(columns)) for columns in self.columns]
        return [i for i, s in enumerate(strength) if s > 1e-9 * max(strength, default=0.0)]


def build(problem: Problem, progress: Progress | None = None) -> Gram:
    """Compress a problem.

    Exact averages need revolute and spherical joints, unlimited or limited to whole turns; else samples are taken.

    Raises:
        InputError: its loops cannot be closed, its numbers or regions are so large that the torques overflow.
    """
    blocks = problem.blocks
    with np.errstate(over="ignore", invalid="ignore"):
        rows = None if problem.samples is not None else _averages(problem, blocks)
        averaged = rows is not None
        R, energy = rows or _samples(problem, blocks, progress)
        finite = np.isfinite(R**2).all()
    if not finite:
        raise InputError(f"mechanism '{problem.mechanism.name}' has numbers so large that its torques overflow")
    U, S, Vt = np.linalg.svd(R[:, :-1], full_matrices=False)
    rank = int((RANK * S[0] < S).sum()) if len(S) and S[0] > 0 else 0
    d = (U.T @ R[:, -1])[:rank]
    total = float(np.linalg.norm(R[:, -1]))
    rest = np.linalg.norm(R[:, -1] - U[:, :rank] @ d)
    unit = total or 1.0
    columns = _split(S[:rank, None] * Vt[:rank] / unit, blocks)
    cost = tuple(block.cost(own) for block, own in zip(blocks, _split(energy, blocks), strict=True))
    return Gram(problem, blocks, columns, d / unit, float(rest) / unit, cost, total, averaged)


def _places(blocks: Sequence[Block]) -> list[slice]:
    """Where each block's unknowns stand among all of them."""
    ends = np.cumsum([0, *(block.unknowns for block in blocks)]).tolist()
    return [slice(start, end) for start, end in pairwise(ends)]


def _split(values: Array, blocks: Sequence[Block]) -> tuple[Array, ...]:
    """(..., all unknowns) -> (..., unknowns) of each block."""
    return tuple(np.ascontiguousarray(values[..., place]) for place in _places(blocks))


def _averages(problem: Problem, blocks: Sequence[Block]) -> tuple[Array, Array] | None:
    """By Parseval: the mean square of a Fourier series' derivative is the sum of |k_j c_k|^2."""
    mechanism = problem.judged
    tree = Tree.of(mechanism)
    try:
        frames = Frames(tree)
        if not whole_turns(tree, frames.denominators):
            return None
        load = Series.sum([gravity_series(frames), *(spring.series(frames) for spring in mechanism.springs)])
        forms = [block.series(frames) for block in blocks]
    except NoFourierForm:
        return None
    every = [*forms, Series(load.keys, load.coef[:, :, 0])]
    keys, inverse = np.unique(np.concatenate([s.keys for s in every]), axis=0, return_inverse=True)
    if keys[:, tree.n :].any():
        return None  # a power of an angle has no average over all turns
    rows = iter(np.split(inverse.ravel(), np.cumsum([len(s) for s in every])[:-1]))
    A: Complexes = np.zeros((len(keys), sum(block.unknowns for block in blocks) + 1), complex)
    for form, place in zip(every, [*_places(blocks), slice(-1, None)], strict=True):
        A[next(rows), place] = form.coef
    energy = A.real[~keys.any(axis=1), :-1].sum(axis=0)
    A *= np.linalg.norm(keys[:, : tree.n] / frames.denominators * problem.scale, axis=1)[:, None]
    return _triangle(np.vstack([A.real, A.imag])), energy


def _samples(problem: Problem, blocks: Sequence[Block], progress: Progress | None) -> tuple[Array, Array]:
    count = problem.count
    width = sum(block.unknowns for block in blocks) + 1
    R, mean, done = np.zeros((0, width)), np.zeros(width - 1), 0
    q = sample(Tree.of(problem.judged), count, problem.seed)
    for torque, load, energy in torque_rows(problem, blocks, q):
        rows = np.concatenate([torque, load[..., None]], axis=-1) * problem.scale[:, None] / np.sqrt(count)
        R = _triangle(np.vstack([R, rows.reshape(-1, width)]))
        mean += energy / count
        done += len(torque)
        if progress:
            progress("reducing samples", done / count)
    return R, mean


def _triangle(rows: Array) -> Array:
    """The triangular factor: the same Gram matrix in as few rows as there are columns."""
    return np.asarray(np.linalg.qr(rows, mode="r"))


def torque_rows(problem: Problem, blocks: Sequence[Block], q: Array) -> Iterator[tuple[Array, Array, Array]]:
    """Torques at `q` (N, n) as linear functions of the unknowns, in chunks of configurations.

    Yields:
        (chunk, n, all unknowns) torque of each unknown, (chunk, n) torque of gravity and present springs [N m or N],
        and (all unknowns,) the sum over the chunk of each unknown's energy [J].
    """
    tree = Tree.of(problem.judged)
    load = Potential(problem.judged)
    places = _places(blocks)
    width = places[-1].stop
    size = max(1, CHUNK_ENTRIES // max(1, tree.n * width))
    for start in range(0, len(q), size):
        chunk = q[start : start + size]
        poses = tree.poses(chunk)
        velocities = tree.velocities(chunk, poses)
        torque, energy = np.empty((len(chunk), tree.n, width)), np.empty(width)
        for block, place in zip(blocks, places, strict=True):
            torque[..., place], energy[place] = block.sampled(tree, chunk, poses, velocities)
        yield torque, load(chunk).torque, energy
