"""Local improvement of few parts under the true constraints: many starts at once.

A projected Levenberg-Marquardt method on the Gram form, batched over starts in plain numpy: the problems are tiny
(about 40 residuals, 7 unknowns a spring) and there are thousands of starts, so that a library call per start would
spend its time in overhead. Unknowns per part: the logarithm of its amount, and its shape.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...model.arrays import Array, Booleans, Integers, frozen
from .blocks import Block
from .least_squares_form import LeastSquaresForm

ITERATIONS = 150
STALL = 1e-13  # residual norm (share of the unbalanced torque) that cannot be improved upon in double precision
LEAST_PRICE, MOST_PRICE, HALVINGS, SHORT = 1e-10, 10.0, 14, 40  # of a limit, in shares of the mean square
LOG_RANGE = 14.0  # an amount stays within e^+-14 of where it starts


@frozen
class Parts:
    """A batch of sets of parts.

    Attributes:
        block: (batch, parts) the number of the block that each belongs to.
        k: (batch, parts) its amount: of a spring the stiffness [N/m].
        u: (batch, parts, shape) its shape, in [-1, 1]; zero beyond the coordinates that its block has.
    """

    block: Integers
    k: Array
    u: Array

    @staticmethod
    def at(reduced: LeastSquaresForm, block: Integers, k: Array, u: Array) -> Parts:
        """Parts with the possible shapes nearest to `u`."""
        u = u.copy()
        for own, at, _ in by_block(reduced, block):
            u[at, : own.shape] = own.project(u[at, : own.shape])
            u[at, own.shape :] = 0.0
        return Parts(block, k, u)

    def __len__(self) -> int:
        return len(self.k)

    def __getitem__(self, chosen: Integers | slice) -> Parts:
        return Parts(self.block[chosen], self.k[chosen], self.u[chosen])

    @staticmethod
    def joined(batches: Sequence[Parts]) -> Parts:
        """One batch of sets of the same number of parts, their shapes as wide as the widest."""
        width = max(own.u.shape[2] for own in batches)
        u = [np.pad(own.u, ((0, 0), (0, 0), (0, width - own.u.shape[2]))) for own in batches]
        block, k = (np.concatenate([getattr(own, name) for own in batches]) for name in ("block", "k"))
        return Parts(block, k, np.concatenate(u))

    def without(self, i: int) -> Parts:
        """The same without the i-th part of every set."""
        rest = [j for j in range(self.k.shape[1]) if j != i]
        return Parts(self.block[:, rest], self.k[:, rest], self.u[:, rest])

    def moved(self, reduced: LeastSquaresForm, step: Array) -> Parts:
        """The sets after a `step` (batch, parts, 1 + shape): log amount, then shape, back to where it is possible."""
        return Parts.at(reduced, self.block, self.k * np.exp(step[..., 0]), self.u + step[..., 1:])

    def scattered(self, reduced: LeastSquaresForm, size: float, rng: np.random.Generator) -> Parts:
        """Sets around these: amounts by factors, shapes by steps of about `size`."""
        steps = rng.normal(0.0, size, (*self.k.shape, 1 + self.u.shape[2]))
        return self.moved(reduced, steps)

    def unknowns(self, reduced: LeastSquaresForm) -> list[Array]:
        """What the parts of a set (a batch of one) add up to, for each block (unknowns,)."""
        x = [np.zeros(block.unknowns) for block in reduced.blocks]
        for own, at, number in by_block(reduced, self.block):
            x[number] = self.k[at] @ own.part(self.u[at, : own.shape])
        return x

    def cost(self, reduced: LeastSquaresForm) -> Array:
        """(batch,) what equal designs should have little of: mean stored energy, as a rule [J]."""
        each = np.empty(self.k.shape)
        for own, at, number in by_block(reduced, self.block):
            each[at] = own.part(self.u[at, : own.shape]) @ reduced.cost[number]
        return (self.k * each).sum(axis=1)


def shape(reduced: LeastSquaresForm) -> int:
    """The most coordinates that the shape of any part has."""
    return max(block.shape for block in reduced.blocks)


def by_block(reduced: LeastSquaresForm, block: Integers) -> Iterator[tuple[Block, Booleans, int]]:
    """Each block that occurs, where it does, and its number."""
    for number in np.unique(block).tolist():
        yield reduced.blocks[number], block == number, number


def residual(reduced: LeastSquaresForm, parts: Parts) -> Array:
    """(batch, rows) residual of the Gram form, as a share of the unbalanced torque, `rest` not included."""
    return (unit_torque(reduced, parts) @ parts.k[..., None])[..., 0] + reduced.d


def unit_torque(reduced: LeastSquaresForm, parts: Parts) -> Array:
    """(batch, rows, parts): what one unit of each part does."""
    out = np.empty((*parts.k.shape, len(reduced.d)))
    for own, at, number in by_block(reduced, parts.block):
        out[at], _ = own.acts(reduced.forms[number], parts.u[at, : own.shape])
    return np.swapaxes(out, 1, 2)


def best_amounts(reduced: LeastSquaresForm, parts: Parts) -> Parts:
    """The same shapes in the amounts that leave least (each at least a trifle of the common scale)."""
    A = unit_torque(reduced, parts)
    H = np.swapaxes(A, 1, 2) @ A
    ridge = 1e-9 * np.trace(H, axis1=1, axis2=2)[:, None, None] * np.eye(H.shape[1]) + 1e-300 * np.eye(H.shape[1])
    k = -np.linalg.solve(H + ridge, np.swapaxes(A, 1, 2) @ reduced.d[:, None])[..., 0]
    floor = 0.05 * np.abs(k).max(axis=1, keepdims=True)
    return Parts(parts.block, np.maximum(k, np.maximum(floor, 1e-9)), parts.u)


def polish(
    reduced: LeastSquaresForm, start: Parts, iterations: int = ITERATIONS, price: Array | None = None
) -> tuple[Parts, Array]:
    """Improve every set of a batch.

    Args:
        price: (batch,) of what the parts cost, see `limits`: then the mean square plus that is what is lowered.

    Returns:
        The improved sets and their root mean square torque (batch,), as a share of the unbalanced one.
    """
    reference = np.log(start.k)
    now, damping = Parts(start.block, start.k.copy(), start.u.copy()), np.full(len(start), 1e-3)
    price = np.zeros(len(start)) if price is None else price
    r = _priced(reduced, now, price)
    cost = np.einsum("br,br->b", r, r)
    alive = np.ones(len(start), bool)
    slow = np.zeros(len(start), int)
    for _ in range(iterations):
        batch = np.flatnonzero(alive)
        if not len(batch):
            break
        trial = _step(reduced, now[batch], r[batch], damping[batch], reference[batch], price[batch])
        r_trial = _priced(reduced, trial, price[batch])
        cost_trial = np.einsum("br,br->b", r_trial, r_trial)
        better = cost_trial < cost[batch]
        gain = 1 - cost_trial / np.maximum(cost[batch], 1e-300)
        accepted = batch[better]
        for mine, new in ((now.k, trial.k), (now.u, trial.u), (r, r_trial), (cost, cost_trial)):
            mine[accepted] = new[better]
        damping[batch] = np.clip(np.where(better, damping[batch] * 0.2, damping[batch] * 8.0), 1e-14, 1e8)
        slow[batch] = np.where(better & (gain > 1e-4), 0, slow[batch] + 1)
        alive[batch] = (cost[batch] > STALL**2) & (slow[batch] < 15) & (damping[batch] < 1e7)
    torque = residual(reduced, now)
    return now, np.sqrt(np.einsum("br,br->b", torque, torque) + reduced.rest**2)


def _priced(reduced: LeastSquaresForm, parts: Parts, price: Array) -> Array:
    """(batch, rows): the residual, and of each part the root of its price, so that squares add up."""
    r = residual(reduced, parts)
    return np.hstack([r, np.sqrt(price[:, None] * charges(reduced, parts)[0])]) if reduced.limits else r


def _priced_slopes(reduced: LeastSquaresForm, x: Parts, price: Array) -> Array:
    """The derivative of `_priced`."""
    J = jacobian(reduced, x)
    if not reduced.limits:
        return J
    charge, slopes = charges(reduced, x)
    root = np.sqrt(price[:, None] / np.maximum(charge, 1e-300))[..., None] / 2 * slopes
    B, S, width = slopes.shape
    own = np.zeros((B, S, S, width))
    own[:, np.arange(S), np.arange(S)] = root
    return np.concatenate([J, own.reshape(B, S, S * width)], axis=1)


def _step(reduced: LeastSquaresForm, x: Parts, r: Array, damping: Array, reference: Array, price: Array) -> Parts:
    """One damped Gauss-Newton step, projected onto possible shapes, with outward directions at the boundary frozen."""
    J = _priced_slopes(reduced, x, price)
    B, S, width = *x.k.shape, 1 + x.u.shape[2]
    free = free_steps(reduced, x, np.einsum("bri,br->bi", J, r).reshape(B, S, width))
    J = (J.reshape(B, -1, S, width).transpose(0, 2, 1, 3) @ free).transpose(0, 2, 1, 3).reshape(B, -1, S * width)
    H, g = np.swapaxes(J, 1, 2) @ J, np.einsum("bri,br->bi", J, r)
    diagonal = np.einsum("bii->bi", H)  # a view: the damping goes onto H itself
    diagonal += damping[:, None] * (diagonal + 1e-6 * diagonal.max(axis=1, keepdims=True) + 1e-30)
    step = (free @ -np.linalg.solve(H, g[..., None]).reshape(B, S, width, 1))[..., 0]
    step[..., 1:] = np.clip(step[..., 1:], -1, 1)
    log_k = np.log(x.k)
    step[..., 0] = np.clip(np.clip(step[..., 0], -2, 2), reference - LOG_RANGE - log_k, reference + LOG_RANGE - log_k)
    return x.moved(reduced, step)


def jacobian(reduced: LeastSquaresForm, x: Parts) -> Array:
    """(batch, rows, parts (1 + shape)) derivative of `residual`: for each part by its log amount and by its shape."""
    J = np.zeros((*x.k.shape, len(reduced.d), 1 + x.u.shape[2]))
    for own, at, number in by_block(reduced, x.block):
        J[at, :, 0], J[at, :, 1 : 1 + own.shape] = own.acts(reduced.forms[number], x.u[at, : own.shape])
    J *= x.k[..., None, None]
    return J.transpose(0, 2, 1, 3).reshape(len(x), len(reduced.d), -1)


def charges(reduced: LeastSquaresForm, parts: Parts, number: int | None = None) -> tuple[Array, Array]:
    """What each part costs, in shares of the limits (batch, parts), and its derivative (batch, parts, 1 + shape).

    Of all limits together, or of the one with this number; by the logarithm of the amount, and by the shape.
    """
    limits = reduced.limits if number is None else reduced.limits[number : number + 1]
    found, slopes = np.zeros(parts.k.shape), np.zeros((*parts.k.shape, 1 + parts.u.shape[2]))
    for own, at, block in by_block(reduced, parts.block):
        u, k = parts.u[at, : own.shape], parts.k[at]
        for limit in limits:
            found[at] += k * (own.part(u) @ limit.charge[block])
            slopes[at, 1 : 1 + own.shape] += k[:, None] * (own.slopes(u) @ limit.charge[block])
    slopes[..., 0] = found
    return found, slopes


def capped(reduced: LeastSquaresForm, parts: Parts) -> Parts:
    """The sets with amounts so much less, where a set costs more than a limit."""
    most = np.ones(len(parts))
    for i in range(len(reduced.limits)):
        most = np.maximum(most, charges(reduced, parts, i)[0].sum(axis=1))
    return Parts(parts.block, parts.k / most[:, None], parts.u)


def limited(reduced: LeastSquaresForm, start: Parts) -> tuple[Parts, Array]:
    """Improve every set of a batch within the limits: at the price at which it just costs them, by halving.

    Returns:
        As `polish`.
    """
    best = capped(reduced, start)
    value = rms_of(reduced, best)
    low, high = np.full(len(start), LEAST_PRICE), np.full(len(start), MOST_PRICE)
    for _ in range(HALVINGS):
        price = np.sqrt(low * high)
        found, _ = polish(reduced, best, SHORT, price)
        over = (capped(reduced, found).k < found.k * (1 - 1e-9)).any(axis=1)
        low, high = np.where(over, price, low), np.where(over, high, price)
        fit = capped(reduced, found)
        new = rms_of(reduced, fit)
        better = new < value
        for mine, own in ((best.k, fit.k), (best.u, fit.u), (value, new)):
            mine[better] = own[better]
    return best, value


def rms_of(reduced: LeastSquaresForm, parts: Parts) -> Array:
    """(batch,) root mean square torque that sets of parts leave, as a share of the unbalanced one."""
    return np.hypot(np.linalg.norm(residual(reduced, parts), axis=1), reduced.rest)


def free_steps(reduced: LeastSquaresForm, x: Parts, gradient: Array) -> Array:
    """(B, S, 1 + shape, 1 + shape) projectors onto the directions a step may take."""
    free = np.zeros((*gradient.shape, gradient.shape[2]))
    free[..., 0, 0] = 1.0
    for own, at, _ in by_block(reduced, x.block):
        within = slice(1, 1 + own.shape)
        free[at, within, within] = own.free(x.u[at, : own.shape], gradient[at, within])
    return free
