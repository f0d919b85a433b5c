"""Loop equations, their Jacobian and least squares, compiled: a pose at a time, whose numbers stay in the first cache.

The equations are those of `closure`, whose `Loops` t are; q are the n coordinates of the spanning tree: m of them
independent, d dependent. A Jacobian is kept by columns: (n, count), in units of `scale`.
"""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

from ..model.compiled import Compiled
from . import tolerances
from .tolerances import LEAST, OPPOSITE


@register_jitable
def turned(A, x):
    return (
        A[0, 0] * x[0] + A[0, 1] * x[1] + A[0, 2] * x[2],
        A[1, 0] * x[0] + A[1, 1] * x[1] + A[1, 2] * x[2],
        A[2, 0] * x[0] + A[2, 1] * x[1] + A[2, 2] * x[2],
    )


@register_jitable
def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@register_jitable
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@register_jitable
def inner(a, b, first, last):
    total = 0.0
    for i in range(first, last):
        total += a[i] * b[i]
    return total


@register_jitable
def product(A, B, out):
    for k in range(3):
        a, b, c = A[k, 0], A[k, 1], A[k, 2]
        for j in range(3):
            out[k, j] = a * B[0, j] + b * B[1, j] + c * B[2, j]


@register_jitable
def place(t, q, R, p, z):
    """Orientations R (bodies, 3, 3), origins p (bodies, 3) and axes z (motions, 3) in the world."""
    turn = np.empty((3, 3))
    for i in range(len(t.link)):
        body, parent, base, first, last = t.link[i]
        step = turned(R[parent], t.p0[i])
        for k in range(3):
            p[body, k] = p[parent, k] + step[k]
        product(R[base], t.R0[i], R[body])
        before = base
        for m in range(first, last):
            s = t.s0[t.row[m]] + inner(t.C[t.row[m]], q, 0, len(q))
            if t.turns[m]:
                c, d = np.cos(s), np.sin(s)
                for k in range(3):
                    for j in range(3):
                        turn[k, j] = t.turning[m, 0, k, j] + c * t.turning[m, 1, k, j] + d * t.turning[m, 2, k, j]
                product(R[before], turn, R[body])
                before = body
            axis = turned(R[body], t.axis[m])
            for k in range(3):
                z[m, k] = axis[k]
                p[body, k] += 0.0 if t.turns[m] else s * axis[k]


@register_jitable
def tilt(t, h, R):
    """Of a hinge: its axis a, the vectors e, e and b, and their cosines with a."""
    a, b = t.ends[t.hinge[h]]
    axis, e = turned(R[a], t.along[h]), (turned(R[b], t.frame[h, 0]), turned(R[b], t.frame[h, 1]))
    along = turned(R[b], t.frame[h, 2])
    return axis, e, along, dot(e[0], axis), dot(e[1], axis), dot(along, axis)


@register_jitable
def equations(t, R, p, r):
    """What is left of the equations (count,), as shares of the size; returns the largest."""
    for i in range(len(t.ends)):
        a, b = t.ends[i]
        from_a, from_b = turned(R[a], t.points[i, 0]), turned(R[b], t.points[i, 1])
        for k in range(3):
            r[3 * i + k] = (p[b, k] + from_b[k] - p[a, k] - from_a[k]) / t.size
    for h in range(len(t.hinge)):
        _, _, _, x, y, c = tilt(t, h, R)
        at, down = 3 * len(t.ends) + 2 * h, max(1 + c, OPPOSITE)
        r[at], r[at + 1] = 2 * x / down, 2 * y / down
    largest = 0.0
    for i in range(3 * len(t.ends) + 2 * len(t.hinge)):
        largest = max(largest, abs(r[i])) if r[i] == r[i] else np.inf
    return largest


@register_jitable
def jacobian(t, R, p, z, w, v, J):
    """J (n, count) of the residual; w and v (bodies, n, 3) become the velocities."""
    for i in range(len(t.link)):
        body, parent, base, first, last = t.link[i]
        step = (p[body, 0] - p[parent, 0], p[body, 1] - p[parent, 1], p[body, 2] - p[parent, 2])
        for j in range(len(t.scale)):
            moved = cross(w[parent, j], step)
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
        from_a, from_b = turned(R[a], t.points[i, 0]), turned(R[b], t.points[i, 1])
        for j in range(len(t.scale)):
            rate_a, rate_b = cross(w[a, j], from_a), cross(w[b, j], from_b)
            for k in range(3):
                J[j, 3 * i + k] = (v[b, j, k] + rate_b[k] - v[a, j, k] - rate_a[k]) / t.size
    for h in range(len(t.hinge)):
        a, b = t.ends[t.hinge[h]]
        axis, e, along, x, y, c = tilt(t, h, R)
        down, at = max(1 + c, OPPOSITE), 3 * len(t.ends) + 2 * h
        bend = 2.0 / down**2 if down > OPPOSITE else 0.0
        sides = cross(axis, e[0]), cross(axis, e[1]), cross(axis, along)
        for j in range(len(t.scale)):
            turn = (w[a, j, 0] - w[b, j, 0], w[a, j, 1] - w[b, j, 1], w[a, j, 2] - w[b, j, 2])
            closer = bend * dot(turn, sides[2])
            J[j, at] = 2 * dot(turn, sides[0]) / down - x * closer
            J[j, at + 1] = 2 * dot(turn, sides[1]) / down - y * closer


@register_jitable
def solve(M, d):
    """Least squares by Householder. M (d + k, e): the d columns of the matrix, then k right sides.

    The first d of each right side become its answer. Returns the condition number of the matrix, by Frobenius' norm.
    """
    rows, e = M.shape
    for j in range(d):
        u = M[j]
        norm = np.sqrt(inner(u, u, j, e))
        pivot = -norm if u[j] > 0 else norm
        u[j] -= pivot
        length = inner(u, u, j, e)
        if length > 0:
            for c in range(j + 1, rows):
                share = 2 * inner(u, M[c], j, e) / length
                for i in range(j, e):
                    M[c, i] -= share * u[i]
        u[j] = pivot if abs(pivot) > LEAST else LEAST
    for c in range(d, rows):
        for i in range(d - 1, -1, -1):
            M[c, i] /= M[i, i]
            for k in range(i):
                M[c, k] -= M[i, k] * M[c, i]
    forward, backward, inverse = 0.0, 0.0, np.empty(d)
    for j in range(d):  # columns of the triangle and of its inverse
        for i in range(j):
            inverse[i] = 0.0
        inverse[j] = 1.0
        for i in range(j, -1, -1):
            inverse[i] /= M[i, i]
            for k in range(i):
                inverse[k] -= M[i, k] * inverse[i]
            forward += M[j, i] ** 2
            backward += inverse[i] ** 2
    return np.sqrt(forward) * np.sqrt(backward) if d else 1.0


@register_jitable
def room_for(t, bodies, count):
    """R, p, z, w, v and the Jacobian of a pose."""
    n = len(t.scale)
    R, p, z = np.zeros((bodies, 3, 3)), np.zeros((bodies, 3)), np.empty((len(t.row), 3))
    R[0, 0, 0] = R[0, 1, 1] = R[0, 2, 2] = 1.0
    return R, p, z, np.zeros((bodies, n, 3)), np.zeros((bodies, n, 3)), np.empty((n, count))


@register_jitable
def take(which, columns, M, first):
    """Copies some columns into the rows of M from `first` on."""
    for k in range(len(which)):
        for i in range(columns.shape[1]):
            M[first + k, i] = columns[which[k], i]


@register_jitable
def copy(x, out):
    for i in range(len(x)):
        out[i] = x[i]


def _at(t, q, bodies, residual, J):
    room = room_for(t, bodies, residual.shape[1])
    R, p, z, w, v, columns = room
    for i in range(len(q)):
        place(t, q[i], R, p, z)
        equations(t, R, p, residual[i])
        jacobian(t, R, p, z, w, v, columns)
        for j in range(len(columns)):
            for k in range(columns.shape[1]):
                J[i, k, j] = columns[j, k]


def _tangents(t, q, bodies, T, J, condition):
    d, m = len(t.dependent), len(t.independent)
    R, p, z, w, v, columns = room_for(t, bodies, J.shape[2])
    M = np.empty(columns.shape)
    for i in range(len(q)):
        place(t, q[i], R, p, z)
        jacobian(t, R, p, z, w, v, columns)
        take(t.dependent, columns, M, 0)
        take(t.dependent, columns, J[i], 0)
        take(t.independent, columns, M, d)
        condition[i] = solve(M, d)
        for j in range(d):
            for k in range(m):
                T[i, j, k] = -M[d + k, j]


at, tangents = Compiled(_at, tolerances), Compiled(_tangents, tolerances)
