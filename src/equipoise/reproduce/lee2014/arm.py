"""The arm of lee2014, Tables 4 and 5: bare, with the springs as printed, and with them made exact."""

from __future__ import annotations

from functools import cache
from math import radians

import numpy as np

from ...kinematics.motion import CubicMove, follow
from ...model.arrays import Array
from ...model.errors import EquipoiseError
from ...model.mechanism import Body, Joint, Mechanism
from ...synthesis.planar.arm import Installation, PlanarArm, upward
from ...synthesis.planar.installing import STIFFNESS, A, B, Equations, Fixed
from .tables import POSES, TABLE_4, TIMES, Case, Printed


def arm() -> Mechanism:
    """The bare arm: Table 4."""
    links = {1: "world"} | {j: f"link {j}" for j in TABLE_4}
    reach = {2: 0.0} | {j + 1: r for j, (_, r, _) in TABLE_4.items()}
    return Mechanism(
        "Lee and Chen's arm",
        bodies=tuple(Body(links[j], m, (s, 0, 0)) for j, (m, _, s) in TABLE_4.items()),
        joints=tuple(
            Joint(f"joint {j}", "revolute", links[j - 1], links[j], (reach[j], 0, 0), axis=(0, -1, 0)) for j in TABLE_4
        ),
    )


@cache
def planar() -> PlanarArm:
    """The same as links of complex numbers."""
    return PlanarArm.of(arm(), end=TABLE_4[4][1])


def printed(case: Case) -> Mechanism:
    """The arm with the springs of Table 5, rounded as they are."""
    return with_springs(tuple(row.installed(float(row.a), float(row.b)) for row in case.rows))


def completed(case: Case, *free: float) -> tuple[Installation, ...]:
    """The springs of Table 5 with the lengths that were free as given or printed; the others exact, by (39)-(54)."""
    values = free or tuple(map(float, case.free_texts))
    fixed: Fixed = {(s, STIFFNESS): row.stiffness for s, row in enumerate(case.rows)}
    for (s, which), value in zip(case.free, values, strict=True):
        fixed |= {(s, which): _along(case.rows[s], which, value)}
    equations = Equations(planar(), case.layout, fixed=fixed)
    start = [
        (0.0, *(_along(row, which, float(text)) / equations.size for which, text in ((A, row.a), (B, row.b))))
        for row in case.rows
    ]
    x = equations.newton(equations.held(np.array(start)))
    springs = None if x is None else equations.installed(x)
    if springs is None:
        raise EquipoiseError(f"the design equations of Table 5({case.letter}) were not solved")
    return springs


def balanced(case: Case) -> Mechanism:
    """The arm with the springs of Table 5, completed."""
    return with_springs(completed(case))


def motion() -> Array:
    """(T, 3) the joint angles of section 8 at `TIMES` [rad]."""
    moves = [
        CubicMove(f"joint {j}", start, start + 1.0, radians(POSES[start][j - 2]), radians(POSES[start + 1][j - 2]))
        for j in TABLE_4
        for start in range(2)
    ]
    return follow(arm().coordinates, moves, TIMES)


def _along(row: Printed, which: int, value: float) -> float:
    """A length as `installing` counts it: along the link, the ground's upwards."""
    turn = 1j**row.alpha / upward(row.i) if which == A else 1j**row.beta
    return value * complex(turn).real


def with_springs(springs: tuple[Installation, ...]) -> Mechanism:
    """The arm with springs."""
    return arm().with_springs(planar().springs(springs))
