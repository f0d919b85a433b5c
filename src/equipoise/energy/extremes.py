"""The extremes of quantities over the configurations: samples and corners, then climbs from several of the best.

Samples alone understate a peak, by several per cent in six dimensions, and a climb from the best of them alone may end
on a lower hill. Where a face that is not the box's (of a dependent joint's range) or a crease stops the quasi-Newton
steps, a random search with a shrinking step goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np

from ..kinematics.sampling import bounds, inside, slowest
from ..kinematics.tree import Tree
from ..model.arrays import Array, Booleans, Integers

CLIMB_ROUNDS = 24
SHRINK = 0.6  # of the step per round: 24 rounds end at 5e-6 of the first step
BUDGET = 48_000  # poses that each stage of the climb may evaluate, and the random search at its end
LOOPED = 12_000  # the same where every pose has loops to close
STAGES = ((64, 4), (10, 8), (3, 12))  # climbers of each quantity, at most, and rounds of quasi-Newton steps
CORNERED = 8  # coordinates, at most, whose box has all its corners tried
DIFFERENCE = 1e-6  # of the box's width, for slopes
STEPS = 0.3 ** np.arange(6)  # of a quasi-Newton step, tried all at once
LONGEST = 0.25  # of the box's width, a step at most


def ascend(
    values: Callable[[Array], Array], x: Array, which: Integers, lower: Array, upper: Array, rounds: int
) -> tuple[Array, Array]:
    """Local maxima in a box by quasi-Newton steps, faces, edges and corners included, from many starts at once.

    Args:
        values: (N, n) points -> (N, m) quantities; what is not finite is never taken.
        x: (S, n) starts. which: (S,) the quantity that each is to raise.
        lower, upper: (n,) the box.

    Returns:
        (S,) what they reach, and (S, n) where.
    """
    width = np.where(upper > lower, upper - lower, 1.0)
    starts, n = x.shape
    each = np.arange(starts)

    def height(u: Array) -> Array:
        """(S, k) of (S, k, n) points in units of the box."""
        found = values((lower + u * width).reshape(-1, n)).reshape(starts, u.shape[1], -1)[each, :, which]
        return np.where(np.isfinite(found), found, -np.inf)

    u = (x - lower) / width
    best, H = height(u[:, None])[:, 0], np.broadcast_to(np.eye(n), (starts, n, n)).copy()
    last: tuple[Array, Array] | None = None
    for _ in range(rounds):
        side = np.where(u + DIFFERENCE > 1, -1.0, 1.0)
        beside = height(u[:, None] + DIFFERENCE * side[:, None] * np.eye(n))
        with np.errstate(invalid="ignore"):
            slope = (beside - best[:, None]) / (DIFFERENCE * side)
        slope = np.where(np.isfinite(slope), slope, 0.0)
        if last is not None:
            H = _curved(H, u - last[0], last[1] - slope)
        last = u, slope
        pushed = slope * ~(((u <= 0) & (slope < 0)) | ((u >= 1) & (slope > 0)))
        step = np.einsum("sij,sj->si", H, pushed) * (pushed != 0)
        wrong = (step * pushed).sum(axis=1) <= 0
        step[wrong] = pushed[wrong]
        longest = np.abs(step).max(axis=1, keepdims=True)
        step *= LONGEST / np.maximum(longest, LONGEST)
        trial = np.clip(u[:, None] + STEPS[:, None] * step[:, None], 0.0, 1.0)
        found = height(trial)
        winner = found.argmax(axis=1)
        better = found[each, winner] > best
        u = np.where(better[:, None], trial[each, winner], u)
        best = np.where(better, found[each, winner], best)
        H[~better] = np.eye(n)  # next along the slope
    return best, lower + u * width


def _curved(H: Array, s: Array, y: Array) -> Array:
    """The BFGS update (S, n, n) of inverse curvatures for steps `s` and changes of slope `y`, where positive."""
    sy = (s * y).sum(axis=1)
    good = sy > 1e-12 * np.sqrt((s**2).sum(axis=1) * (y**2).sum(axis=1))
    rho = np.where(good, 1 / np.where(good, sy, 1.0), 0.0)[:, None, None]
    V = np.eye(s.shape[1]) - rho * s[:, :, None] * y[:, None]
    return np.where(good[:, None, None], V @ H @ np.swapaxes(V, 1, 2) + rho * s[:, :, None] * s[:, None], H)


def apart(values: Array, u: Array, count: int) -> Integers:
    """(at most count,) numbers of the best of (N,) values whose points `u` (N, n), in units of the box, are well apart.

    A start that only repeats its neighbour finds nothing new. What is not finite is not taken.
    """
    chosen: list[int] = []
    columns = np.ascontiguousarray(u.T)
    finite = np.where(np.isfinite(values), values, -np.inf)

    def near(i: int, radius: float) -> Booleans:
        return np.abs(columns - columns[:, i : i + 1]).max(axis=0, initial=0) < radius

    for radius in (0.2, 0.1, 1e-9):
        free = finite.copy()
        for i in chosen:
            free[near(i, radius)] = -np.inf
        while len(chosen) < count and np.isfinite(free.max(initial=-np.inf)):
            chosen.append(int(free.argmax()))
            free[near(chosen[-1], radius)] = -np.inf
    return np.array(chosen, int)


def climb(tree: Tree, values: Callable[[Array], Array], q: Array, seed: int = 0) -> tuple[Array, Array]:
    """The largest values of several quantities at once.

    Args:
        values: (N, n) configurations -> (N, m) quantities.
        q: (N, n) samples to start from; each quantity climbs from several of its best, and from corners.

    Returns:
        (m,) the largest values found, never below the best sample, and (m, n) the configurations that give them.
    """
    start = values(q)
    m = start.shape[1]
    if tree.n == 0 or m == 0:
        return start.max(axis=0), q[np.argmax(start, axis=0)]
    lower, upper = bounds(tree)
    width = np.where(upper > lower, upper - lower, 1.0)

    def reachable(x: Array) -> Array:
        found = values(x)
        return np.where(inside(tree, x)[:, None] & np.isfinite(found), found, -np.inf)

    if tree.n <= CORNERED:
        corners = np.array(list(product(*zip(lower, upper, strict=True))))
        q, start = np.concatenate([q, corners]), np.concatenate([start, reachable(corners)])
    budget = LOOPED if tree.mechanism.loops else BUDGET
    for count, rounds in STAGES:
        most = max(1, budget // (m * rounds * (tree.n + len(STEPS))))
        u = (q - lower) / width
        starts = [apart(start[:, j], u, min(count, most)) for j in range(m)]  # whichever quantity has found them
        which = np.repeat(np.arange(m), [len(numbers) for numbers in starts])
        _, q = ascend(reachable, q[np.concatenate(starts)], which, lower, upper, rounds)
        start = reachable(q)
    first = start.argmax(axis=0)
    return _wander(tree, reachable, start[first, np.arange(m)], q[first], budget, np.random.default_rng(seed))


def _wander(
    tree: Tree, values: Callable[[Array], Array], best: Array, best_q: Array, budget: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """The same by a random search with a shrinking step from what the (m,) quantities have reached, at (m, n)."""
    m = len(best)
    lower, upper = bounds(tree)
    width = np.minimum(upper - lower, 2.0 / slowest(tree))
    tries = max(4, budget // (CLIMB_ROUNDS * m))
    for i in range(CLIMB_ROUNDS):
        step = 0.25 * SHRINK**i * width * rng.normal(size=(m, tries, tree.n))
        step *= rng.random(step.shape) < max(0.5, 1 / tree.n)  # moving fewer coordinates at a time climbs ridges better
        trial = np.clip(best_q[:, None] + step, lower, upper).reshape(-1, tree.n)
        found = values(trial).reshape(m, tries, m)
        own = np.diagonal(found, axis1=0, axis2=2).T  # (m, tries): of each trial only the quantity it climbs
        winner = own.argmax(axis=1)
        better = own[np.arange(m), winner] > best
        best_q = np.where(better[:, None], trial.reshape(m, tries, tree.n)[np.arange(m), winner], best_q)
        best = np.where(better, own[np.arange(m), winner], best)
    # what one quantity has found may serve another: without springs, residual and unbalanced torque are the same
    shared = values(best_q)
    owner = shared.argmax(axis=0)
    return shared[owner, np.arange(m)], best_q[owner]
