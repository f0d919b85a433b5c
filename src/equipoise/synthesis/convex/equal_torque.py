"""Sets of parts that do the same as a set at every pose, and meet wishes better: a walk on a level set.

Gauss-Newton steps for the wishes within the null space of the torque's derivative, each followed by steps back to where
the torque is what it was. The level set may be curved as it likes: no penalty has to be balanced against it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...model.arrays import Array
from .least_squares_form import LeastSquaresForm
from .polish import Parts, free_steps, jacobian, residual
from .wishes import Wishes

STEPS = 50
WEAK = 1e-7  # singular values below this share of the largest are no constraint
FAR = 1e-10  # of the unbalanced torque: a step that ends further off the level set is not taken
BACK, END = 4, 12  # steps back after each step, and at the end
ROUNDING = 1e-15
SLOW, GAIN = 5, 1e-4  # steps that gain less than this share, after which it is enough
RIMS = 4  # times that what leads out of a region is taken away
LONGEST = 0.5  # step in a region's own coordinates, or in the logarithm of an amount


def same_torque(wishes: Wishes, start: Parts) -> Parts:
    """A set (batch of 1) that leaves the same torque as `start` and meets the wishes better, or `start`."""
    reduced = wishes.reduced
    level = replace(reduced, d=reduced.d - residual(reduced, start)[0], rest=0.0)
    now, damping, slow = start, 1e-2, 0
    G = wishes.rows(now)[0]
    for _ in range(STEPS):
        trial = _back(level, now.moved(level, _step(level, wishes, now, G, damping)), BACK)
        G_trial = wishes.rows(trial)[0]
        gain = 1 - (G_trial @ G_trial) / max(G @ G, 1e-300)
        if gain > 0 and np.linalg.norm(residual(level, trial)) < FAR:
            slow = 0 if gain > GAIN else slow + 1
            now, G, damping = trial, G_trial, max(0.2 * damping, 1e-9)
        else:
            damping *= 8.0
        if slow == SLOW or damping > 1e6:
            break
    return _back(level, now, END)


def _step(level: LeastSquaresForm, wishes: Wishes, now: Parts, G: Array, damping: float) -> Array:
    """(1, parts, 1 + shape) towards the wishes, along the level set."""
    slopes, J = wishes.slopes(now)[0], jacobian(level, now)[0]

    def within(F: Array) -> Array:
        _, s, rows = np.linalg.svd(J @ F, full_matrices=True)
        null = F @ rows[int((s > WEAK * s.max(initial=0.0)).sum()) :].T
        A = slopes @ null
        H = A.T @ A
        H += damping * np.diag(np.diag(H) + 1e-3 * np.diag(H).max(initial=0.0) + 1e-12)
        return null @ -np.linalg.solve(H, A.T @ G)

    return _inside(level, now, within)


def _back(level: LeastSquaresForm, now: Parts, steps: int) -> Parts:
    """Newton's steps to the level set, the shortest ones."""
    r = residual(level, now)[0]
    for _ in range(steps):
        J = jacobian(level, now)[0]
        trial = now.moved(level, _inside(level, now, lambda F: F @ np.linalg.lstsq(J @ F, -r, rcond=WEAK)[0]))  # noqa: B023
        r_trial = residual(level, trial)[0]
        if not r_trial @ r_trial < r @ r:
            break
        now, r = trial, r_trial
        if np.linalg.norm(r) < ROUNDING:
            break
    return now


def _inside(level: LeastSquaresForm, now: Parts, within: Callable[[Array], Array]) -> Array:
    """(1, parts, 1 + shape) a step `within` a subspace, given by its projector, that does not leave the regions."""
    shape = (1, now.k.shape[1], 1 + now.u.shape[2])
    F, step = np.eye(shape[1] * shape[2]), np.zeros(shape[1] * shape[2])
    for _ in range(RIMS):
        step = within(F)
        smaller = F @ _blocks(free_steps(level, now, -step.reshape(shape))[0])
        if np.abs(smaller - F).max() < WEAK:
            break
        F = smaller
    return np.clip(step, -LONGEST, LONGEST).reshape(shape)


def _blocks(each: Array) -> Array:
    """(parts, w, w) -> (parts w, parts w) with these on the diagonal."""
    count, width, _ = each.shape
    out = np.zeros((count, width, count, width))
    for i in range(count):
        out[i, :, i] = each[i]
    return out.reshape(count * width, count * width)
