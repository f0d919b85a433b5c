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
from ...energy.extremes import apart, ascend
from ...kinematics import Tree
from ...model.arrays import Array
from ...model.elements import Spring
from ...model.errors import Fault, InputError
from ...model.mechanism import Mechanism
from ...model.validate import MAX_SAMPLES, whole_number
from .legs import DeltaLeg
from .rocker import snapped

Objective = Literal["rms", "peak"]
OBJECTIVES: tuple[str, ...] = get_args(Objective)
Goal = Literal["axis", "rms", "peak"]
LEVELS = 101  # heights on the axis
GRID = (9, 9, 7)  # places along the sides of the box, the corners among them
STARTS, ROUNDS = 4, 12  # of the search for the largest torque of each leg
CUTS = 6  # times the worst place joins the program for the least peak
NEAR = 1e-6  # of the peak: how well it is known


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
        return Box(snapped(centre), (float(heights[0]), float(heights[1])), reach)

    def places(self, legs: Sequence[DeltaLeg], samples: int, seed: int) -> Array:
        """(samples + grid, 3) places in the world [m]: random ones, and a grid with the corners of the box."""
        rng = np.random.default_rng(seed)
        grid = np.stack(np.meshgrid(*(np.linspace(0, 1, count) for count in GRID)), axis=-1).reshape(-1, 3)
        return self.at(legs, np.concatenate([rng.random((samples, 3)), grid]))

    def at(self, legs: Sequence[DeltaLeg], share: Array) -> Array:
        """(N, 3) places in the world [m] of shares (N, 3) of the box's sides."""
        lower, upper = ([-self.reach, -self.reach, -self.heights[1]], [self.reach, self.reach, -self.heights[0]])
        own = np.array(lower) + share * np.subtract(upper, lower)
        x, y = legs[0].R_WL[:, 0], legs[0].R_WL[:, 1]
        return np.array(self.centre) + own @ np.array([x, y, legs[0].R_WL[:, 2]])

    def share(self, legs: Sequence[DeltaLeg], P: Array) -> Array:
        """The inverse of `at`."""
        own = (P - np.array(self.centre)) @ legs[0].R_WL
        side = np.array([2 * self.reach, 2 * self.reach, self.heights[1] - self.heights[0]])
        lower = np.array([-self.reach, -self.reach, -self.heights[1]])
        return np.where(side > 0, (own - lower) / np.where(side > 0, side, 1.0), 0.0)

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
    judged = _Judged(mechanism, tuple(legs), box, lengths, mass)
    on_axis = judged.torques(box.axis(legs)).reshape(-1, 4)
    P = box.places(legs, samples, seed)
    in_box = judged.torques(P)
    paper = _least_squares(on_axis[:, 1:3])
    if objective == "axis":
        chosen = paper
    elif objective == "rms":
        chosen = _least_squares(in_box[:samples].reshape(-1, 4)[:, 1:])
    else:
        chosen = _least_peak(judged, P, in_box)
    numbers = {
        "stiffness": float(np.hypot(*_both(chosen))) / lengths[1],
        "unbalanced_peak": judged.peak(P, in_box, None)[0],
        "residual_peak": judged.peak(P, in_box, chosen)[0],
    }
    if objective != "axis":
        numbers["axis_formula_peak"] = judged.peak(P, in_box, paper)[0]
        numbers["times_better"] = numbers["axis_formula_peak"] / numbers["residual_peak"]
    return Found(mechanism.with_springs(_springs(legs, _both(chosen), lengths, mass)), numbers)


@dataclass(frozen=True)
class _Judged:
    """A robot with springs 7 of given lengths and mass, judged in a box."""

    mechanism: Mechanism
    legs: tuple[DeltaLeg, ...]
    box: Box
    lengths: tuple[float, float]
    mass: tuple[float, float]

    def torques(self, P: Array) -> Array:
        """(places, legs, 4) torque at A: gravity's without springs, with their masses, of k W = 1 N up, out."""
        return _torques(self.mechanism, self.legs, P, self.lengths, self.mass)

    def peak(self, P: Array, torques: Array, p: Array | None) -> tuple[float, Array]:
        """The largest torque in the box [N m] with springs `p`, or without any, and (3,) where [m].

        Each leg climbs from several of its worst places `P`, whose `torques` are known, to the edges if need be.
        """
        shares = self.box.share(self.legs, P)
        values = _left(torques, p)
        starts = [apart(values[:, leg], shares, STARTS) for leg in range(values.shape[1])]
        which = np.repeat(np.arange(len(starts)), [len(start) for start in starts])

        def left(share: Array) -> Array:
            return _left(self.torques(self.box.at(self.legs, share)), p)

        found, where = ascend(left, shares[np.concatenate(starts)], which, np.zeros(3), np.ones(3), ROUNDS)
        best = int(found.argmax())
        return float(found[best]), self.box.at(self.legs, where[best : best + 1])[0]


def _left(torques: Array, p: Array | None) -> Array:
    """(places, legs) magnitude of the torque with springs `p`, or without any."""
    if p is None:
        return np.abs(torques[..., 0])
    return np.abs(torques[..., 1] + torques[..., 2 : 2 + len(p)] @ p)


def _torques(
    mechanism: Mechanism, legs: Sequence[DeltaLeg], P: Array, lengths: tuple[float, float], mass: tuple[float, float]
) -> Array:
    """See `_Judged.torques`."""
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
    return np.stack([bare, up.gravity_torque, up.spring_torque, out.spring_torque], axis=2)


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
        springs.append(
            Spring(name, "world", snapped(W), leg.links[0], snapped(V), size / AW, mass=m7, mass_split=1 - share)
        )
    return springs


def _both(p: Array) -> tuple[float, float]:
    return float(p[0]), float(p[1]) if len(p) > 1 else 0.0


def _least_squares(torques: Array) -> Array:
    return np.asarray(np.linalg.lstsq(torques[:, 1:], -torques[:, 0], rcond=None)[0], float)


def _least_peak(judged: _Judged, P: Array, torques: Array) -> Array:
    """Minimise t with ``|gravity + springs p| <= t``: a linear program, until its worst place is one of its own."""
    from scipy.optimize import linprog

    rows, p = torques[..., 1:].reshape(-1, 3), np.zeros(2)
    for _ in range(CUTS):
        ones = -np.ones(len(rows))
        A = np.vstack([np.column_stack([sign * rows[:, 1:], ones]) for sign in (1, -1)])
        b = np.concatenate([-rows[:, 0], rows[:, 0]])
        *p, t = linprog([0, 0, 1], A_ub=A, b_ub=b, bounds=[(None, None), (None, None), (0, None)]).x
        p = np.array(p)
        peak, where = judged.peak(P, torques, p)
        if peak <= (1 + NEAR) * t:
            break
        rows = np.vstack([rows, judged.torques(where[None])[..., 1:].reshape(-1, 3)])
    return p
