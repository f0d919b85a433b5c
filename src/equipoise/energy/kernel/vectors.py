"""Vectors of symbols."""

from __future__ import annotations

from ...model.arrays import Array
from .flat_tree import Turn
from .trace import Trace, Value, Vector

ZERO: Vector = (0.0, 0.0, 0.0)


def add(t: Trace, rows: dict[int, Value], row: int, value: Value) -> None:
    """``rows[row] += value``."""
    rows[row] = t.add(rows.get(row, 0.0), value)


def constant(v: Array) -> Vector:
    x, y, z = (float(a) for a in v)
    return x, y, z


def angle_sum(t: Trace, a: tuple[Value, Value], turn: Turn) -> tuple[Value, Value]:
    """(cos, sin) of the sum of two angles."""
    c, s = a
    return t.sub(t.mul(c, turn.c), t.mul(s, turn.s)), t.add(t.mul(s, turn.c), t.mul(c, turn.s))


def about_z(t: Trace, turn: tuple[Value, Value], v: Vector) -> Vector:
    (c, s), (x, y, z) = turn, v
    return t.sub(t.mul(c, x), t.mul(s, y)), t.add(t.mul(s, x), t.mul(c, y)), z


def about_x(t: Trace, turn: Turn, v: Vector) -> Vector:
    (c, s), (x, y, z) = (turn.c, turn.s), v
    return x, t.sub(t.mul(c, y), t.mul(s, z)), t.add(t.mul(s, y), t.mul(c, z))


def plus(t: Trace, a: Vector, b: Vector) -> Vector:
    x, y, z = (t.add(u, v) for u, v in zip(a, b, strict=True))
    return x, y, z


def minus(t: Trace, a: Vector, b: Vector) -> Vector:
    return plus(t, a, scaled(t, -1.0, b))


def scaled(t: Trace, factor: Value, a: Vector) -> Vector:
    x, y, z = (t.mul(factor, u) for u in a)
    return x, y, z


def cross_z(t: Trace, a: Vector, b: Vector) -> Value:
    return t.sub(t.mul(a[0], b[1]), t.mul(a[1], b[0]))


def cross(t: Trace, a: Vector, b: Vector) -> Vector:
    return (
        t.sub(t.mul(a[1], b[2]), t.mul(a[2], b[1])),
        t.sub(t.mul(a[2], b[0]), t.mul(a[0], b[2])),
        cross_z(t, a, b),
    )
