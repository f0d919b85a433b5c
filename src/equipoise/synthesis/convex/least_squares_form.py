"""The design problem as one small least-squares problem: the Gram form.

All torques are linear in the unknowns x of the blocks, so the mean square torque over any set of configurations is
``|sum_b columns_b x_b + d|^2 + rest^2``. Once the configurations are compressed into columns and d, by averaging a
Fourier series exactly or by an orthogonal reduction of samples, their number no longer matters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from ...energy.fourier.energy import gravity_series
from ...energy.fourier.frames import MAX_TERMS, Frames, denominators
from ...energy.fourier.series import Series
from ...energy.reference import CHUNK_ENTRIES
from ...kinematics import Tree
from ...kinematics.sampling import whole_turns
from ...model.arrays import Array, Complexes, frozen
from ...model.errors import InputError, NoFourierForm
from ...model.mechanism import Mechanism
from ...model.progress import Progress
from ..problem import Problem
from ..states import States, load_torque
from .blocks import Block
from .box_averages import MOST, is_box, mean_products

RANK = 1e-12  # singular values below this share of the largest are rounding


@frozen
class Case:
    """One load by itself: ``|sum_b columns_b x_b + load|`` is its root mean square torque [N m] at unknowns x_b."""

    columns: tuple[Array, ...]
    load: Array

    def rms(self, x: Sequence[Array]) -> float:
        """[N m] what unknowns x leave."""
        return float(np.linalg.norm(sum((A @ own for A, own in zip(self.columns, x, strict=True)), self.load)))


@frozen
class Limit:
    """What all unknowns together may cost: ``sum_b charge_b x_b <= 1``, in shares of the limit."""

    name: str
    charge: tuple[Array, ...]


@frozen
class LeastSquaresForm:
    """The compressed problem, in units of the unbalanced torque.

    Attributes:
        blocks: the unknowns; forms: what they do, for each as its block wants it; d: (rows,), rest: the root mean
            square torque over `unbalanced` at unknowns x_b is ``sqrt(|sum_b columns_b x_b + d|^2 + rest^2)``.
        cost: for each block (unknowns,) [J], what equal designs should have little of: their stored energy, as a rule.
        unbalanced: [N m] root mean square torque to be balanced, all joints together, the weighted mean of all loads.
        cases: each load by itself.
        averaged: the averages are exact over all configurations, not over samples.
        limits: what the unknowns may cost.
    """

    problem: Problem
    blocks: tuple[Block, ...]
    forms: tuple[Array, ...]
    d: Array
    rest: float
    cost: tuple[Array, ...]
    unbalanced: float
    averaged: bool
    cases: tuple[Case, ...]
    limits: tuple[Limit, ...] = ()

    def on(self, chosen: Sequence[int]) -> LeastSquaresForm:
        """The same problem restricted to some of its blocks (by number)."""
        cases = tuple(Case(tuple(case.columns[i] for i in chosen), case.load) for case in self.cases)
        parts = {name: tuple(getattr(self, name)[i] for i in chosen) for name in ("blocks", "forms", "cost")}
        limits = tuple(Limit(one.name, tuple(one.charge[i] for i in chosen)) for one in self.limits)
        return replace(self, cases=cases, limits=limits, **parts)

    @cached_property
    def columns(self) -> tuple[Array, ...]:
        """For each block (rows, unknowns)."""
        return tuple(block.columns(form) for block, form in zip(self.blocks, self.forms, strict=True))

    def times(self, x: Sequence[Array]) -> Array:
        """(rows,) ``sum_b columns_b x_b``: what the unknowns x do."""
        return sum((columns @ own for columns, own in zip(self.columns, x, strict=True)), np.zeros(len(self.d)))

    def enlarged(self, factor: float) -> LeastSquaresForm:
        """The same problem with every region `factor` times as large about its centre."""
        larger = [block.enlarged(factor) for block in self.blocks]

        def scaled(each: Sequence[Array]) -> tuple[Array, ...]:
            return tuple(own * scale for own, (_, scale) in zip(each, larger, strict=True))

        cases = tuple(Case(scaled(case.columns), case.load) for case in self.cases)
        forms = tuple(block.form(own) for block, own in zip(self.blocks, scaled(self.columns), strict=True))
        blocks = tuple(block for block, _ in larger)
        limits = tuple(Limit(one.name, scaled(one.charge)) for one in self.limits)
        return replace(self, blocks=blocks, forms=forms, cost=scaled(self.cost), cases=cases, limits=limits)

    @property
    def useful(self) -> list[int]:
        """The blocks that have any effect: springs between the ground and a vertical axis have none."""
        strength = [float(np.linalg.norm(columns)) for columns in self.columns]
        return [i for i, s in enumerate(strength) if s > 1e-9 * max(strength, default=0.0)]


def build(problem: Problem, progress: Progress | None = None) -> LeastSquaresForm:
    """Compress a problem.

    Averages are exact, but for loops, free lengths and limits of coupled joints: then samples are taken.

    Raises:
        InputError: its loops cannot be closed, its numbers or regions are so large that the torques overflow.
    """
    blocks = problem.blocks
    shares = np.sqrt(problem.shares)
    with np.errstate(over="ignore", invalid="ignore"):
        factors, energy, averaged = _factors(problem, progress)
        weighted = np.vstack([share * F for share, F in zip(shares, factors, strict=True)])
        R = _triangle(weighted) if len(factors) > 1 else weighted
        finite = np.isfinite(R**2).all()
    if not finite:
        raise InputError(f"mechanism '{problem.mechanism.name}' has numbers so large that its torques overflow")
    U, S, Vt = np.linalg.svd(R[:, :-1], full_matrices=False)
    rank = int((RANK * S[0] < S).sum()) if len(S) and S[0] > 0 else 0
    d = (U.T @ R[:, -1])[:rank]
    total = float(np.linalg.norm(R[:, -1]))
    rest = np.linalg.norm(R[:, -1] - U[:, :rank] @ d)
    unit = total or 1.0
    columns = _split(S[:rank, None] * Vt[:rank], blocks)
    forms = tuple(block.form(own) / unit for block, own in zip(blocks, columns, strict=True))
    cost = tuple(block.cost(own) for block, own in zip(blocks, _split(energy, blocks), strict=True))
    cases = tuple(Case(_split(F[:, :-1], blocks), F[:, -1]) for F in _by_load(problem, factors))
    limits = tuple(_limits(problem, _split(energy, blocks)))
    return LeastSquaresForm(problem, blocks, forms, d / unit, float(rest) / unit, cost, total, averaged, cases, limits)


def _limits(problem: Problem, energy: Sequence[Array]) -> Iterator[Limit]:
    """What the goal limits; weights have no rate, and their energy is none that is stored."""
    cost = problem.goal.cost
    springs = [0.0 if block.weighs else 1.0 for block in problem.blocks]
    if cost.stiffness is not None:
        each = (s * block.amount / cost.stiffness for s, block in zip(springs, problem.blocks, strict=True))
        yield Limit("stiffness", tuple(each))
    if cost.energy is not None:
        yield Limit("energy", tuple(s * own / cost.energy for s, own in zip(springs, energy, strict=True)))


def _by_load(problem: Problem, factors: Sequence[Array]) -> Iterator[Array]:
    """Of the factors of all cases one for each load: what is of several cases counts their mean."""
    rest = iter(factors)
    for load in problem.loads:
        own = [next(rest) for _ in load.each(problem.judged)]
        yield own[0] if len(own) == 1 else _triangle(np.vstack(own) / np.sqrt(len(own)))


def together(problem: Problem) -> list[tuple[Mechanism, ...]]:
    """The mechanism under each load, in groups in which the unknowns do the same: all, but for those with weight."""
    return [(case,) for case in problem.cases] if any(block.weighs for block in problem.blocks) else [problem.cases]


def _factors(problem: Problem, progress: Progress | None) -> tuple[list[Array], Array, bool]:
    """For each load (rows, all unknowns and the load), the energies (all unknowns,), and whether they are averages."""
    factors: list[Array] = []
    energy, averaged = np.zeros(0), False
    for loaded in together(problem):
        drawn = problem.samples is not None or problem.given_poses
        rows = None if drawn else _averages(problem, loaded)
        averaged = rows is not None
        R, energy = rows or _samples(problem, loaded, progress)
        unknowns = R.shape[1] - len(loaded)
        factors += [np.column_stack([R[:, :unknowns], load]) for load in R[:, unknowns:].T]
    return factors, energy, averaged


def _places(widths: Sequence[int]) -> list[slice]:
    """Where columns of these widths stand beside each other."""
    ends = np.cumsum([0, *widths]).tolist()
    return [slice(start, end) for start, end in pairwise(ends)]


def _split(values: Array, blocks: Sequence[Block]) -> tuple[Array, ...]:
    """(..., all unknowns) -> (..., unknowns) of each block."""
    return tuple(np.ascontiguousarray(values[..., place]) for place in _places([block.unknowns for block in blocks]))


def _averages(problem: Problem, loaded: Sequence[Mechanism]) -> tuple[Array, Array] | None:
    """Exact means. Of whole turns by Parseval: the mean square of a series' derivative is the sum of |k_j c_k|^2."""
    blocks = problem.blocks
    tree = Tree.of(loaded[0])
    try:
        whole = whole_turns(tree, denominators(tree))
        if not (whole or is_box(tree)):
            return None
        every = [Frames(Tree.of(mechanism), MAX_TERMS if whole else MOST) for mechanism in loaded]
        frames = every[0]
        loads = [_load(own) for own in every]
        forms = [*(block.series(frames) for block in blocks), *loads]
    except NoFourierForm:
        return None
    if not whole or any(form.keys[:, tree.n :].any() for form in forms):
        found = mean_products(tree, frames.denominators, forms, len(loads), problem.scale)
        return _triangle(found[0]), found[1][: -len(loads)]
    keys, inverse = np.unique(np.concatenate([s.keys for s in forms]), axis=0, return_inverse=True)
    places = _places([*(block.unknowns for block in blocks), *(1 for _ in loads)])
    A: Complexes = np.zeros((len(keys), places[-1].stop), complex)
    rows = np.split(inverse.ravel(), np.cumsum([len(s) for s in forms])[:-1])
    for form, row, place in zip(forms, rows, places, strict=True):
        A[row, place] = form.coef
    energy = A.real[~keys.any(axis=1), : -len(loads)].sum(axis=0)
    A *= np.linalg.norm(keys[:, : tree.n] / frames.denominators * problem.scale, axis=1)[:, None]
    return _triangle(np.vstack([A.real, A.imag])), energy


def _load(frames: Frames) -> Series:
    """Gravity and the springs that stay; coefficients (T, 1) [J]."""
    springs = (spring.series(frames) for spring in frames.tree.mechanism.springs)
    total = Series.sum([gravity_series(frames), *springs])
    return Series(total.keys, total.coef[:, :, 0])


def _samples(problem: Problem, loaded: Sequence[Mechanism], progress: Progress | None) -> tuple[Array, Array]:
    blocks, states = problem.blocks, problem.states
    width = sum(block.unknowns for block in blocks) + len(loaded)
    R, mean, done = np.zeros((0, width)), np.zeros(width - len(loaded)), 0
    for torque, loads, energy in torque_rows(blocks, loaded, states):
        part = np.sqrt(states.share[done : done + len(torque)])[:, None, None]
        rows = np.concatenate([torque, loads], axis=-1) * problem.scale[:, None] * part
        R = _triangle(np.vstack([R, rows.reshape(-1, width)]))
        mean += energy / len(states)
        done += len(torque)
        if progress:
            progress("reducing samples", done / len(states))
    return R, mean


def _triangle(rows: Array) -> Array:
    """The triangular factor: the same Gram matrix in as few rows as there are columns."""
    return np.asarray(np.linalg.qr(rows, mode="r"))


def torque_rows(
    blocks: Sequence[Block], loaded: Sequence[Mechanism], states: States
) -> Iterator[tuple[Array, Array, Array]]:
    """Torques at N states as linear functions of the unknowns, in chunks of configurations.

    Args:
        loaded: the mechanism under loads that make no difference to what the unknowns do, see `together`.

    Yields:
        (chunk, n, all unknowns) torque of each unknown, (chunk, n, loads) torque of gravity, present springs and what
        moves [N m or N], and (all unknowns,) the sum over the chunk of each unknown's energy [J].
    """
    tree = Tree.of(loaded[0])
    places = _places([block.unknowns for block in blocks])
    width = sum(block.unknowns for block in blocks)
    size = max(1, CHUNK_ENTRIES // max(1, tree.n * width))
    for part in states.chunks(size):
        chunk, moving = part.q, part.moving(tree)
        poses = tree.poses(chunk) if moving is None else moving.poses
        velocities = tree.velocities(chunk, poses) if moving is None else moving.velocities
        torque, energy = np.empty((len(chunk), tree.n, width)), np.empty(width)
        for block, place in zip(blocks, places, strict=True):
            torque[..., place], energy[place] = block.sampled(tree, chunk, poses, velocities)
            if moving is not None:
                torque[..., place] += block.driven(moving)
        yield torque, np.stack([load_torque(mechanism, part, moving) for mechanism in loaded], axis=-1), energy
