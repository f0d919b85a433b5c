"""Closed poses by Newton along straight paths of the independent coordinates, batched over poses.

Each pose starts from a closed one and steps towards its own goal: a step along the tangent, then Newton on the loop
equations with the independent coordinates held. A step counts only if the closed pose is near where the tangent led
and the Jacobian has kept its orientation: so the path never jumps to another way of assembling the mechanism. A step
that does not count is halved.
"""

from __future__ import annotations

import numpy as np

from ..model.arrays import Array, Booleans, Integers, frozen
from .closure import Closure

CLOSED = 1e-13  # residual, as a share of the mechanism's size
ITERATIONS = 7
STALLED = 0.5  # Newton gives up when the residual shrinks less than this
STRAY = 0.3  # [rad, or share of the size] how far the closed pose may be from where the tangent led
SHORTEST = 0.002  # [rad, or share of the size] no shorter step is tried, but for a whole path
CHUNK_ENTRIES = 300_000  # velocities held at a time: what stays in a processor's cache


@frozen
class Split:
    """Which coordinates of the tree are independent (m of them) and which depend on them."""

    independent: Integers
    dependent: Integers


def least_squares(J: Array, rhs: Array) -> tuple[Array, Array]:
    """Solve full-rank J (N, e, d) x = rhs (N, e, k) -> x (N, d, k), and the condition number of each J (N,).

    By orthogonal factors, so that no digits are lost to squaring; the condition number is that of the Frobenius norm.
    """
    if J.shape[2] == 0:
        return np.zeros((len(J), 0, rhs.shape[2])), np.ones(len(J))
    Q, R = np.linalg.qr(J)
    diagonal = np.einsum("nii->ni", R)
    diagonal[np.abs(diagonal) < 1e-200] = 1e-200  # exactly singular: a condition number, not a fault
    inverse = np.linalg.inv(R)
    x = inverse @ (np.swapaxes(Q, 1, 2) @ rhs)
    with np.errstate(over="ignore"):  # infinite where it is exactly singular
        return x, np.linalg.norm(R, axis=(1, 2)) * np.linalg.norm(inverse, axis=(1, 2))


def tangent(J: Array, split: Split) -> tuple[Array, Array]:
    """How dependent coordinates follow the independent ones (N, d, m), in units of their scales; conditions (N,)."""
    T, condition = least_squares(J[:, :, split.dependent], J[:, :, split.independent])
    return -T, condition


@np.errstate(over="ignore", invalid="ignore", divide="ignore")  # a stray iterate may be anywhere: it does not count
def follow(
    closure: Closure, split: Split, start: Array, T: Array, J: Array, goal: Array, shortest: float = SHORTEST
) -> tuple[Array, Booleans]:
    """Follow straight paths of the independent coordinates from closed poses.

    Args:
        start: (N, n) closed poses; `T` (N, d, m) and `J` (N, count, n) their tangents and Jacobians.
        goal: (N, m) values of the independent coordinates.
        shortest: the least step [rad, or share of the size]; close to a singular pose only short ones count.

    Returns:
        (N, n) closed poses at the goals, and (N,) which of them were reached; the others are anywhere.
    """
    q, done = start.copy(), np.zeros(len(start), bool)
    J, T = J[:, :, split.dependent].copy(), T.copy()
    origin, way = start[:, split.independent], goal - start[:, split.independent]
    length = np.abs(way / closure.scale[split.independent]).max(axis=1, initial=0)
    at, step = np.zeros(len(q)), np.ones(len(q))
    todo = np.arange(len(q))
    while len(todo):
        to = np.minimum(at[todo] + step[todo], 1.0)
        trial = q[todo]
        u = np.where(to[:, None] == 1.0, goal[todo], origin[todo] + to[:, None] * way[todo])
        move = (u - trial[:, split.independent]) / closure.scale[split.independent]
        trial[:, split.independent] = u
        trial[:, split.dependent] += (T[todo] @ move[:, :, None])[:, :, 0] * closure.scale[split.dependent]
        found, new_J, new_T, good = _newton(closure, split, trial)
        stray = np.abs((found - trial) / closure.scale).max(axis=1)
        good &= stray < STRAY
        good[good] &= _same_side(J[todo[good]], new_J[good])
        moved = todo[good]
        q[moved], J[moved], T[moved], at[moved] = found[good], new_J[good], new_T[good], to[good]
        step[moved] *= 2
        step[todo[~good]] /= 2
        done[moved] = at[moved] == 1.0
        todo = todo[~done[todo] & (step[todo] * length[todo] >= shortest)]
    return q, done


def _newton(closure: Closure, split: Split, q: Array) -> tuple[Array, Array, Array, Booleans]:
    """Close `q` (N, n) with the independent coordinates held: poses, last Jacobians, last tangents, which closed."""
    size = max(16, CHUNK_ENTRIES // (6 * closure.tree.n * len(closure.tree.names)))
    parts = [_newton_chunk(closure, split, q[i : i + size]) for i in range(0, len(q), size)]
    q, J, T, closed = (np.concatenate(found) for found in zip(*parts, strict=True))
    return q, J, T, closed


def _newton_chunk(closure: Closure, split: Split, q: Array) -> tuple[Array, Array, Array, Booleans]:
    q, closed = q.copy(), np.zeros(len(q), bool)
    J = np.zeros((len(q), closure.count, len(split.dependent)))
    T = np.zeros((len(q), len(split.dependent), len(split.independent)))
    before = np.full(len(q), np.inf)
    todo = np.arange(len(q))
    tree = closure.tree
    for i in range(ITERATIONS):
        poses = tree.poses(q[todo])
        residual = closure.residual(poses)
        size = np.abs(residual).max(axis=1)
        if i:
            closed[todo] = size < CLOSED
            going = (size >= CLOSED) & (size < (STALLED if i > 1 else 2.0) * before[todo])
            before[todo] = size
            todo, residual = todo[going], residual[going]
            poses = type(poses)(poses.R[going], poses.p[going], poses.s[going])
        if not len(todo):
            break
        whole = closure.jacobian(q[todo], poses)
        J[todo] = whole[:, :, split.dependent]
        rhs = np.concatenate([whole[:, :, split.independent], residual[:, :, None]], axis=2)
        x, _ = least_squares(J[todo], -rhs)
        T[todo] = x[:, :, :-1]
        q[np.ix_(todo, split.dependent)] += np.clip(x[:, :, -1], -1, 1) * closure.scale[split.dependent]
    return q, J, T, closed


def _same_side(before: Array, after: Array) -> Booleans:
    """(N,) whether no singular pose lies between: the orientation of the Jacobian's columns has not flipped."""
    if before.shape[2] == 0:
        return np.ones(len(before), bool)
    sign, _ = np.linalg.slogdet(np.swapaxes(before, 1, 2) @ after)
    return sign > 0
