"""The peak objective: the largest torque over random poses, bounded and polished by cutting planes.

Only the poses that matter are kept: solve for some, look for the worst among all, add those, repeat. A bound from some
poses is a bound for all, so stopping early never makes it wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...kinematics import Tree, sample
from ...kinematics.sampling import inside
from ...model.arrays import Array, Booleans, Integers, frozen
from .goal import Goal
from .least_squares_form import LeastSquaresForm, together, torque_rows
from .polish import Parts, best_amounts, jacobian, polish, residual
from .semidefinite import Bound, Program, peak_program

FIRST = 600  # rows (pose and coordinate) of the first round
CUTS = 100  # rows added per round
POLISH_ROUNDS = 12
CLOSE = 1e-5  # relative: the worst pose of all is this close to the worst of the chosen ones
KEPT = 3  # sets of a batch that are polished
CORNERS = 256  # poses at the ends of the joint ranges, where the worst is often found


@frozen
class Peak(Goal):
    """The torques of a problem at random poses, one row per load, pose and coordinate.

    Every torque is linear in the same few numbers ``w = reduced.times(x)`` as the mean square, so a row is short.

    Attributes:
        L: (rows, len(w)), load: (rows,): the torque is ``L w + load``, as a share of `unit`.
        unit: [N m] the largest torque without any parts.
        rows: those that the program has, where the bound is of no interest.
    """

    reduced: LeastSquaresForm
    L: Array
    load: Array
    unit: float
    numbers: Integers
    rows: Booleans | None = None

    @staticmethod
    def of(reduced: LeastSquaresForm) -> Peak:
        """The rows over random poses inside the joint ranges, and at ends of these."""
        problem = reduced.problem
        to_w = np.linalg.pinv(np.concatenate(reduced.columns, axis=1))
        q = peak_poses(Tree.of(problem.judged), problem.count, problem.seed)
        each: list[tuple[Array, Array]] = []  # for every load
        for loaded in together(problem):
            L, loads = [], []
            for T, torque, _ in torque_rows(reduced.blocks, loaded, q):
                L.append((T @ to_w * problem.scale[:, None]).reshape(-1, len(reduced.d)))
                loads.append((torque * problem.scale[:, None]).reshape(-1, len(loaded)))
            each += [(np.concatenate(L), load) for load in np.concatenate(loads).T]
        every = np.concatenate([load for _, load in each])
        unit = float(np.abs(every).max()) or 1.0
        L = np.concatenate([L for L, _ in each]) / unit
        return Peak(reduced, L, every / unit, unit, np.arange(len(reduced.blocks)))

    def on(self, chosen: Sequence[int]) -> Peak:
        return replace(self, reduced=self.reduced.on(chosen), numbers=self.numbers[list(chosen)], rows=self._rows)

    def torques(self, parts: Parts) -> Array:
        """(batch, rows) torque with sets of parts."""
        return (residual(self.reduced, parts) - self.reduced.d) @ self.L.T + self.load

    def torque(self, parts: Parts) -> Array:
        """(rows,) torque with a set of parts (batch of 1)."""
        return self.torques(parts)[0]

    def loads(self, parts: Parts) -> tuple[Array, Array]:
        return self._largest(self.torque(parts)), self._largest(self.load)

    def _largest(self, torque: Array) -> Array:
        """[N m] (loads,) the largest of the torques (rows,) under each load."""
        return self.unit * np.abs(torque).reshape(len(self.reduced.problem.loads), -1).max(axis=1)

    @cached_property
    def program(self) -> Program:
        return peak_program(self.reduced, self.L[self._rows], self.load[self._rows])

    @cached_property
    def bound(self) -> Bound:
        return self._cut[1]

    @property
    def _rows(self) -> Booleans:
        return self._cut[0] if self.rows is None else self.rows

    @cached_property
    def _cut(self) -> tuple[Booleans, Bound]:
        """The rows that matter, and the optimum with them."""
        chosen = np.zeros(len(self.load), bool)
        chosen[np.random.default_rng(0).permutation(len(self.load))[:FIRST]] = True
        chosen[np.argsort(-np.abs(self.load))[:CUTS]] = True
        best = peak_program(self.reduced, self.L[chosen], self.load[chosen]).solve()
        for _ in range(POLISH_ROUNDS):
            torque = np.abs(self.L @ self.reduced.times(best.x) + self.load)
            if torque.max() <= best.value * (1 + CLOSE) + 1e-9:
                break
            chosen[np.argsort(-torque)[:CUTS]] = True
            best = peak_program(self.reduced, self.L[chosen], self.load[chosen]).solve()
        return chosen, best

    def improve(self, parts: Parts) -> tuple[Parts, Array]:
        """Of the most promising of them, as they are and polished for the mean square."""
        starts = Parts.joined([best_amounts(self.reduced, parts), polish(self.reduced, parts)[0]])
        peaks = np.abs(self.torques(starts)).max(axis=1)
        found = [self.polish(starts[i : i + 1]) for i in np.argsort(peaks, kind="stable")[:KEPT].tolist()]
        return Parts.joined([own for own, _ in found]), np.array([value for _, value in found])

    def polish(self, start: Parts) -> tuple[Parts, float]:
        """Lower the peak of one set of parts (batch of 1) under the true constraints: a sequence of linear programs.

        Each program minimises the linearised peak within a trust region; a step that does not lower the true peak
        shrinks the region.
        """
        from scipy.optimize import linprog

        now, trust = start, 0.3
        tau = self.torque(now)
        value = float(np.abs(tau).max())
        chosen = np.zeros(len(tau), bool)
        for _ in range(20 * POLISH_ROUNDS):
            if trust < 1e-7:
                break
            chosen[np.argsort(-np.abs(tau))[:CUTS]] = True
            J = self.L[chosen] @ jacobian(self.reduced, now)[0]
            one = np.ones((len(J), 1))
            width = (now.k.shape[1], 1 + now.u.shape[2])
            lower, upper = np.full(width, -trust), np.full(width, trust)
            lower[:, 1:], upper[:, 1:] = np.maximum(-trust, -1 - now.u[0]), np.minimum(trust, 1 - now.u[0])
            A, b = self._within(now)
            program = linprog(
                np.append(np.zeros(J.shape[1]), 1.0),
                np.vstack([np.hstack([J, -one]), np.hstack([-J, -one]), A]),
                np.concatenate([-tau[chosen], tau[chosen], b]),
                bounds=[*zip(lower.ravel(), upper.ravel(), strict=True), (0, None)],
            )
            if program.x is None:
                break
            trial = now.moved(self.reduced, program.x[:-1].reshape(1, *lower.shape))
            tau_trial = self.torque(trial)
            new = float(np.abs(tau_trial).max())
            if new < value:
                trust = min(1.0, trust * 1.5) if value - new > 0.5 * (value - program.x[-1]) else trust
                stalled = value - new < 1e-7 * value
                now, tau, value = trial, tau_trial, new
                if stalled:
                    break
            else:
                chosen[np.argsort(-np.abs(tau_trial))[:CUTS]] = True
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
        return np.concatenate(rows), np.concatenate(sides)


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
