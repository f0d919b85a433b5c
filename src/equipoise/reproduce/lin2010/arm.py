"""The industrial arm of lin2010, Sec. 6, its balanced form by the method `pseudobase`, and its motion."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from ...io.dh import expand
from ...io.schema import DhRow, DhTable
from ...kinematics.motion import CubicMove, follow
from ...model.arrays import Array
from ...model.mechanism import Body, Mechanism
from ...synthesis import Design, design
from .tables import HEIGHT, TABLE_1, TABLE_2, TABLE_3, TABLE_4, point

UNFOLDED = {2: 2.8, 3: -0.85, 4: -2.5, 5: 0.8, 6: 2.7}  # [rad] a pose in which no module is nearly folded
SWING = 0.3  # [rad] either way
TIMES = np.linspace(0, 10, 1001)  # [s]


def arm() -> Mechanism:
    """The bare arm: Tables 1 and 2. The mass of link 1, which no height depends on, is not printed."""
    bodies = [Body("link 1")]
    bodies += [Body(f"link {i}", float(row.m), point(row.s)) for i, row in TABLE_2.items()]
    rows = [DhRow(name=f"joint {i}", a=a, alpha=alpha, d=d, theta=0.0) for i, (d, a, alpha) in TABLE_1.items()]
    all_bodies, joints = expand(DhTable(convention="standard", rows=rows), bodies)
    return Mechanism("industrial arm", tuple(body for body, _ in all_bodies), tuple(joint for joint, _ in joints))


@cache
def balanced(real: bool = False) -> Design:
    """The arm balanced by the method, with the masses of Table 2 and the K and l_CA of Table 3.

    Args:
        real: with the joints of Fig. 3, ball joints and all, over ranges in which no module folds.
    """
    bare = arm()
    if real:
        ranges = {f"joint {i}": (q - SWING, q + SWING) for i, q in UNFOLDED.items()}
        joints = (replace(joint, range=ranges.get(joint.name)) for joint in bare.joints)
        bare = replace(bare, joints=tuple(joints))
    return design(
        bare,
        "pseudobase",
        height=HEIGHT,
        stiffness={f"link {i}": row.K for i, row in TABLE_3.items()},
        l_CA={f"link {i}": row.l_CA for i, row in TABLE_3.items()},
        centre={f"link {i}": point(row.c) for i, row in TABLE_2.items()},
        auxiliary_mass={f"link {i}": float(row.m_hat) for i, row in TABLE_2.items()},
        auxiliary_com={f"link {i}": point(row.s_hat) for i, row in TABLE_2.items()},
        pseudobase={f"link {i}": float(row.m_base) for i, row in TABLE_2.items()},
        planar=(),  # the paper's modules are all RSSR
        real=real,
    )


def motion() -> Array:
    """(T, 6) the joint angles of Eq. (26) at `TIMES` [rad]."""
    return follow(arm().coordinates, moves().values(), TIMES)


def moves() -> dict[int, CubicMove]:
    """The moves of Table 4."""
    return {i: CubicMove(f"joint {i}", *row[:4]) for i, row in TABLE_4.items()}
