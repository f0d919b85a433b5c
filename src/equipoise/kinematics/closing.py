"""Loop equations, Newton and paths, compiled: a pose at a time, whose numbers stay in the first cache.

The equations are those of `closure`, the paths those of `continuation`. q are the n coordinates of the spanning tree: m
of them independent, d dependent. A Jacobian is kept by columns: (n, count), in units of `scale`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

from ..model.arrays import Array, Integers
from ..model.compiled import Compiled
from .tolerances import CLOSED, ITERATIONS, LEAST, OPPOSITE, STALLED, STRAY


class Loops(NamedTuple):
    """A tree and its loops as arrays.

    Attributes:
        link: (links, 5) body, parent, base, its first motion and the one after its last; outwards.
        R0, p0: (links, 3, 3), (links, 3) [m] at zero.
        row, turns: (motions,) of s, in the links' order; and whether it turns.
        axis: (motions, 3); turning: (motions, 3, 3, 3) what is constant, times cos and times sin in its rotation.
        C, s0: s = C q + s0.
        ends, points: (loops, 2) bodies, (loops, 2, 3) [m] in them.
        hinge: (hinges,) loops; along: (hinges, 3) axes in body_a; frame: (hinges, 3, 3) rows e, e, b in body_b.
        scale: (n,) unit of each coordinate; size: [m] unit of lengths.
        independent, dependent: numbers of coordinates.
    """

    link: Integers
    R0: Array
    p0: Array
    row: Integers
    turns: Integers
    axis: Array
    turning: Array
    C: Array
    s0: Array
    ends: Integers
    points: Array
    hinge: Integers
    along: Array
    frame: Array
    scale: Array
    size: float
    independent: Integers
    dependent: Integers


@register_jitable
def _turned(A, x):
    return (
        A[0, 0] * x[0] + A[0, 1] * x[1] + A[0, 2] * x[2],
        A[1, 0] * x[0] + A[1, 1] * x[1] + A[1, 2] * x[2],
        A[2, 0] * x[0] + A[2, 1] * x[1] + A[2, 2] * x[2],
    )


@register_jitable
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@register_jitable
def _dot(a, b):
    total = 0.0
    for i in range(len(a)):
        total += a[i] * b[i]
    return total


@register_jitable
def _product(A, B, out):
    for k in range(3):
        a, b, c = A[k, 0], A[k, 1], A[k, 2]
        for j in range(3):
            out[k, j] = a * B[0, j] + b * B[1, j] + c * B[2, j]


@register_jitable
def _place(t, q, R, p, z):
    """Orientations R (bodies, 3, 3), origins p (bodies, 3) and axes z (motions, 3) in the world."""
    turn = np.empty((3, 3))
    for i in range(len(t.link)):
        body, parent, base, first, last = t.link[i]
        step = _turned(R[parent], t.p0[i])
        for k in range(3):
            p[body, k] = p[parent, k] + step[k]
        _product(R[base], t.R0[i], R[body])
        before = base
        for m in range(first, last):
            s = t.s0[t.row[m]] + _dot(t.C[t.row[m]], q)
            if t.turns[m]:
                c, d = np.cos(s), np.sin(s)
                for k in range(3):
                    for j in range(3):
                        turn[k, j] = t.turning[m, 0, k, j] + c * t.turning[m, 1, k, j] + d * t.turning[m, 2, k, j]
                _product(R[before], turn, R[body])
                before = body
            axis = _turned(R[body], t.axis[m])
            for k in range(3):
                z[m, k] = axis[k]
                p[body, k] += 0.0 if t.turns[m] else s * axis[k]


@register_jitable
def _tilt(t, h, R):
    """Of a hinge: its axis a, the vectors e, e and b, and their cosines with a."""
    a, b = t.ends[t.hinge[h]]
    axis, e = _turned(R[a], t.along[h]), (_turned(R[b], t.frame[h, 0]), _turned(R[b], t.frame[h, 1]))
    along = _turned(R[b], t.frame[h, 2])
    return axis, e, along, _dot(e[0], axis), _dot(e[1], axis), _dot(along, axis)


@register_jitable
def _residual(t, R, p, r):
    """What is left of the equations (count,), as shares of the size; returns the largest."""
    for i in range(len(t.ends)):
        a, b = t.ends[i]
        from_a, from_b = _turned(R[a], t.points[i, 0]), _turned(R[b], t.points[i, 1])
        for k in range(3):
            r[3 * i + k] = (p[b, k] + from_b[k] - p[a, k] - from_a[k]) / t.size
    for h in range(len(t.hinge)):
        _, _, _, x, y, c = _tilt(t, h, R)
        at, down = 3 * len(t.ends) + 2 * h, max(1 + c, OPPOSITE)
        r[at], r[at + 1] = 2 * x / down, 2 * y / down
    largest = 0.0
    for x in r:
        largest = max(largest, abs(x)) if x == x else np.inf
    return largest


@register_jitable
def _jacobian(t, R, p, z, w, v, J):
    """J (n, count) of the residual; w and v (bodies, n, 3) become the velocities."""
    for i in range(len(t.link)):
        body, parent, base, first, last = t.link[i]
        step = (p[body, 0] - p[parent, 0], p[body, 1] - p[parent, 1], p[body, 2] - p[parent, 2])
        for j in range(len(t.scale)):
            moved = _cross(w[parent, j], step)
            for k in range(3):
                v[body, j, k] = v[parent, j, k] + moved[k]
                w[body, j, k] = w[base, j, k]
        for m in range(first, last):
            for j in range(len(t.scale)):
                ratio = t.C[t.row[m], j] * t.scale[j]
                if ratio != 0.0:
                    for k in range(3):
                        if t.turns[m]:
                            w[body, j, k] += ratio * z[m, k]
                        else:
                            v[body, j, k] += ratio * z[m, k]
    for i in range(len(t.ends)):
        a, b = t.ends[i]
        from_a, from_b = _turned(R[a], t.points[i, 0]), _turned(R[b], t.points[i, 1])
        for j in range(len(t.scale)):
            rate_a, rate_b = _cross(w[a, j], from_a), _cross(w[b, j], from_b)
            for k in range(3):
                J[j, 3 * i + k] = (v[b, j, k] + rate_b[k] - v[a, j, k] - rate_a[k]) / t.size
    for h in range(len(t.hinge)):
        a, b = t.ends[t.hinge[h]]
        axis, e, along, x, y, c = _tilt(t, h, R)
        down, at = max(1 + c, OPPOSITE), 3 * len(t.ends) + 2 * h
        bend = 2.0 / down**2 if down > OPPOSITE else 0.0
        sides = _cross(axis, e[0]), _cross(axis, e[1]), _cross(axis, along)
        for j in range(len(t.scale)):
            turn = (w[a, j, 0] - w[b, j, 0], w[a, j, 1] - w[b, j, 1], w[a, j, 2] - w[b, j, 2])
            closer = bend * _dot(turn, sides[2])
            J[j, at] = 2 * _dot(turn, sides[0]) / down - x * closer
            J[j, at + 1] = 2 * _dot(turn, sides[1]) / down - y * closer


@register_jitable
def _solve(M, d):
    """Least squares by Householder. M (d + k, e): the d columns of the matrix, then k right sides.

    The first d of each right side become its answer. Returns the condition number of the matrix, by Frobenius' norm.
    """
    e = M.shape[1]
    for j in range(d):
        u = M[j]
        norm = np.sqrt(_dot(u[j:], u[j:]))
        pivot = -norm if u[j] > 0 else norm
        u[j] -= pivot
        length = _dot(u[j:], u[j:])
        if length > 0:
            for c in range(j + 1, len(M)):
                share = 2 * _dot(u[j:], M[c, j:]) / length
                for i in range(j, e):
                    M[c, i] -= share * u[i]
        u[j] = pivot if abs(pivot) > LEAST else LEAST
    for c in range(d, len(M)):
        for i in range(d - 1, -1, -1):
            M[c, i] /= M[i, i]
            for k in range(i):
                M[c, k] -= M[i, k] * M[c, i]
    forward, backward, inverse = 0.0, 0.0, np.empty(d)
    for j in range(d):  # columns of the triangle and of its inverse
        inverse[: j + 1] = 0.0
        inverse[j] = 1.0
        for i in range(j, -1, -1):
            inverse[i] /= M[i, i]
            for k in range(i):
                inverse[k] -= M[i, k] * inverse[i]
            forward += M[j, i] ** 2
            backward += inverse[i] ** 2
    return np.sqrt(forward) * np.sqrt(backward) if d else 1.0


@register_jitable
def _same_side(before, after):
    """Whether the orientation of columns (d, count) has not flipped: no singular pose lies between."""
    d = len(before)
    G, sign = np.empty((d, d)), 1.0
    for i in range(d):
        for j in range(d):
            G[i, j] = _dot(before[i], after[j])
    for j in range(d):
        best = j + np.abs(G[j:, j]).argmax()
        if not abs(G[best, j]) > 0:
            return False
        sign *= np.sign(G[best, j]) * (1 if best == j else -1)
        for k in range(j, d):
            G[j, k], G[best, k] = G[best, k], G[j, k]
        for i in range(j + 1, d):
            share = G[i, j] / G[j, j]
            for k in range(j, d):
                G[i, k] -= share * G[j, k]
    return sign > 0


@register_jitable
def _room(t, bodies, count):
    """R, p, z, w, v and the Jacobian of a pose."""
    n = len(t.scale)
    R, p, z = np.zeros((bodies, 3, 3)), np.zeros((bodies, 3)), np.empty((len(t.row), 3))
    R[0] = np.eye(3)
    return R, p, z, np.zeros((bodies, n, 3)), np.zeros((bodies, n, 3)), np.empty((n, count))


def _at(t, q, bodies, residual, J):
    R, p, z, w, v, columns = _room(t, bodies, residual.shape[1])
    for i in range(len(q)):
        _place(t, q[i], R, p, z)
        _residual(t, R, p, residual[i])
        _jacobian(t, R, p, z, w, v, columns)
        J[i] = columns.T


def _tangents(t, q, bodies, T, J, condition):
    d = len(t.dependent)
    R, p, z, w, v, columns = _room(t, bodies, J.shape[2])
    M = np.empty(columns.shape)
    for i in range(len(q)):
        _place(t, q[i], R, p, z)
        _jacobian(t, R, p, z, w, v, columns)
        M[:d], M[d:] = columns[t.dependent], columns[t.independent]
        J[i] = M[:d]
        condition[i] = _solve(M, d)
        T[i] = -M[d:, :d].T


def _paths(t, bodies, start, T0, J0, which, goal, shortest, q, done):
    d, m = len(t.dependent), len(t.independent)
    count = J0.shape[2]
    R, p, z, w, v, columns = _room(t, bodies, count)
    M, r = np.empty((d + m + 1, count)), np.empty(count)
    J, T, new_J = np.empty((d, count)), np.empty((d, m)), np.empty((d, count))
    for i in range(len(goal)):
        now = q[i]
        now[:], J[:], T[:] = start[which[i]], J0[which[i]], T0[which[i]]
        origin = now[t.independent]
        length = np.abs((goal[i] - origin) / t.scale[t.independent]).max() if m else 0.0
        reached, step = 0.0, 1.0
        while True:
            to = min(reached + step, 1.0)
            trial = now.copy()
            for k in range(m):
                c = t.independent[k]
                trial[c] = goal[i, k] if to == 1.0 else origin[k] + to * (goal[i, k] - origin[k])
                for j in range(d):
                    e = t.dependent[j]
                    trial[e] += T[j, k] * (trial[c] - now[c]) / t.scale[c] * t.scale[e]
            found, closed, before = trial.copy(), False, np.inf
            new_J[:] = 0.0
            for iteration in range(ITERATIONS):
                _place(t, found, R, p, z)
                size = _residual(t, R, p, r)
                if iteration:
                    closed = size < CLOSED
                    if closed or not size < (STALLED if iteration > 1 else 2.0) * before:
                        break
                    before = size
                _jacobian(t, R, p, z, w, v, columns)
                M[:d], M[d : d + m], M[d + m] = columns[t.dependent], columns[t.independent], r
                new_J[:] = M[:d]
                _solve(M, d)
                for k in range(d):
                    found[t.dependent[k]] -= min(max(M[d + m, k], -1.0), 1.0) * t.scale[t.dependent[k]]
            near = closed and np.abs((found - trial) / t.scale).max() < STRAY
            if near and _same_side(J, new_J):
                now[:], J[:], T[:], reached = found, new_J, -M[d : d + m, :d].T, to
                step *= 2
                if to == 1.0:
                    done[i] = True
                    break
            else:
                step /= 2
            if not step * length >= shortest:
                break


at, tangents, paths = Compiled(_at), Compiled(_tangents), Compiled(_paths)
