"""The peak objective: the largest torque over random poses, bounded and polished by cutting planes.

Only the poses that matter are kept: solve for some, look for the worst among all, add those, repeat. A bound from some
poses is a bound for all, so stopping early never makes it wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...kinematics import Tree, sample
from ...kinematics.sampling import inside
from ...model.arrays import Array, Booleans, Integers, frozen, vec3
from ...model.errors import Fault, InputError
from ...model.mechanism import Mechanism
from ..goal import held
from ..load import Load, extremes
from ..problem import Problem
from ..states import States
from .blocks import Block
from .goal import Goal
from .least_squares_form import LeastSquaresForm, torque_rows
from .polish import Parts, best_amounts, capped, charges, jacobian, polish, residual
from .semidefinite import Bound, Program, least, peak_program

FIRST = 600  # rows (pose and coordinate) of the first round
CUTS = 100  # rows added per round
POLISH_ROUNDS = 12
CLOSE = 1e-5  # relative: the worst pose of all is this close to the worst of the chosen ones
KEPT = 3  # sets of a batch that are polished
CORNERS = 256  # poses at the ends of the joint ranges, where the worst is often found


@frozen
class Peak(Goal):
    """The torques of a problem at random poses, one row per pose and coordinate, and one more per load with weight.

    Every torque is linear in the same few numbers ``w = reduced.times(x)`` as the mean square, so a row is short. What
    the loads do there lies between a least and a largest torque: those are all that a peak needs of them.

    Attributes:
        L: (rows, len(w)), low, high: (rows,): the torque is from ``L w + low`` to ``L w + high``, as a share of `unit`.
        each: of every load by itself its rows, and their low and high.
        unit: [N m] the largest torque without any parts.
        rows: those that the program has, where the bound is of no interest.
    """

    reduced: LeastSquaresForm
    L: Array
    low: Array
    high: Array
    each: tuple[tuple[slice, Array, Array], ...]
    unit: float
    numbers: Integers
    rows: Booleans | None = None

    @staticmethod
    def of(reduced: LeastSquaresForm) -> Peak:
        """The rows over random poses inside the joint ranges, and at ends of these.

        Raises:
            InputError: gravity leans, and parts have weight.
        """
        problem = reduced.problem
        weighty = any(block.weighs for block in problem.blocks)
        if weighty and any(load.tilt for load in problem.loads):
            message = "the largest torque over a cone of tilts is not known for parts that have weight; rms is"
            raise InputError(Fault(("tilt",), message))
        to_w = np.linalg.pinv(np.concatenate(reduced.columns, axis=1))
        states, spared = peak_states(problem), friction(problem)
        L, low, high = [], [], []
        each: list[tuple[slice, Array, Array]] = []
        start = 0
        for loads in [(load,) for load in problem.loads] if weighty else [problem.loads]:
            rows, ends = [], []
            for T, torque in torque_ends(reduced.blocks, loads, problem.judged, states):
                rows.append((T @ to_w * problem.scale[:, None]).reshape(-1, len(reduced.d)))
                ends.append(((torque + spared) * problem.scale[:, None, None]).reshape(-1, len(loads), 2))
            L.append(np.concatenate(rows))
            own = np.concatenate(ends)
            place = slice(start, start + len(own))
            each += [(place, own[:, i, 0], own[:, i, 1]) for i in range(len(loads))]
            low.append(own[:, :, 0].min(axis=1))
            high.append(own[:, :, 1].max(axis=1))
            start = place.stop
        least, most = np.concatenate(low), np.concatenate(high)
        unit = max(0.0, float(most.max()), -float(least.min())) or 1.0
        scaled = tuple((place, a / unit, b / unit) for place, a, b in each)
        L = np.concatenate(L) / unit
        return Peak(reduced, L, least / unit, most / unit, scaled, unit, np.arange(len(reduced.blocks)))

    def on(self, chosen: Sequence[int]) -> Peak:
        return replace(self, reduced=self.reduced.on(chosen), numbers=self.numbers[list(chosen)], rows=self._rows)

    def torques(self, parts: Parts) -> Array:
        """(batch, rows) size of the torque with sets of parts, the worst of all loads."""
        return self._size((residual(self.reduced, parts) - self.reduced.d) @ self.L.T)

    def _size(self, torque: Array) -> Array:
        """(..., rows) size of the torque where the parts make `torque` (..., rows); below 0 where friction holds."""
        return np.maximum(torque + self.high, -torque - self.low)

    def torque(self, parts: Parts) -> Array:
        """(rows,) what a set of parts (batch of 1) makes."""
        return ((residual(self.reduced, parts) - self.reduced.d) @ self.L.T)[0]

    def loads(self, parts: Parts) -> tuple[Array, Array]:
        made = self.torque(parts)
        return self._largest(made), self._largest(0 * made)

    def _largest(self, made: Array) -> Array:
        """[N m] (loads,) the largest torque under each load where the parts make `made` (rows,)."""
        ends = ((made[rows], low, high) for rows, low, high in self.each)
        return self.unit * np.array([max((own + high).max(), -(own + low).min()) for own, low, high in ends])

    @cached_property
    def program(self) -> Program:
        return self._program(self._rows)

    def _program(self, rows: Booleans, stretch: float = 1.0) -> Program:
        return peak_program(self.reduced, self.L[rows], self.low[rows], self.high[rows], stretch)

    @cached_property
    def bound(self) -> Bound:
        return self._cut[1]

    @property
    def _rows(self) -> Booleans:
        return self._cut[0] if self.rows is None else self.rows

    @cached_property
    def _cut(self) -> tuple[Booleans, Bound]:
        """The rows that matter, and the optimum with them."""
        chosen = np.zeros(len(self.L), bool)
        chosen[np.random.default_rng(0).permutation(len(self.L))[:FIRST]] = True
        chosen[np.argsort(-self._size(np.zeros(len(self.L))))[:CUTS]] = True
        best = self._program(chosen).solve()
        for _ in range(POLISH_ROUNDS):
            size = self._size(self.L @ self.reduced.times(best.x))
            if size.max() <= best.value * (1 + CLOSE) + 1e-9:
                break
            chosen[np.argsort(-size)[:CUTS]] = True
            best = self._program(chosen).solve()
        return chosen, least(lambda stretch: self._program(chosen, stretch)) if self._program(chosen).far(
            best
        ) else best

    def improve(self, parts: Parts) -> tuple[Parts, Array]:
        """Of the most promising of them, as they are and polished for the mean square."""
        starts = Parts.joined([best_amounts(self.reduced, parts), polish(self.reduced, parts)[0]])
        starts = capped(self.reduced, starts)
        peaks = self.torques(starts).max(axis=1)
        found = [self.polish(starts[i : i + 1]) for i in np.argsort(peaks, kind="stable")[:KEPT].tolist()]
        return Parts.joined([own for own, _ in found]), np.array([value for _, value in found])

    def polish(self, start: Parts) -> tuple[Parts, float]:
        """Lower the peak of one set of parts (batch of 1) under the true constraints: a sequence of linear programs.

        Each program minimises the linearised peak within a trust region; a step that does not lower the true peak
        shrinks the region.
        """
        from scipy.optimize import linprog

        now, trust = capped(self.reduced, start), 0.3
        made = self.torque(now)
        size = self._size(made)
        value = float(size.max())
        chosen = np.zeros(len(made), bool)
        for _ in range(20 * POLISH_ROUNDS):
            if trust < 1e-7:
                break
            chosen[np.argsort(-size)[:CUTS]] = True
            J = self.L[chosen] @ jacobian(self.reduced, now)[0]
            one = np.ones((len(J), 1))
            width = (now.k.shape[1], 1 + now.u.shape[2])
            lower, upper = np.full(width, -trust), np.full(width, trust)
            lower[:, 1:], upper[:, 1:] = np.maximum(-trust, -1 - now.u[0]), np.minimum(trust, 1 - now.u[0])
            A, b = self._within(now)
            program = linprog(
                np.append(np.zeros(J.shape[1]), 1.0),
                np.vstack([np.hstack([J, -one]), np.hstack([-J, -one]), A]),
                np.concatenate([-(made + self.high)[chosen], (made + self.low)[chosen], b]),
                bounds=[*zip(lower.ravel(), upper.ravel(), strict=True), (0, None)],
            )
            if program.x is None:
                break
            trial = capped(self.reduced, now.moved(self.reduced, program.x[:-1].reshape(1, *lower.shape)))
            made_trial = self.torque(trial)
            size_trial = self._size(made_trial)
            new = float(size_trial.max())
            if new < value:
                trust = min(1.0, trust * 1.5) if value - new > 0.5 * (value - program.x[-1]) else trust
                stalled = value - new < 1e-7 * value
                now, made, size, value = trial, made_trial, size_trial, new
                if stalled:
                    break
            else:
                chosen[np.argsort(-size_trial)[:CUTS]] = True
                trust *= 0.4
        return now, value

    def _within(self, now: Parts) -> tuple[Array, Array]:
        """(rows, all steps and the peak), (rows,): what keeps the shapes of a set in their regions."""
        rows, sides = [np.zeros((0, now.k.shape[1] * (1 + now.u.shape[2]) + 1))], [np.zeros(0)]
        for i, number in enumerate(now.block[0].tolist()):
            block = self.reduced.blocks[number]
            A, b = block.within(now.u[0, i, : block.shape])
            first = i * (1 + now.u.shape[2]) + 1
            own = np.zeros((len(A), rows[0].shape[1]))
            own[:, first : first + block.shape] = A
            rows.append(own)
            sides.append(b)
        for i in range(len(self.reduced.limits)):
            charge, slopes = charges(self.reduced, now, i)
            rows.append(np.append(slopes.ravel(), 0.0)[None])
            sides.append(np.array([1 - charge.sum()]))
        return np.concatenate(rows), np.concatenate(sides)


def largest(problem: Problem) -> float:
    """[N m] the largest torque of what stays, without any parts; see `Peak`."""
    states, spared = peak_states(problem), friction(problem)
    ends = (torque for _, torque in torque_ends((), problem.loads, problem.judged, states))
    scale = problem.scale[:, None, None]
    each = (scale * (one + spared) for one in ends)
    return max(max(0.0, float(one[..., 1].max()), -float(one[..., 0].min())) for one in each)


def friction(problem: Problem) -> Array:
    """(n, 1, 2) what is to be added to the least and the largest torque, for dry friction holds so much.

    Raises:
        InputError: in a motion, where it holds nothing.
    """
    if problem.goal.count.friction and problem.goal.poses.motions:
        raise InputError(Fault(("friction",), "does not go with a motion: it holds what stands still"))
    holds = held(problem.goal.count, Tree.of(problem.judged))
    return np.stack([holds, -holds], axis=-1)[:, None]


def torque_ends(
    blocks: Sequence[Block], loads: Sequence[Load], mechanism: Mechanism, states: States
) -> Iterator[tuple[Array, Array]]:
    """As `torque_rows`, in chunks: torque of each unknown, and the least and largest of each load (..., loads, 2)."""
    loaded, places = [], []
    for load in loads:
        upright = load.on(mechanism)
        gravities = [upright.gravity] if not load.tilt else [vec3(g) for g in (np.zeros(3), *np.eye(3))]
        places.append((load, upright.gravity, len(loaded)))
        loaded += [replace(upright, gravity=g) for g in gravities]
    for T, torque, _ in torque_rows(blocks, loaded, states):
        ends = []
        for load, g, i in places:
            still = torque[..., i]
            low, high = 0.0, 0.0
            if load.tilt:
                low, high = extremes(torque[..., i + 1 : i + 4] - still[..., None], np.array(g), load.tilt)
            ends.append(np.stack([still + low, still + high], axis=-1))
        yield T, np.stack(ends, axis=-2)


def peak_states(problem: Problem) -> States:
    """Where the largest torque is looked for."""
    if problem.given_poses:
        return problem.states
    return States.still(peak_poses(Tree.of(problem.judged), problem.count, problem.seed))


def peak_poses(tree: Tree, count: int, seed: int) -> Array:
    """Random configurations; without loops also some with every limited joint at an end of its range."""
    q = sample(tree, count, seed)
    rows = tree.coordinate_rows
    ends = np.stack([tree.lower[rows], tree.upper[rows]])
    limited = np.flatnonzero(np.isfinite(ends).all(axis=0))
    if not len(limited) or tree.mechanism.loops:
        return q
    number = np.arange(min(CORNERS, 2 ** len(limited)))
    which = number[:, None] >> np.arange(len(limited)) & 1
    if 2 ** len(limited) > CORNERS:
        which = np.random.default_rng(seed).integers(0, 2, which.shape)
    corners = q[number % count]
    corners[:, limited] = ends[which, limited]
    return np.concatenate([q, corners[inside(tree, corners)]])
