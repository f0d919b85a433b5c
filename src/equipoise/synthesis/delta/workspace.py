"""One spring per leg of a DELTA robot, the best over a box of places of the platform (Simionescu et al. 2015, sec. 6).

The torque of spring 7 about A is ``k V x W``: linear in ``k W``. So with V given on link 2, the two numbers k W_z and
k W_x of the best spring follow from a least-squares or a linear program over random places, the same for all legs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ...energy.evaluate import Potential
from ...kinematics import Tree
from ...model.arrays import Array
from ...model.elements import Spring
from ...model.errors import Fault, InputError
from ...model.mechanism import Mechanism
from ...model.validate import MAX_SAMPLES, whole_number
from .legs import DeltaLeg
from .rocker import vec3

Objective = Literal["rms", "peak"]
OBJECTIVES: tuple[str, ...] = get_args(Objective)
Goal = Literal["axis", "rms", "peak"]
LEVELS = 101  # heights on the axis


@dataclass(frozen=True)
class Box:
    """Places of the platform: `heights` [m] below `centre`, and within +-`reach` [m] of the axis both ways."""

    centre: tuple[float, float, float]
    heights: tuple[float, float]
    reach: float

    @staticmethod
    def of(
        mechanism: Mechanism, legs: Sequence[DeltaLeg], platform: str, heights: Sequence[float] | None, reach: float
    ) -> Box:
        """The box on the axis of the legs; by default the middle half of the heights reached on the axis.

        Raises:
            InputError: it is empty, or not two heights.
        """
        centre = np.mean([leg.A for leg in legs], axis=0)
        if heights is None:
            size = legs[0].upper + legs[0].lower
            h = np.linspace(-size, size, 4001)[1:-1]
            up = legs[0].R_WL[:, 2]
            reached = h[np.isfinite([leg.actuator(centre - h[:, None] * up) for leg in legs]).all(axis=0)]
            reached = reached[reached > 0]
            if not len(reached):
                raise InputError("the platform does not reach the axis below the base: give heights")
            low, high = reached.min(), reached.max()
            heights = (float(low + (high - low) / 4), float(high - (high - low) / 4))
        if len(heights) != 2 or not heights[0] < heights[1]:
            raise InputError(Fault(("heights",), f"must be two lengths, the smaller first, found {list(heights)}"))
        if not reach >= 0:
            raise InputError(Fault(("reach",), f"must be at least 0 m, found {reach:g}"))
        return Box(vec3(centre), (float(heights[0]), float(heights[1])), reach)

    def places(self, legs: Sequence[DeltaLeg], samples: int, seed: int) -> Array:
        """(samples, 3) random places in the world [m]."""
        rng = np.random.default_rng(seed)
        own = rng.uniform([-self.reach, -self.reach, -self.heights[1]], [self.reach, self.reach, -self.heights[0]],
                          (samples, 3))  # fmt: skip
        x, y = legs[0].R_WL[:, 0], legs[0].R_WL[:, 1]
        return np.array(self.centre) + own @ np.array([x, y, legs[0].R_WL[:, 2]])

    def axis(self, legs: Sequence[DeltaLeg]) -> Array:
        """(LEVELS, 3) places on the axis."""
        return np.array(self.centre) - np.linspace(*self.heights, LEVELS)[:, None] * legs[0].R_WL[:, 2]


@dataclass(frozen=True)
class Found:
    """The robot with its three springs, and the peak torques [N m] of one leg over the box."""

    mechanism: Mechanism
    numbers: dict[str, float]


def best_springs(
    mechanism: Mechanism,
    legs: Sequence[DeltaLeg],
    box: Box,
    lengths: tuple[float, float],
    mass: tuple[float, float],
    objective: Goal,
    samples: int,
    seed: int,
) -> Found:
    """Spring 7 of every leg: best on the axis with W above A (Eqs. 14-15), or over the box with W anywhere beside it.

    Raises:
        InputError: the robot does not reach all of the box.
    """
    whole_number("samples", samples, 1, MAX_SAMPLES)
    on_axis = _torques(mechanism, legs, box.axis(legs), lengths, mass)
    in_box = _torques(mechanism, legs, box.places(legs, samples, seed), lengths, mass)
    paper = _least_squares(on_axis[:, 1:3])
    chosen = paper if objective == "axis" else (_least_peak if objective == "peak" else _least_squares)(in_box[:, 1:])
    numbers = {
        "stiffness": float(np.hypot(*_both(chosen))) / lengths[1],
        "unbalanced_peak": float(np.abs(in_box[:, 0]).max()),
        "residual_peak": _peak(in_box[:, 1:], chosen),
    }
    if objective != "axis":
        numbers["axis_formula_peak"] = _peak(in_box[:, 1:], paper)
        numbers["times_better"] = numbers["axis_formula_peak"] / numbers["residual_peak"]
    return Found(mechanism.with_springs(_springs(legs, _both(chosen), lengths, mass)), numbers)


def _torques(
    mechanism: Mechanism, legs: Sequence[DeltaLeg], P: Array, lengths: tuple[float, float], mass: tuple[float, float]
) -> Array:
    """(places x legs, 4) torque at A: gravity's without springs, with their masses, of k W = 1 N upwards, outwards."""
    names = [leg.joints[0] for leg in legs]
    coordinates = Tree.of(mechanism).coordinates
    if set(coordinates) != set(names):
        raise InputError(Fault(("independent",), f"found {', '.join(coordinates)}; the actuators are", tuple(names)))
    order = [names.index(name) for name in coordinates]
    u = np.column_stack([leg.actuator(P) for leg in legs])[:, order]
    bare = Potential(mechanism.with_springs(()))(u).gravity_torque
    up, out = (
        Potential(mechanism.with_springs(_springs(legs, kW, lengths, mass)))(u) for kW in ((1.0, 0.0), (0.0, 1.0))
    )
    if not np.isfinite(bare).all():
        raise InputError(Fault(("reach",), "the robot does not reach all of the workspace; make it smaller"))
    return np.stack([bare, up.gravity_torque, up.spring_torque, out.spring_torque], axis=2).reshape(-1, 4)


def _springs(
    legs: Sequence[DeltaLeg], kW: tuple[float, float], lengths: tuple[float, float], mass: tuple[float, float]
) -> list[Spring]:
    """Springs with ``k W`` [N], the parts upwards and outwards, |W| = AW, V on the line AB."""
    (AV, AW), (m7, share) = lengths, mass
    size = float(np.hypot(*kW))
    springs = []
    for i, leg in enumerate(legs, 1):
        W = leg.A + AW / size * (kW[0] * leg.R_WL[:, 2] + kW[1] * leg.R_WL[:, 0])
        flat = leg.B - leg.R_2[:, 1] * (leg.R_2[:, 1] @ leg.B)
        V = AV * flat / np.linalg.norm(flat)
        name = f"spring 7 {i}"
        springs.append(Spring(name, "world", vec3(W), leg.links[0], vec3(V), size / AW, mass=m7, mass_split=1 - share))
    return springs


def _both(p: Array) -> tuple[float, float]:
    return float(p[0]), float(p[1]) if len(p) > 1 else 0.0


def _peak(torques: Array, p: Array) -> float:
    return float(np.abs(torques[:, 0] + torques[:, 1 : 1 + len(p)] @ p).max())


def _least_squares(torques: Array) -> Array:
    return np.asarray(np.linalg.lstsq(torques[:, 1:], -torques[:, 0], rcond=None)[0], float)


def _least_peak(torques: Array) -> Array:
    """Minimise t with ``|gravity + springs p| <= t``: a linear program."""
    from scipy.optimize import linprog

    ones = -np.ones(len(torques))
    A = np.vstack([np.column_stack([sign * torques[:, 1:], ones]) for sign in (1, -1)])
    b = np.concatenate([-torques[:, 0], torques[:, 0]])
    return linprog([0, 0, 1], A_ub=A, b_ub=b, bounds=[(None, None), (None, None), (0, None)]).x[:2]
