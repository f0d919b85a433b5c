"""The shoulder of cho2012, Sec. 4: bare, balanced by the method `bevel`, and its motion."""

from __future__ import annotations

from functools import cache
from math import pi

import numpy as np

from ...kinematics.motion import CubicMove, follow
from ...model.arrays import Array
from ...model.mechanism import Body, Joint, Mechanism
from ...synthesis import Design, design

G = 9.81  # [m/s^2]
M, L, H, B = "6.7", "0.164", "0.0685", "0.049"  # [kg, m, m, m] Sec. 4.1
ARRANGEMENT = "far"  # "the fixed bevel gear were located at the opposite side"

# Table 1: theta_1, theta_2 [rad]
TABLE_1 = {1: (0, -pi / 4), 2: (0, -3 * pi / 4), 3: (pi / 4, -3 * pi / 4), 4: (3 * pi / 4, -3 * pi / 4)}
JOINTS = ("roll", "pitch")
START = (0.0, -pi)  # theta_1, theta_2 at t = 0 [rad]
STAY, MOVE = 10.0, 2.0  # [s] from one pose to the next, and of the move in it
TIMES = np.linspace(0, STAY * len(TABLE_1), 801)  # [s]
GRID = (np.linspace(-pi, pi, 121), np.linspace(-pi, 0, 61))  # theta_1, theta_2 over the hemisphere [rad]
SOFT = 0.01


def arm() -> Mechanism:
    """The bare shoulder: roll about z_0, pitch about y_1, gravity along x_0; the ranges are the hemisphere."""
    return Mechanism(
        "roll-pitch shoulder",
        (Body("link 1"), Body("link 2", float(M), (float(L), 0.0, 0.0))),
        (
            Joint("roll", "revolute", "world", "link 1", axis=(0.0, 0.0, 1.0), range=(-pi, pi)),
            Joint("pitch", "revolute", "link 1", "link 2", axis=(0.0, 1.0, 0.0), range=(-pi, 0.0)),
        ),
        gravity=(G, 0.0, 0.0),
    )


@cache
def balanced(arrangement: str = ARRANGEMENT) -> Design:
    """The shoulder balanced by the method, with the paper's b and h."""
    return design(arm(), "bevel", b=float(B), h=float(H), arrangement=arrangement)


def scaled(share: float) -> Mechanism:
    """The balanced shoulder with the stiffness of both springs times a share."""
    m = balanced().mechanism
    return m.with_springs(spring.scaled(share) for spring in m.springs)


def motion() -> Array:
    """(T, 2) the shoulder through the poses of Table 1 at `TIMES` [rad], from link 2 fully raised (Sec. 4.2).

    Each pose is held until `STAY` after the last one; the paper does not print how long a move takes, `MOVE` here.
    """
    poses = [START, *TABLE_1.values()]
    moves = (
        CubicMove(name, n * STAY, n * STAY + MOVE, poses[n][j], poses[n + 1][j])
        for n in range(len(TABLE_1))
        for j, name in enumerate(JOINTS)
    )
    return follow(JOINTS, moves, TIMES)
