"""The robot of section 9, the one spring per leg that balances it, and places of its platform."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from ...model.arrays import Array
from ...model.mechanism import Mechanism
from ...synthesis.delta.legs import DeltaLeg, delta_legs
from ...synthesis.delta.method import one_per_leg
from ...synthesis.delta.robot import DeltaRobot
from ...synthesis.delta.workspace import Found, Goal

PAPER = "simionescu2015"
G = 9.81  # [m/s^2]
EXAMPLE = DeltaRobot()  # section 9: AB = CD = 0.5 m, the masses; the radii do not matter while they are equal
AV, AW, M7 = 0.25, 0.3, 1.8  # [m], [m], [kg] section 9
PRINTED_K = "583.699"  # [N/m]
HEIGHTS = (0.5, 0.8)  # [m] below the base
SAMPLES = 400  # random places of the platform, beside a grid with the corners
RANGE = (-4.354817, -3.45915)  # [rad] of theta_11, section 9
SWING = {"fig10": 3.5, "fig11": 2.6, "fig12": np.pi}  # [rad] theta_13
ASSUMED = "mass centres at mid-link and half the spring's mass at V assumed: the paper prints neither"


def weighted(robot: DeltaRobot) -> float:
    """m~ of (22) on the axis [kg]: the masses of a leg, with what they rise by over what B does."""
    com_2 = robot.upper / 2 if robot.com_2 is None else robot.com_2
    com_4 = robot.lower / 2 if robot.com_4 is None else robot.com_4
    rods = 2 * robot.link_4 * (1 + com_4 / robot.lower)
    return robot.link_2 * com_2 / robot.upper + robot.link_3 + rods + 2 * (robot.link_5 + robot.link_6 / 3)


def axis_stiffness(robot: DeltaRobot) -> float:
    """k7 [N/m] by (23), in closed form where AB = CD and the radii are equal."""
    return G * (weighted(robot) * robot.upper + 0.5 * M7 * AV) / (AV * AW)


@cache
def mechanism() -> Mechanism:
    """The robot without springs."""
    return EXAMPLE.mechanism("DELTA of the example")


@cache
def legs() -> tuple[DeltaLeg, ...]:
    """Its legs."""
    return delta_legs(mechanism())[0]


@cache
def sprung(goal: Goal = "axis", reach: float = 0.0, change: tuple[tuple[str, float], ...] = ()) -> Found:
    """The robot with one spring per leg, judged with the platform within +-`reach` [m] of the axis.

    Args:
        change: fields of `DeltaRobot` that differ from the example's.
    """
    options: dict[str, Any] = {"AV": AV, "AW": AW, "spring_7": M7, "heights": HEIGHTS, "samples": SAMPLES}
    robot = replace(EXAMPLE, **dict(change)).mechanism() if change else mechanism()
    return one_per_leg(robot, goal, reach=reach, **options)[1]


def printed() -> Mechanism:
    """The robot with springs of the stiffness in print."""
    m = sprung().mechanism
    return m.with_springs(spring.changed(stiffness=float(PRINTED_K)) for spring in m.springs)


def axis(low: float, high: float, count: int) -> Array:
    """(count, 3) places on the axis, so far below the base [m]."""
    return np.column_stack([np.zeros((count, 2)), -np.linspace(low, high, count)])


def actuators(places: Array) -> Array:
    """(N, 3) values of the joints A [rad] with the platform at `places` (N, 3) [m]."""
    return np.column_stack([leg.actuator(places) for leg in legs()])


def path(theta_13: float, count: int) -> tuple[Array, Array]:
    """(count,) theta_11 and (count, 3) joints A [rad] along a diagram of Figs. 10-12; NaN where it is out of reach.

    The platform moves straight below A's axis, theta_13 fixed. theta_11 counts from straight up, so that link 2 is at
    A = theta_11 + 3 pi/2 below the horizontal. E is in the plane of y and z through A, where AB cos A is
    CD cos(swing) sin(psi).
    """
    theta = np.linspace(*RANGE, count)
    A, swing = theta + 1.5 * np.pi, theta_13 - np.pi
    aside, lower = EXAMPLE.lower * np.sin(swing), EXAMPLE.lower * np.cos(swing)
    with np.errstate(invalid="ignore"):
        psi = np.arcsin(EXAMPLE.upper * np.cos(A) / lower)
    depth = EXAMPLE.upper * np.sin(A) + lower * np.cos(psi)
    u = actuators(np.column_stack([np.zeros_like(A), np.full_like(A, aside), -depth]))
    u[np.isnan(u).any(axis=1)] = np.nan
    return theta, u
