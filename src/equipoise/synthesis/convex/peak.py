"""The peak objective: the largest torque over random poses, bounded and polished by cutting planes.

Only the poses that matter are kept: solve for some, look for the worst among all, add those, repeat. A bound from some
poses is a bound for all, so stopping early never makes it wrong.
"""

from __future__ import annotations

import numpy as np

from ...kinematics import Tree, sample
from ...model.arrays import Array, frozen
from .least_squares_form import LeastSquaresForm, together, torque_rows
from .polish import Parts, jacobian, residual
from .semidefinite import Bound, least_peak

FIRST = 600  # rows (pose and coordinate) of the first round
CUTS = 100  # rows added per round
POLISH_ROUNDS = 12
CLOSE = 1e-3  # relative: the worst pose of all is this close to the worst of the chosen ones


@frozen
class Peak:
    """The torques of a problem at random poses, one row per load, pose and coordinate.

    Every torque is linear in the same few numbers ``w = reduced.times(x)`` as the mean square, so a row is short.

    Attributes:
        L: (rows, len(w)), load: (rows,): the torque is ``L w + load``, as a share of `unbalanced`.
        unbalanced: [N m] the largest torque without any parts.
    """

    reduced: LeastSquaresForm
    L: Array
    load: Array
    unbalanced: float

    @staticmethod
    def of(reduced: LeastSquaresForm) -> Peak:
        """The rows over random poses inside the joint ranges."""
        problem = reduced.problem
        to_w = np.linalg.pinv(np.concatenate(reduced.columns, axis=1))
        q = sample(Tree.of(problem.judged), problem.count, problem.seed)
        each: list[tuple[Array, Array]] = []  # for every load
        for loaded in together(problem):
            L, loads = [], []
            for T, torque, _ in torque_rows(reduced.blocks, loaded, q):
                L.append((T @ to_w * problem.scale[:, None]).reshape(-1, len(reduced.d)))
                loads.append((torque * problem.scale[:, None]).reshape(-1, len(loaded)))
            each += [(np.concatenate(L), load) for load in np.concatenate(loads).T]
        every = np.concatenate([load for _, load in each])
        unit = float(np.abs(every).max()) or 1.0
        return Peak(reduced, np.concatenate([L for L, _ in each]) / unit, every / unit, unit)

    def torque(self, parts: Parts) -> Array:
        """(rows,) torque with a set of parts (batch of 1)."""
        return self.L @ (residual(self.reduced, parts)[0] - self.reduced.d) + self.load

    def of_loads(self, torque: Array) -> Array:
        """(loads,) the largest of the torques (rows,) under each load."""
        return np.abs(torque).reshape(len(self.reduced.problem.loads), -1).max(axis=1)

    def bound(self) -> Bound:
        """The least peak that any parts of the blocks can leave at these poses."""
        chosen = np.zeros(len(self.load), bool)
        chosen[np.random.default_rng(0).permutation(len(self.load))[:FIRST]] = True
        chosen[np.argsort(-np.abs(self.load))[:CUTS]] = True
        best = least_peak(self.reduced, self.L[chosen], self.load[chosen])
        for _ in range(POLISH_ROUNDS):
            torque = np.abs(self.L @ self.reduced.times(best.x) + self.load)
            if torque.max() <= best.value * (1 + CLOSE) + 1e-9:
                break
            chosen[np.argsort(-torque)[:CUTS]] = True
            best = least_peak(self.reduced, self.L[chosen], self.load[chosen])
        return best

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
            program = linprog(
                np.append(np.zeros(J.shape[1]), 1.0),
                np.vstack([np.hstack([J, -one]), np.hstack([-J, -one])]),
                np.concatenate([-tau[chosen], tau[chosen]]),
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
