"""Paths of closed poses, compiled: see `continuation`. The notation is that of `closing`."""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

from ..model.compiled import Compiled
from . import closing, tolerances
from .closing import copy, equations, inner, jacobian, place, room_for, solve, take
from .tolerances import CLOSED, DESCENT, ITERATIONS, LEAST, NEAR, OPEN, STALLED, STRAY, STUCK, WINDOW


@register_jitable
def _same_side(before, after, G):
    """Whether the orientation of columns (d, count) has not flipped: no singular pose lies between.

    G (d, d) is room.
    """
    d, count = before.shape
    for i in range(d):
        for j in range(d):
            G[i, j] = inner(before[i], after[j], 0, count)
    sign = True
    for j in range(d):
        best = j
        for i in range(j + 1, d):
            if abs(G[i, j]) > abs(G[best, j]):
                best = i
        if not abs(G[best, j]) > 0:
            return False
        sign = sign == ((G[best, j] > 0) == (best == j))
        for k in range(j, d):
            G[j, k], G[best, k] = G[best, k], G[j, k]
        for i in range(j + 1, d):
            share = G[i, j] / G[j, j]
            for k in range(j, d):
                G[i, k] -= share * G[j, k]
    return sign


@register_jitable
def _hopeless(t, q, trial, room, M):
    """Whether the loops stay open at these independent coordinates: least squares from q get stuck far from zero.

    That is no proof: another start may lead to a closed pose. Changes q; `trial` (n,), M (d + 2, count + d) are room.
    """
    d = len(t.dependent)
    R, p, z, w, v, columns = room
    count = columns.shape[1]
    damping, fresh = 1e-3, True
    now, new = M[d + 1], M[d]
    place(t, q, R, p, z)
    equations(t, R, p, now)
    before = np.sqrt(inner(now, now, 0, count))
    earlier = np.inf
    for step in range(DESCENT):
        if before < NEAR:
            return False
        if step % WINDOW == 0:
            if before > STUCK * earlier:
                return before > OPEN
            earlier = before
        if fresh:
            jacobian(t, R, p, z, w, v, columns)
        take(t.dependent, columns, M, 0)
        copy(now, new)
        for k in range(d):
            for i in range(d):
                M[k, count + i] = np.sqrt(damping) * before if i == k else 0.0
            new[count + k] = 0.0
        solve(M[: d + 1], d)
        longest = LEAST
        for k in range(d):
            longest = max(longest, abs(new[k]))
        copy(q, trial)
        for k in range(d):
            trial[t.dependent[k]] -= min(1.0, 0.7 / longest) * new[k] * t.scale[t.dependent[k]]
        place(t, trial, R, p, z)
        equations(t, R, p, new)
        size = np.sqrt(inner(new, new, 0, count))
        fresh = size < before
        if fresh:
            copy(trial, q)
            copy(new, now)
            before, damping = size, max(damping / 10, 1e-9)
        else:
            damping *= 10
    return False


def _follow(t, bodies, start, T0, J0, which, goal, shortest, q, done):
    n, d, m, count = len(t.scale), len(t.dependent), len(t.independent), J0.shape[2]
    room = room_for(t, bodies, count)
    R, p, z, w, v, columns = room
    M, wide, G = np.empty((d + m + 1, count)), np.empty((d + 2, count + d)), np.empty((d, d))
    J, T, new_J = np.empty((d, count)), np.empty((d, m)), np.empty((d, count))
    trial, found, origin = np.empty(n), np.empty(n), np.empty(m)
    for i in range(len(goal)):
        now = q[i]
        copy(start[which[i]], now)
        for k in range(d):
            copy(J0[which[i], k], J[k])
            copy(T0[which[i], k], T[k])
        length, reached, step = 0.0, 0.0, 1.0
        for k in range(m):
            origin[k] = now[t.independent[k]]
            length = max(length, abs(goal[i, k] - origin[k]) / t.scale[t.independent[k]])
        while True:
            to = min(reached + step, 1.0)
            copy(now, trial)
            for k in range(m):
                c = t.independent[k]
                trial[c] = goal[i, k] if to == 1.0 else origin[k] + to * (goal[i, k] - origin[k])
                for j in range(d):
                    trial[t.dependent[j]] += T[j, k] * (trial[c] - now[c]) / t.scale[c] * t.scale[t.dependent[j]]
            copy(trial, found)
            good, before = False, np.inf
            for iteration in range(ITERATIONS):
                place(t, found, R, p, z)
                size = equations(t, R, p, M[d + m])
                if iteration:
                    good = size < CLOSED
                    if good or not size < (STALLED if iteration > 1 else 2.0) * before:
                        break
                    before = size
                jacobian(t, R, p, z, w, v, columns)
                take(t.dependent, columns, M, 0)
                take(t.dependent, columns, new_J, 0)
                take(t.independent, columns, M, d)
                solve(M, d)
                for k in range(d):
                    found[t.dependent[k]] -= min(max(M[d + m, k], -1.0), 1.0) * t.scale[t.dependent[k]]
            for k in range(n):
                good = good and abs(found[k] - trial[k]) / t.scale[k] < STRAY
            if good and _same_side(J, new_J, G):
                copy(found, now)
                for j in range(d):
                    copy(new_J[j], J[j])
                    for k in range(m):
                        T[j, k] = -M[d + k, j]
                reached, step = to, 2 * step
                if to == 1.0:
                    done[i] = True
                    break
            else:
                if step == 1.0 and reached == 0.0:
                    copy(now, found)
                    for k in range(m):
                        found[t.independent[k]] = goal[i, k]
                    if _hopeless(t, found, trial, room, wide):
                        break
                step /= 2
            if not step * length >= shortest:
                break


follow = Compiled(_follow, closing, tolerances)
