"""Everything that simionescu2015 prints, beside what the method finds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ...energy.evaluate import Potential
from ...kinematics import Tree
from ..record import Reproduction, Row
from .example import (
    ASSUMED,
    AV,
    AW,
    EXAMPLE,
    HEIGHTS,
    M7,
    PAPER,
    PRINTED_K,
    RANGE,
    SWING,
    G,
    actuators,
    axis,
    axis_stiffness,
    mechanism,
    path,
    sprung,
    weighted,
)
from .figures import diagrams, residual_map
from .full import bar, rocker, two_axes, whole_robot

CITATION = (
    'I. Simionescu, L. Ciupitu, L. C. Ionita, "Static balancing with elastic systems of DELTA parallel robots", '
    "Mechanism and Machine Theory 87 (2015) 150-162"
)
REACHES = {0.05: ("4.31", "40.96"), 0.1: ("9.53", "45.70"), 0.25: ("46.0", "53.02")}  # [m]: residual, unbalanced [N m]


def reproduction() -> Reproduction:
    """Everything the paper prints that can be computed, and what is wrong in it."""
    sections = (rocker, two_axes, whole_robot, bar, _kinematics, _example, _sensitivity, _paths, _workspaces)
    return Reproduction.of(PAPER, CITATION, sections, (diagrams, residual_map))


def _kinematics() -> Iterator[Row]:
    """The loops (16)-(21)."""
    places = axis(*HEIGHTS, 200) + np.random.default_rng(1).uniform(-0.1, 0.1, (200, 3)) * [1, 1, 0]
    tree = Tree.of(mechanism())
    u = actuators(places)
    poses = tree.poses(u)
    body = tree.index["platform"]
    error = float(np.abs(poses.p[:, body] - places).max())
    note = "200 places: closed form in, loops solved by Newton, platform out"
    yield Row(PAPER, "kinematics (16)-(18) against the closed form", None, error, "m", golden="<= 1e-12", note=note)
    h = 1e-5  # [m]
    slopes = np.stack([(actuators(places + h * e) - actuators(places - h * e)) / (2 * h) for e in np.eye(3)], axis=-1)
    product = slopes @ tree.velocities(u, poses).v[:, body]
    off = float(np.abs(product - np.eye(3)).max())
    note = "times the closed form's, by differences, less 1"
    yield Row(PAPER, "derivatives (19)-(21) of the loops", None, off, golden="<= 1e-8", note=note)


def _example() -> Iterator[Row]:
    """One spring per leg (14)-(15), (22)-(23), section 9."""
    k = sprung().numbers["stiffness"]
    u = actuators(axis(*HEIGHTS, 61))
    A = np.arcsin(np.linspace(*HEIGHTS, 61) / (2 * EXAMPLE.upper))
    state = Potential(sprung().mechanism)(u)
    bare = np.abs(Potential(mechanism())(u).gravity_torque)
    mass = bare[:, 0] / (G * EXAMPLE.upper * np.cos(A))
    yield Row(PAPER, "m~ (22) on the axis, mean", None, float(mass.mean()), "kg", golden=weighted(EXAMPLE))
    yield Row(PAPER, "m~ (22) on the axis, largest less smallest", "0", float(np.ptp(mass)), "kg", exact=True)
    share = (float(PRINTED_K) * AV * AW / G - (k * AV * AW / G - 0.5 * M7 * AV)) / (M7 * AV)
    why = f"what it rests on is not printed; {ASSUMED}"
    yield Row(PAPER, "k7, stiffness of the example (15)", PRINTED_K, k, "N/m", golden=axis_stiffness(EXAMPLE),
              against="unprinted", why=why, note="its unit is printed as Nm")  # fmt: skip
    for spring in sprung().mechanism.springs:
        yield Row(PAPER, f"k of {spring.name} (15)", None, spring.strength[0], "N/m", golden=axis_stiffness(EXAMPLE))
    yield Row(
        PAPER, "share of the spring's mass at V that gives the printed k7", None, share, golden="0.7881", note=ASSUMED
    )
    yield Row(PAPER, "residual on the axis, largest of 61 places", "<= 0.006", float(np.abs(state.torque).max()), "N m",
              golden="<= 1e-9", note="the paper's is from its numerical computation")  # fmt: skip
    level = G * EXAMPLE.upper * weighted(EXAMPLE)
    yield Row(PAPER, "unbalanced moment at 0.5 m", None, float(bare[0, 0]), "N m", golden=float(level * np.cos(A[0])))
    reached = float(np.cos(np.array(RANGE) + 1.5 * np.pi).max())
    largest = float(bare[0, 0]) / float(np.cos(A[0])) * reached
    yield Row(
        PAPER,
        "largest driving moment over the range of theta_11, on the axis",
        "40",
        largest,
        "N m",
        golden="37.75",
        against="unprinted",
        why=f"the paper says 'approximately'; {ASSUMED}",
    )
    yield Row(PAPER, "unbalanced moment, links 2 level", None, float(bare[0, 0] / np.cos(A[0])), "N m", golden=level)


def _sensitivity() -> Iterator[Row]:
    """How much k7 rests on what is not printed."""
    k = axis_stiffness(EXAMPLE)
    changes: dict[str, dict[str, Any]] = {
        "mass centre of link 2 10 % further out": {"com_2": 1.1 * EXAMPLE.upper / 2},
        "mass centres of the rods 10 % further out": {"com_4": 1.1 * EXAMPLE.lower / 2},
        "platform 10 % heavier": {"link_6": 1.1 * EXAMPLE.link_6},
    }
    for what, change in changes.items():
        moved = 100 * (sprung(change=tuple(change.items())).numbers["stiffness"] / k - 1)
        true = 100 * (axis_stiffness(replace(EXAMPLE, **change)) / k - 1)
        yield Row(PAPER, f"sensitivity of k7: {what}", None, moved, "%", golden=true)


def _paths() -> Iterator[Row]:
    """The moments of Figs. 10 to 12."""
    for name, theta_13 in SWING.items():
        _, u = path(theta_13, 601)
        figure = f"Fig. {name.removeprefix('fig')}"
        bare, left = (np.abs(torque[:, 0]) for torque in (
            Potential(mechanism())(u).gravity_torque, Potential(sprung().mechanism)(u).torque
        ))  # fmt: skip
        golden = PATHS[name]
        where = f"{figure}, theta_13 = {theta_13:.4g} rad, largest of the places that it reaches"
        yield Row(PAPER, f"moment without springs, {where}", None, float(np.nanmax(bare)), "N m", golden=golden[0])
        most = float(np.nanmax(left))
        if most <= 2:
            yield Row(PAPER, f"moment with springs, {where}", "<= 2", most, "N m", golden=golden[1])
        else:
            yield Row(
                PAPER,
                f"moment with springs, {where}",
                "<= 2",
                most,
                "N m",
                golden=golden[1],
                against="unprinted",
                why=f"where else the platform is is not printed: it is kept straight below A here; {ASSUMED}",
            )


PATHS = {
    "fig10": ("32.17", "13.72"),
    "fig11": ("29.37", "10.71"),
    "fig12": ("37.75", "<= 1e-9"),
}  # [N m] without and with springs


def _workspaces() -> Iterator[Row]:
    """What is left off the axis, section 10."""
    for reach, (left, whole) in REACHES.items():
        found = sprung("axis", reach).numbers
        where = f"platform within +-{reach:g} m, 0.5 to 0.8 m down"
        yield Row(PAPER, f"largest residual, {where}", None, found["residual_peak"], "N m", golden=left, note=_SEARCHED)
        yield Row(
            PAPER, f"largest unbalanced, {where}", None, found["unbalanced_peak"], "N m", golden=whole, note=_SEARCHED
        )
        share = found["residual_peak"] / found["unbalanced_peak"]
        more: dict[str, Any] = {"against": "refuted", "why": _OFF_AXIS}
        yield Row(PAPER, f"share of the driving moment that is left, {where}; 'about 5 %'", "<= 0.055", share,
                  golden=SHARES[reach], **more)  # fmt: skip
        yield Row(PAPER, f"times that the driving moment decreases, {where}; 'about 20'", ">= 19.5", 1 / share,
                  golden=TIMES[reach], **more)  # fmt: skip
    best = sprung("peak", 0.1).numbers
    yield Row(PAPER, "optimised over +-0.1 m: largest residual", None, best["residual_peak"], "N m", golden="7.18")
    yield Row(PAPER, "optimised over +-0.1 m: times better than (15)", None, best["times_better"], golden="1.33")


SHARES = {0.05: "0.105", 0.1: "0.209", 0.25: "0.868"}
TIMES = {0.05: "9.49", 0.1: "4.79", 0.25: "1.15"}
_SEARCHED = "over the whole box, its corners and edges included"
_OFF_AXIS = "it holds along the paths in the paper's diagrams only: off the axis one spring per leg does not suffice"
