"""Load cases: what has to be balanced, each a way in which the mechanism is loaded, and how much it counts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from ..model.arrays import Array, vec3
from ..model.elements import Vec3
from ..model.goal import Goal, Loads
from ..model.mechanism import Mechanism, PointMass
from .given import number

RINGS, ROUND = 2, 3  # directions of a tilt: on so many circles, each with so many


@dataclass(frozen=True)
class Load:
    """Masses that hang on the mechanism beside its own, and the gravity that acts on all of them.

    Attributes:
        weight: what its mean square torque counts, relative to that of the other loads.
        masses: payloads, tools.
        gravity: in the world's frame [m/s^2], of a tilted base for example; None is the mechanism's own.
        without: names of the mechanism's masses that are not there, such as the mean of a range of payloads.
        tilt: [rad] gravity leans by up to this, in every direction.

    Raises:
        InputError: a weight that is not more than 0.
    """

    name: str
    weight: float = 1.0
    masses: tuple[PointMass, ...] = ()
    gravity: Vec3 | None = None
    without: tuple[str, ...] = ()
    tilt: float = 0.0

    def __post_init__(self) -> None:
        number("weight", self.weight, positive=True)
        object.__setattr__(self, "masses", tuple(self.masses))

    def on(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism loaded like this, upright.

        Raises:
            InputError: it has no such body, or a mass of that name already.
        """
        if self.masses or self.without:
            stay = (mass for mass in mechanism.masses if mass.name not in self.without)
            mechanism = mechanism.with_masses((*stay, *self.masses))
        return mechanism if self.gravity is None else replace(mechanism, gravity=self.gravity)

    def each(self, mechanism: Mechanism) -> tuple[Mechanism, ...]:
        """The mechanism loaded like this, of a tilt in directions whose mean squares are those of the whole cone."""
        loaded = self.on(mechanism)
        every = cone(np.array(loaded.gravity), self.tilt) if self.tilt else ()
        return tuple(replace(loaded, gravity=vec3(g)) for g in every) or (loaded,)

    def to_dict(self) -> dict[str, Any]:
        """As plain data."""
        masses = [
            {"name": mass.name, "body": mass.body, "mass": mass.mass, "position": list(mass.position)}
            for mass in self.masses
        ]
        gravity = None if self.gravity is None else list(self.gravity)
        found: dict[str, Any] = {"name": self.name, "weight": self.weight, "masses": masses, "gravity": gravity}
        return found | ({"tilt": self.tilt} if self.tilt else {})


OWN = Load("own")
"""The mechanism as it is."""


def cases(loads: Loads) -> tuple[Load, ...]:
    """The loads of a goal, one for every end of a payload's range and every gravity: the mechanism's own if none."""
    names = tuple(tool.name for tool in loads.tools)
    carried: list[tuple[str, float, tuple[PointMass, ...]]] = [("", 1.0, ())] if not names else []
    for tool in loads.tools:
        ends = dict.fromkeys(tool.payload)
        for mass in ends:
            hung = (PointMass(tool.name, tool.body, mass, tool.at),) if mass else ()
            carried.append((f"{tool.name} {mass:g} kg", tool.share / len(ends), hung))
    mounted = [(f"gravity {i}", one.share, one.vector) for i, one in enumerate(loads.gravity, 1)] or [("", 1.0, None)]
    return tuple(
        Load(", ".join(filter(None, (tool, mount))) or "own", weight * share, masses, gravity, names, loads.tilt)
        for (tool, weight, masses), (mount, share, gravity) in product(carried, mounted)
    )


def with_means(mechanism: Mechanism, goal: Goal) -> Mechanism:
    """The mechanism that carries a goal, with the mean of its tools as masses of their names.

    What hung on it for the goal that it had before is taken off.
    """
    tools = goal.loads.tools
    gone = {tool.name for tool in (*tools, *mechanism.goal.loads.tools)}
    total = sum(tool.share for tool in tools)
    means = (PointMass(t.name, t.body, t.mean * t.share / total, t.at) for t in tools if t.mean)
    masses = (*(mass for mass in mechanism.masses if mass.name not in gone), *means)
    return replace(mechanism, masses=masses, goal=goal)


def cone(g: Array, tilt: float) -> list[Array]:
    """Gravities (3,) that lean from g (3,) by up to `tilt` [rad]: evenly weighted, with the mean and the covariance of
    all directions of the cone, evenly spread. A mean square of what is linear in gravity is the same over both.

    The height on the axis is spread evenly (Archimedes), so Gauss points of it and three directions around do.
    """
    size = float(np.linalg.norm(g))
    axis, *across = frame(g)
    found = []
    points, _ = np.polynomial.legendre.leggauss(RINGS)
    for height in (1 + np.cos(tilt)) / 2 + (1 - np.cos(tilt)) / 2 * points:
        for turn in 2 * np.pi * np.arange(ROUND) / ROUND:
            side = np.cos(turn) * across[0] + np.sin(turn) * across[1]
            found.append(size * (height * axis + np.sqrt(1 - height**2) * side))
    return found


def frame(g: Array) -> Iterable[Array]:
    """Three unit vectors at right angles, the first along g (3,)."""
    axis = g / (np.linalg.norm(g) or 1.0)
    first = np.asarray(np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))]), float)
    first /= np.linalg.norm(first)
    return axis, first, np.asarray(np.cross(axis, first), float)


def extremes(torque: Array, g: Array, tilt: float) -> tuple[Array, Array]:
    """The least and the largest of a torque whose gravity leans by up to `tilt` [rad], each (...).

    Args:
        torque: (..., 3) by a unit of gravity along each axis; g: (3,) gravity upright.
    """
    axis, *across = frame(g)
    along = torque @ axis
    aside = np.hypot(torque @ across[0], torque @ across[1])
    size = float(np.linalg.norm(g))

    def most(along: Array) -> Array:
        lean = np.minimum(np.arctan2(aside, along), tilt)
        return size * (along * np.cos(lean) + aside * np.sin(lean))

    return -most(-along), most(along)
