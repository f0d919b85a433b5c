"""What may be changed and what for: the body pairs, where springs may be attached, and the goal.

Building a problem is separate from solving it, so that it can be looked at and altered in between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from ..arrays import Array
from ..errors import Fault, InputError, nearest
from ..kinematics import Tree
from ..mechanism import WORLD, Mechanism
from .mounts import Mounts

Pair = tuple[str, str]
Progress = Callable[[str, float], None]  # what is being done, and the share of it that is done
Objective = Literal["rms", "peak"]
OBJECTIVES: tuple[Objective, ...] = ("rms", "peak")


@dataclass(frozen=True)
class Region:
    """Where a spring may be attached to a body: within `half` of `centre`, in the body's frame [m].

    A ball of radius ``half[0]``, or a box of half sides `half`.
    """

    centre: tuple[float, float, float]
    half: tuple[float, float, float]
    shape: Literal["ball", "box"] = "ball"

    @staticmethod
    def ball(radius: float, centre: Iterable[float] = (0.0, 0.0, 0.0)) -> Region:
        """A ball around `centre` [m]."""
        x, y, z = centre
        return Region((x, y, z), (radius, radius, radius), "ball")

    @staticmethod
    def box(half: float | Iterable[float], centre: Iterable[float] = (0.0, 0.0, 0.0)) -> Region:
        """A box around `centre`, +-`half` along each axis of the body [m]."""
        hx, hy, hz = [float(half)] * 3 if isinstance(half, (int, float)) else half
        x, y, z = centre
        return Region((x, y, z), (hx, hy, hz), "box")

    def times(self, factor: float) -> Region:
        """The region enlarged about its centre."""
        hx, hy, hz = (factor * h for h in self.half)
        return replace(self, half=(hx, hy, hz))

    @property
    def lift(self) -> Array:
        """(4, 4) maps the region's own coordinates [u; 1], u in the unit ball or box, to body coordinates [p; 1]."""
        L = np.diag([*self.half, 1.0])
        L[:3, 3] = self.centre
        return L


@dataclass(frozen=True)
class Problem:
    """Choose springs for `mechanism` (its own springs stay and act as a load).

    Attributes:
        pairs: the pairs of bodies that may be joined by springs.
        regions: attachment region of every body named in `pairs`.
        objective: "rms" (mean square over configurations and joints) or "peak" (the largest torque).
        joints: the coordinates whose torque counts (all of them when None): the arm of a whole body, for example.
        samples: random poses inside the joint ranges that the goal is judged on; None takes exact averages over all
            configurations where the mechanism allows it, else the workspace's number of samples.
    """

    mechanism: Mechanism
    pairs: tuple[Pair, ...]
    regions: Mapping[str, Region]
    objective: Objective = "rms"
    joints: tuple[str, ...] | None = None
    samples: int | None = None
    seed: int = 0

    @staticmethod
    def of(
        mechanism: Mechanism,
        *,
        span: int = 2,
        pairs: Iterable[Pair] | None = None,
        radius: float | None = None,
        shape: Literal["ball", "box"] = "ball",
        regions: Mapping[str, Region] | None = None,
        objective: Objective = "rms",
        joints: Iterable[str] | None = None,
        samples: int | None = None,
        seed: int = 0,
    ) -> Problem:
        """The problem with sensible defaults.

        Args:
            span: without `pairs`, every two bodies at most this many moving joints apart.
            radius: [m] of every region without one of its own in `regions`; by default from each link's size.
            joints: names of joints or coordinates; a spherical joint stands for its three.

        Raises:
            InputError: an unknown body or joint, a pair of one body, no pair at all, a radius that is not positive.
            UnsupportedError: the mechanism has loops.
        """
        mounts = Mounts.of(mechanism)
        chosen = mounts.pairs(span) if pairs is None else tuple(dict.fromkeys(_known(mechanism, p) for p in pairs))
        if not chosen:
            raise InputError(Fault(("pairs",), f"no pair of bodies within a span of {span}; give more span or --pairs"))
        if objective not in OBJECTIVES:
            raise InputError(Fault(("objective",), f"unknown objective {nearest(objective, OBJECTIVES)}", OBJECTIVES))
        if radius is not None and not (np.isfinite(radius) and radius > 0):
            raise InputError(Fault(("radius",), f"must be more than 0 m, found {radius:g}"))
        given = dict(regions or {})
        for body in given:
            _known(mechanism, (WORLD, body) if body != WORLD else (WORLD,))
        make = Region.ball if shape == "ball" else Region.box
        names = dict.fromkeys(name for pair in chosen for name in pair)
        every = {name: given.get(name) or make(radius or mounts.default_radius(name)) for name in names}
        counted = None if joints is None else _coordinates(mechanism, joints)
        return Problem(mechanism, chosen, every, objective, counted, samples, seed)

    @property
    def count(self) -> int:
        """The number of random poses where averages are not exact."""
        return self.samples or self.mechanism.workspace.samples

    def on(self, pairs: Iterable[Pair]) -> Problem:
        """The same problem on other pairs (bodies that have a region)."""
        return replace(self, pairs=tuple(pairs))

    def enlarged(self, factor: float) -> Problem:
        """The same problem with every region enlarged about its centre."""
        return replace(self, regions={name: region.times(factor) for name, region in self.regions.items()})

    @cached_property
    def weights(self) -> Array:
        """(n,) what each coordinate's torque counts: 1 for an angle; a force counts at the mechanism's reach [m]."""
        every = np.where(Tree.of(self.mechanism).turns, 1.0, Mounts.of(self.mechanism).reach)
        counted = [self.joints is None or name in self.joints for name in self.mechanism.coordinates]
        return np.where(counted, every, 0.0)

    def lift(self, pair: Pair) -> Array:
        """(7, 7) maps a pair's own coordinates [u_a; 1; u_b] to z = [p_a; 1; p_b]."""
        a, b = (self.regions[name].lift for name in pair)
        L = np.zeros((7, 7))
        L[:4, :4] = a
        L[4:, 4:], L[4:, 3] = b[:3, :3], b[:3, 3]
        return L


def _coordinates(mechanism: Mechanism, joints: Iterable[str]) -> tuple[str, ...]:
    found: list[str] = []
    for name in joints:
        own = [c for c in mechanism.coordinates if name in (c, c.rpartition(".")[0])]
        if not own:
            problem = f"no independent joint {nearest(name, mechanism.coordinates)}"
            raise InputError(Fault(("joints",), problem, mechanism.coordinates))
        found += own
    if not found:
        raise InputError(Fault(("joints",), "no joint is named", mechanism.coordinates))
    return tuple(dict.fromkeys(found))


def _known(mechanism: Mechanism, pair: Iterable[str]) -> Pair:
    pair = tuple(pair)
    for name in pair:
        if name not in mechanism.body_names:
            raise InputError(
                Fault(("pairs",), f"there is no body {nearest(name, mechanism.body_names)}", mechanism.body_names)
            )
    if len(set(pair)) != len(pair):
        raise InputError(Fault(("pairs",), f"a spring needs two different bodies, found {':'.join(pair)}"))
    return pair  # type: ignore[return-value]
