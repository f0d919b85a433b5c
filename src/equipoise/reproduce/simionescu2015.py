"""Simionescu, Ciupitu and Ionita (2015): static balancing of DELTA robots.

The example gives neither the places of the mass centres nor how the spring's mass splits. Taken here: mass centres at
mid-link (links 3 and 5 on the axes of their joints), half the spring's mass at V, base and platform of equal radius.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..balance import check
from ..energy.evaluate import Potential
from ..kinematics import Tree
from ..model.arrays import Array
from ..model.mechanism import Body, Joint, Mechanism
from ..synthesis.delta.legs import DeltaLeg, delta_legs
from ..synthesis.delta.method import design, one_per_leg
from ..synthesis.delta.robot import DeltaRobot
from ..synthesis.delta.rocker import Guide, TwoAxisRocker
from ..synthesis.delta.workspace import Goal
from .record import Map, Plot, Reproduction, Row

PAPER = "simionescu2015"
CITATION = (
    'I. Simionescu, L. Ciupitu, L. C. Ionita, "Static balancing with elastic systems of DELTA parallel robots", '
    "Mechanism and Machine Theory 87 (2015) 150-162"
)
G = 9.81
EXAMPLE = DeltaRobot()  # section 9: AB = CD = 0.5 m, the masses; the radii do not matter while they are equal
AV, AW, M7 = 0.25, 0.3, 1.8  # [m], [m], [kg] section 9
PRINTED_K = "583.699"
HEIGHTS = (0.5, 0.8)  # [m] below the base
SPRING: dict[str, Any] = {"AV": AV, "AW": AW, "spring_7": M7, "heights": HEIGHTS}
RANGE = (-4.354817, -3.45915)  # [rad] of theta_11, section 9
SWING = {"fig10": 3.5, "fig11": 2.6, "fig12": np.pi}  # [rad] theta_13
ASSUMED = "mass centres at mid-link and half the spring's mass at V assumed: the paper prints neither"


def reproduction() -> Reproduction:
    """Everything the paper prints that can be computed, and what is wrong in it."""
    robot = EXAMPLE.mechanism("DELTA of the example")
    rows = [*_rocker(), *_example(robot), *_workspaces(robot), *_full()]
    return Reproduction(PAPER, CITATION, tuple(rows), (*_figures(robot), _map(robot)))


def two_axis_rocker(BF: float, CS: float, mass: float, com: float, printed: bool) -> Mechanism:
    """A rocker about two axes by itself with its guide (section 4): link 3 about B, link 4 about C on it."""
    guide = Guide(BF=BF, CS=CS, printed=printed)
    down = np.array([0.0, 0.0, -mass * com])
    parts = TwoAxisRocker("world", (0.0, 0.0, 0.0), "link 3", np.eye(3), (("B", 1.0),), 0.0, "link 4", 0.0, down)
    return Mechanism(
        "two-axis rocker",
        bodies=(Body("link 3"), Body("link 4", mass, (0.0, 0.0, -com)), *parts.bodies(guide, "")),
        joints=(
            Joint("B", "revolute", "world", "link 3", axis=(0.0, 1.0, 0.0)),
            Joint("C", "revolute", "link 3", "link 4", axis=(1.0, 0.0, 0.0)),
            *parts.joints(guide, ""),
        ),
        couplings=(parts.coupling(""),),
        springs=tuple(parts.springs(guide, "", G)),
    )


def _rocker() -> list[Row]:
    rows = []
    data = "BF = CS = 0.1 m, m4 = 1.2 kg, CG4 = 0.25 m"
    psi = np.column_stack([np.linspace(-1, 1, 201), np.zeros(201)])
    for printed in (True, False):
        rocker = two_axis_rocker(0.1, 0.1, 1.2, 0.25, printed)
        balance = check(rocker)
        name = "Eq. (8) as printed" if printed else "energy condition"
        wrong = "exact only if BF = 2 CS: k10 BF^2 stands as g (m4 CG4 + m10S CS)" if printed else ""
        variation = float(np.ptp(Potential(rocker)(psi).energy))
        item = f"{name}, energy variation over psi = +-1 rad"
        rows.append(Row(PAPER, item, None, variation, "J", erratum=wrong, note=data))
        largest = balance.total[1] - balance.total[0]
        rows.append(Row(PAPER, f"{name}, over all poses", None, largest, "J", erratum=wrong, note=data))
    twice = check(two_axis_rocker(0.2, 0.1, 1.2, 0.25, True))
    rows.append(Row(PAPER, "Eq. (8) as printed with BF = 2 CS", None, twice.total[1] - twice.total[0], "J", note=data))
    return rows


def _example(robot: Mechanism) -> list[Row]:
    _, found = one_per_leg(robot, "axis", **SPRING, reach=0.0)
    k = found.numbers["stiffness"]
    legs, _ = delta_legs(robot)
    u = _actuators(legs, _axis(HEIGHTS[0], HEIGHTS[1], 61))
    state = Potential(found.mechanism)(u)
    unbalanced = np.abs(Potential(robot)(u).gravity_torque[:, 0])
    level = float(unbalanced[0] / np.cos(np.arcsin(HEIGHTS[0] / (2 * EXAMPLE.upper))))  # goes with cos A on the axis
    reached = float(np.cos(np.array(RANGE) + 1.5 * np.pi).max())
    share = (float(PRINTED_K) * AV * AW / G - (k * AV * AW / G - 0.5 * M7 * AV)) / (M7 * AV)
    why = f"not printed what it rests on; {ASSUMED}"
    rows = [
        Row(PAPER, "k7, stiffness of the example (15)", PRINTED_K, k, "N/m", erratum=why),
        Row(PAPER, "k7, unit in section 9", None, k, "N/m", erratum="printed as Nm"),
        Row(PAPER, "share of the spring's mass at V that gives the printed k7", None, share, "", note=ASSUMED),
        Row(PAPER, "residual on the axis", None, float(np.abs(state.torque).max()), "N m", note="the paper: 0.006 N m, "
            "from its numerical computation"),
        Row(PAPER, "unbalanced moment at 0.5 m", None, float(unbalanced[0]), "N m", note=ASSUMED),
        Row(PAPER, "unbalanced moment, links 2 level", None, level, "N m", note=ASSUMED),
        Row(PAPER, "largest driving moment over the range of theta_11", "4e1", level * reached, "N m",
            note="printed as approximately 40 N m"),
    ]  # fmt: skip
    for what, change in {
        "mass centre of link 2 10 % further out": {"com_2": 1.1 * EXAMPLE.upper / 2},
        "mass centres of the rods 10 % further out": {"com_4": 1.1 * EXAMPLE.lower / 2},
        "platform 10 % heavier": {"link_6": 1.1 * EXAMPLE.link_6},
    }.items():
        altered = replace(EXAMPLE, **change).mechanism()
        _, other = one_per_leg(altered, "axis", **SPRING, reach=0.0)
        moved = 100 * (other.numbers["stiffness"] / k - 1)
        rows.append(Row(PAPER, f"sensitivity of k7: {what}", None, moved, "%"))
    places = _axis(*HEIGHTS, 200) + np.random.default_rng(1).uniform(-0.1, 0.1, (200, 3)) * [1, 1, 0]
    poses = Tree.of(robot).poses(_actuators(legs, places))
    error = np.abs(poses.p[:, Tree.of(robot).index["platform"]] - places).max()
    note = "200 places: closed form in, loops solved by Newton, platform out"
    rows.append(Row(PAPER, "kinematics (16)-(18) against the closed form", None, float(error), "m", note=note))
    return rows


def _workspaces(robot: Mechanism) -> list[Row]:
    rows = []
    for reach in (0.05, 0.1, 0.25):
        found = one_per_leg(robot, "axis", **SPRING, reach=reach)[1].numbers
        where = f"platform within +-{reach:g} m, 0.5 to 0.8 m down"
        note = "the paper claims about 5 % of the unbalanced moment" if reach == 0.1 else ""
        rows.append(Row(PAPER, f"largest residual, {where}", None, found["residual_peak"], "N m", note=note))
        rows.append(Row(PAPER, f"largest unbalanced, {where}", None, found["unbalanced_peak"], "N m"))
    best = one_per_leg(robot, "peak", **SPRING, reach=0.1)[1].numbers
    rows.append(Row(PAPER, "optimised over +-0.1 m: largest residual", None, best["residual_peak"], "N m"))
    rows.append(Row(PAPER, "optimised over +-0.1 m: times better than (15)", None, best["times_better"]))
    return rows


def _full() -> list[Row]:
    """Section 5 with data of which nothing is special."""
    robot = DeltaRobot(base=0.25, platform=0.1, upper=0.4, lower=0.7, com_2=0.15, com_4=0.3).mechanism()
    weights: dict[str, Any] = {"link_8": 0.3, "link_9": 0.2, "frame": 0.4, "link_2p": 0.35}
    weights |= {"spring_7": 1.8, "spring_10": 0.5, "spring_11": 0.6}
    rows = []
    for printed in (False, True):
        found = design(robot, BF=0.12, CS=0.1, printed=printed, **weights)
        low, high = found.balance.total
        share = (high - low) / (found.balance.gravity[1] - found.balance.gravity[0])
        name = "Eq. (10) as printed" if printed else "energy condition"
        wrong = "BF = 2 CS missing; m4 + m6/3 for m5 + m6/3; m11 for m11U" if printed else ""
        item = f"full balance, {name}: energy variation"
        rows.append(Row(PAPER, item, None, share, "of gravity's", erratum=wrong, note=found.balance.certificate.kind))
    return rows


def _axis(low: float, high: float, count: int) -> Array:
    return np.column_stack([np.zeros((count, 2)), -np.linspace(low, high, count)])


def _actuators(legs: tuple[DeltaLeg, ...], places: Array) -> Array:
    return np.column_stack([leg.actuator(places) for leg in legs])


def _figures(robot: Mechanism) -> list[Plot]:
    """Figs. 10-12: moment at A of leg 1 against theta_11 with theta_13 fixed, the platform straight below A's axis.

    theta_11 counts from straight up, so that link 2 is at A = theta_11 + 3 pi/2 below the horizontal.
    """
    balanced = one_per_leg(robot, "axis", **SPRING, reach=0.0)[1].mechanism
    legs, _ = delta_legs(robot)
    theta = np.linspace(*RANGE, 121)
    A = theta + 1.5 * np.pi
    plots = []
    for name, theta_13 in SWING.items():
        swing = theta_13 - np.pi
        aside, lower = EXAMPLE.lower * np.sin(swing), EXAMPLE.lower * np.cos(swing)
        # E in the plane of y and z through A: AB cos A = CD cos(swing) sin(psi)
        with np.errstate(invalid="ignore"):
            psi = np.arcsin(EXAMPLE.upper * np.cos(A) / lower)
        depth = EXAMPLE.upper * np.sin(A) + lower * np.cos(psi)
        places = np.column_stack([np.zeros_like(A), np.full_like(A, aside), -depth])
        u = _actuators(legs, places)
        u[np.isnan(u).any(axis=1)] = np.nan
        without, left = Potential(robot)(u).gravity_torque[:, 0], Potential(balanced)(u).torque[:, 0]
        number = name.removeprefix("fig")
        title = f"Fig. {number}: moment at joint A, theta_13 = {theta_13:.4g} rad"
        series = {"without springs": without, "with spring 7": left}
        note = "Platform moved along the axis of A only, E below A: the paper does not say where else it is."
        plots.append(Plot(name, title, "theta_11 [rad]", "moment [N m]", theta, series, note))
    return plots


def _map(robot: Mechanism) -> Map:
    side = np.linspace(-0.25, 0.25, 41)
    x, y = np.meshgrid(side, side)
    places = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, -0.65)])
    legs, _ = delta_legs(robot)
    u = _actuators(legs, places)
    panels = {}
    goals: dict[str, Goal] = {"spring by (15)": "axis", "optimised over ±0.1 m": "peak"}
    for label, goal in goals.items():
        _, found = one_per_leg(robot, goal, **SPRING, reach=0.1)
        panels[label] = np.abs(Potential(found.mechanism)(u).torque).max(axis=1).reshape(x.shape)
    title = "Largest residual moment of the three actuators, platform 0.65 m below the base"
    return Map("residual", title, "x [m]", "y [m]", "moment [N m]", side, side, panels)
