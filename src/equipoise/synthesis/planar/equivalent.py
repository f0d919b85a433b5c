"""Other springs with the same effect: equivalent installations of Lee and Chen (2014), section 5.2, Eqs. (28a, b).

The stiffness block matrix of two springs is ``V^H V`` with a row ``sqrt(k) w`` for each, so every unitary mix of the
rows leaves it alone. Two springs between links i and k can be mixed until one of them acts from the joint of link i+1,
(28a), or on the joint at the end of link k-1, (28b): installed on that link, it spans one joint less.

A spring between neighbours shows off the diagonal by ``k conj(a) b`` alone: both angles may turn, and stiffness and
lengths change against each other.
"""

from __future__ import annotations

from cmath import exp
from dataclasses import replace
from math import sqrt
from typing import Literal

import numpy as np

from ...model.arrays import Complexes
from ...model.errors import InfeasibleError, UnsupportedError
from .arm import Installation, PlanarArm
from .stiffness_blocks import vector

ENTRY_ROUNDING = 1e-12  # of the largest entry of both rows

Pair = tuple[Installation, Installation]


def turned(one: Installation, angle: float) -> Installation:
    """A spring between neighbours with both its angles turned by `angle` [rad].

    Raises:
        UnsupportedError: it spans more than one joint, where angles count.
    """
    _only_neighbours(one)
    return replace(one, a=one.a * exp(1j * angle), b=one.b * exp(1j * angle))


def resized(one: Installation, a: float, b: float) -> Installation:
    """A spring between neighbours whose ends are `a` and `b` [m] from their joints, its stiffness to match.

    Raises:
        UnsupportedError: it spans more than one joint.
    """
    _only_neighbours(one)
    stiffness = one.stiffness * abs(one.a) * abs(one.b) / (a * b)
    return Installation(one.i, one.k, stiffness, a * one.a / abs(one.a), b * one.b / abs(one.b))


def exchanged(arm: PlanarArm, one: Installation, two: Installation, end: Literal["lower", "upper"]) -> Pair:
    """Two springs ik as ik and (i+1)k, Eq. (28a), or with their upper end moved as ik and i(k-1), (28b).

    Where both have the same ratio of a to b, both ends of the second one move at once, to (i+1)(k-1).

    Raises:
        UnsupportedError: they join different links, or neighbours.
        InfeasibleError: no two such springs have this effect.
    """
    if (one.i, one.k) != (two.i, two.k) or one.span < 2:
        raise UnsupportedError("only two springs between the same two links, not neighbours, can be exchanged")
    row = one.i - 1 if end == "lower" else one.k - 1
    x, y = (sqrt(spring.stiffness) * vector(arm, spring)[row] for spring in (one, two))
    Q = np.array([[x.conjugate(), y.conjugate()], [-y, x]], np.complex128) / sqrt(abs(x) ** 2 + abs(y) ** 2)
    return _mixed(arm, one, two, Q)


def rotated(arm: PlanarArm, one: Installation, two: Installation, angle: float) -> Pair:
    """Two springs mixed by `angle` [rad]: (28a, b) backwards, and all that lies between.

    They may join the same links, or one of them acts on the joint of a link that the other joins, as (28a, b) leave it.

    Raises:
        InfeasibleError: no two springs have this effect.
    """
    c, s = np.cos(angle), np.sin(angle)
    return _mixed(arm, one, two, np.array([[c, s], [-s, c]], complex))


def _mixed(arm: PlanarArm, one: Installation, two: Installation, Q: Complexes) -> Pair:
    rows = Q @ np.array([sqrt(spring.stiffness) * vector(arm, spring) for spring in (one, two)])
    scale = float(abs(rows).max())
    return _read(arm, rows[0], scale), _read(arm, rows[1], scale)


def _read(arm: PlanarArm, row: Complexes, scale: float) -> Installation:
    """The spring whose matrix is row^H row: the links between its ends all count alike."""
    acting = np.flatnonzero(abs(row) > ENTRY_ROUNDING * scale)
    if not len(acting):
        raise InfeasibleError("the two springs act as one")
    i, k = int(acting[0]), int(acting[-1])
    between = row[i + 1] if k > i + 1 else row[i]  # between neighbours any scale does: from the joint of link i
    off = abs(row[i + 1 : k] - between).max(initial=0)
    if k == i or abs(between) <= ENTRY_ROUNDING * scale or off > 1e-9 * abs(between):
        raise InfeasibleError("no two springs have this effect: one would join links without what lies between them")
    a, b = -row[i] / between * arm.lengths[i], row[k] / between * arm.lengths[k]
    return Installation(i + 1, k + 1, float(abs(between) ** 2), complex(a), complex(b))


def _only_neighbours(one: Installation) -> None:
    if one.span > 1:
        raise UnsupportedError(f"the spring {one.i}-{one.k} spans {one.span} joints: its angles and lengths count")
