"""Local improvement of few springs under the true constraints: many starts at once.

A projected Levenberg-Marquardt method on the Gram form, batched over starts in plain numpy: the problems are tiny
(about 40 residuals, 7 unknowns a spring) and there are thousands of starts, so that a library call per start would
spend its time in overhead. Unknowns per spring: log stiffness, and both attachments in their regions' coordinates.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Booleans, Integers, frozen
from .gram import Gram

ITERATIONS = 150
STALL = 1e-13  # residual norm (share of the unbalanced torque) that cannot be improved upon in double precision
LOG_RANGE = 14.0  # stiffness within e^+-14 of its scale


@frozen
class Springs:
    """A batch of spring sets: stiffness `k` (batch, springs) [N/m] and attachments `u` (batch, springs, 2, 3).

    `u` is in the regions' own coordinates (unit ball or box); `pair` (batch, springs) is the number of the body pair.
    """

    pair: Integers
    k: Array
    u: Array

    def __len__(self) -> int:
        return len(self.k)

    def __getitem__(self, chosen: Integers | slice) -> Springs:
        return Springs(self.pair[chosen], self.k[chosen], self.u[chosen])

    @property
    def y(self) -> Array:
        """(batch, springs, 7): [u_a; 1; u_b], so that a spring's moment matrix is k y y'."""
        one = np.ones((*self.k.shape, 1))
        return np.concatenate([self.u[:, :, 0], one, self.u[:, :, 1]], axis=-1)

    def moved(self, step: Array, is_box: Booleans) -> Springs:
        """The sets after a `step` (batch, springs, 7): log stiffness, then both attachments, back into the regions."""
        u = self.u + step[..., 1:].reshape(self.u.shape)
        return Springs(self.pair, self.k * np.exp(step[..., 0]), project(u, is_box))

    def store(self, gram: Gram) -> Array:
        """(batch,) mean stored energy [J]."""
        return np.einsum("bs,bsi,bsij,bsj->b", self.k, self.y, gram.store[self.pair], self.y)


def residual(gram: Gram, springs: Springs) -> Array:
    """(batch, rows) residual of the Gram form, as a share of the unbalanced torque, `rest` not included."""
    return (unit_torque(gram, springs) @ springs.k[..., None])[..., 0] + gram.d


def unit_torque(gram: Gram, springs: Springs) -> Array:
    """(batch, rows, springs): what each spring does per unit of stiffness."""
    y = springs.y
    Qy = (gram.Q[springs.pair] @ y[:, :, None, :, None])[..., 0]
    return np.swapaxes((Qy @ y[..., None])[..., 0], 1, 2)


def best_stiffness(gram: Gram, springs: Springs) -> Springs:
    """The same attachments with the stiffnesses that leave least (each at least a trifle of the common scale)."""
    A = unit_torque(gram, springs)
    H = np.swapaxes(A, 1, 2) @ A
    ridge = 1e-9 * np.trace(H, axis1=1, axis2=2)[:, None, None] * np.eye(H.shape[1]) + 1e-300 * np.eye(H.shape[1])
    k = -np.linalg.solve(H + ridge, np.swapaxes(A, 1, 2) @ gram.d[:, None])[..., 0]
    floor = 0.05 * np.abs(k).max(axis=1, keepdims=True)
    return Springs(springs.pair, np.maximum(k, np.maximum(floor, 1e-9)), springs.u)


def polish(gram: Gram, start: Springs, iterations: int = ITERATIONS) -> tuple[Springs, Array]:
    """Improve every spring set of a batch.

    Returns:
        The improved sets and their root mean square torque (batch,), as a share of the unbalanced one.
    """
    is_box = gram.box[start.pair]  # (batch, springs, 2)
    reference = np.log(start.k)
    now, damping = Springs(start.pair, start.k.copy(), start.u.copy()), np.full(len(start), 1e-3)
    r = residual(gram, now)
    cost = np.einsum("br,br->b", r, r)
    alive = np.ones(len(start), bool)
    slow = np.zeros(len(start), int)
    for _ in range(iterations):
        batch = np.flatnonzero(alive)
        if not len(batch):
            break
        trial = _step(gram, now[batch], r[batch], damping[batch], is_box[batch], reference[batch])
        r_trial = residual(gram, trial)
        cost_trial = np.einsum("br,br->b", r_trial, r_trial)
        better = cost_trial < cost[batch]
        gain = 1 - cost_trial / np.maximum(cost[batch], 1e-300)
        accepted = batch[better]
        for mine, new in ((now.k, trial.k), (now.u, trial.u), (r, r_trial), (cost, cost_trial)):
            mine[accepted] = new[better]
        damping[batch] = np.clip(np.where(better, damping[batch] * 0.2, damping[batch] * 8.0), 1e-14, 1e8)
        slow[batch] = np.where(better & (gain > 1e-4), 0, slow[batch] + 1)
        alive[batch] = (cost[batch] > STALL**2) & (slow[batch] < 15) & (damping[batch] < 1e7)
    return now, np.sqrt(cost + gram.rest**2)


def _step(gram: Gram, x: Springs, r: Array, damping: Array, is_box: Booleans, reference: Array) -> Springs:
    """One damped Gauss-Newton step, projected onto the regions, with outward directions at the boundary frozen."""
    B, S = x.k.shape
    J = jacobian(gram, x)
    g = np.einsum("bri,br->bi", J, r)
    free = _free(x.u, g.reshape(B, S, 7)[:, :, 1:].reshape(B, S, 2, 3), is_box)
    J = (J.reshape(B, -1, S, 7).transpose(0, 2, 1, 3) @ free).transpose(0, 2, 1, 3).reshape(B, -1, 7 * S)
    H, g = np.swapaxes(J, 1, 2) @ J, np.einsum("bri,br->bi", J, r)
    diagonal = np.einsum("bii->bi", H)  # a view: the damping goes onto H itself
    diagonal += damping[:, None] * (diagonal + 1e-6 * diagonal.max(axis=1, keepdims=True) + 1e-30)
    step = (free @ -np.linalg.solve(H, g[..., None]).reshape(B, S, 7, 1))[..., 0]
    step[..., 1:] = np.clip(step[..., 1:], -1, 1)
    log_k = np.log(x.k)
    step[..., 0] = np.clip(np.clip(step[..., 0], -2, 2), reference - LOG_RANGE - log_k, reference + LOG_RANGE - log_k)
    return x.moved(step, is_box)


def jacobian(gram: Gram, x: Springs) -> Array:
    """(batch, rows, 7 springs) derivative of `residual`: per spring by log stiffness, u_a and u_b."""
    B, S = x.k.shape
    Qy = (gram.Q[x.pair] @ x.y[:, :, None, :, None])[..., 0]
    by_u = 2 * x.k[:, :, None, None] * Qy[..., [0, 1, 2, 4, 5, 6]]
    by_k = x.k[:, :, None] * (Qy @ x.y[..., None])[..., 0]
    return np.concatenate([by_k[..., None], by_u], axis=-1).transpose(0, 2, 1, 3).reshape(B, -1, 7 * S)


def project(u: Array, is_box: Booleans) -> Array:
    """The nearest point of each region: the unit box or the unit ball. u: (..., 3), is_box: (...)."""
    norm = np.linalg.norm(u, axis=-1, keepdims=True)
    return np.where(is_box[..., None], np.clip(u, -1, 1), u / np.maximum(norm, 1.0))


def _free(u: Array, gradient: Array, is_box: Booleans) -> Array:
    """(B, S, 7, 7) projectors onto the directions a step may take: not out of a region through its boundary."""
    B, S = u.shape[:2]
    out_of_box = (np.abs(u) >= 1 - 1e-12) & (gradient * u < 0)
    at_rim = (np.linalg.norm(u, axis=-1) >= 1 - 1e-12) & (np.einsum("...i,...i", gradient, u) < 0)
    keep_box = np.where(out_of_box, 0.0, 1.0)[..., None] * np.eye(3)
    keep_ball = np.eye(3) - np.where(at_rim[..., None, None], u[..., :, None] * u[..., None, :], 0.0)
    keep = np.where(is_box[..., None, None], keep_box, keep_ball)
    free = np.zeros((B, S, 7, 7))
    free[..., 0, 0] = 1.0
    free[..., 1:4, 1:4], free[..., 4:, 4:] = keep[:, :, 0], keep[:, :, 1]
    return free
