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
from ..mechanism import Mechanism
from ..validate import MAX_SAMPLES, whole_number
from .blocks import Block
from .mounts import Mounts
from .region import SHAPES, Region, Shape
from .spring_block import SpringBlock

Pair = tuple[str, str]
Progress = Callable[[str, float], None]  # what is being done, and the share of it that is done
Objective = Literal["rms", "peak"]
OBJECTIVES: tuple[Objective, ...] = ("rms", "peak")


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
        radius, shape: of the region of any other body [m], where none is given.
    """

    mechanism: Mechanism
    pairs: tuple[Pair, ...]
    regions: Mapping[str, Region]
    objective: Objective = "rms"
    joints: tuple[str, ...] | None = None
    samples: int | None = None
    seed: int = 0
    radius: float | None = None
    shape: Shape = "ball"

    @staticmethod
    def of(
        mechanism: Mechanism,
        *,
        span: int = 2,
        pairs: Iterable[Pair] | None = None,
        radius: float | None = None,
        shape: Shape = "ball",
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
            InputError: an unknown body or joint, a pair of one body, no pair at all, an option out of range.
            InputError: also loops that cannot be closed.
        """
        mounts = Mounts.of(mechanism)
        whole_number("span", span, 1)
        whole_number("seed", seed, 0)
        if samples is not None:
            whole_number("samples", samples, 1, MAX_SAMPLES)
        for name, value, valid in (("objective", objective, OBJECTIVES), ("shape", shape, SHAPES)):
            if value not in valid:
                raise InputError(Fault((name,), f"unknown {name} {nearest(value, valid)}", valid))
        if len(mounts.bodies) < 2 and pairs is None:
            raise InputError(f"mechanism '{mechanism.name}': there are no two bodies that a spring could join")
        chosen = mounts.pairs(span) if pairs is None else _distinct(_known(mechanism, "pairs", p) for p in pairs)
        if not chosen:
            raise InputError(Fault(("pairs",), "there is none; name at least one pair of bodies"))
        given = dict(regions or {})
        for body in given:
            _known(mechanism, "regions", (body,))
        counted = None if joints is None else _coordinates(mechanism, joints)
        problem = Problem(mechanism, (), given, objective, counted, samples, seed, radius, shape)
        return problem.with_pairs(chosen)

    def with_pairs(self, pairs: Iterable[Pair]) -> Problem:
        """The same problem on other pairs; bodies without a region get the default one.

        Raises:
            InputError: a region is of no size, or out of all proportion to the mechanism.
        """
        mounts, pairs = Mounts.of(self.mechanism), tuple(pairs)
        make = Region.ball if self.shape == "ball" else Region.box
        regions = dict(self.regions)
        for name in dict.fromkeys(name for pair in pairs for name in pair):
            radius = mounts.default_radius(name) if self.radius is None else self.radius
            regions.setdefault(name, make(radius))
            regions[name].check(name, mounts.reach)
        return replace(self, pairs=pairs, regions=regions)

    @property
    def count(self) -> int:
        """The number of random poses where averages are not exact."""
        return self.samples or self.mechanism.workspace.samples

    def enlarged(self, factor: float) -> Problem:
        """The same problem with every region enlarged about its centre."""
        return replace(self, regions={name: region.times(factor) for name, region in self.regions.items()})

    @cached_property
    def weights(self) -> Array:
        """(n,) what each coordinate's torque counts: 1 for an angle; a force counts at the mechanism's reach [m]."""
        every = np.where(Tree.of(self.mechanism).turns, 1.0, Mounts.of(self.mechanism).reach)
        counted = [self.joints is None or name in self.joints for name in Tree.of(self.mechanism).coordinates]
        return np.where(counted, every, 0.0)

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """The unknowns: the springs of each pair."""
        return tuple(SpringBlock(a, b, self.regions[a], self.regions[b]) for a, b in self.pairs)


def _coordinates(mechanism: Mechanism, joints: Iterable[str]) -> tuple[str, ...]:
    found: list[str] = []
    coordinates = Tree.of(mechanism).coordinates
    for name in joints:
        own = [c for c in coordinates if name in (c, c.rpartition(".")[0])]
        if not own:
            problem = f"no independent joint {nearest(name, coordinates)}"
            raise InputError(Fault(("joints",), problem, coordinates))
        found += own
    if not found:
        raise InputError(Fault(("joints",), "no joint is named", coordinates))
    return tuple(dict.fromkeys(found))


def _distinct(pairs: Iterable[Pair]) -> tuple[Pair, ...]:
    """Each pair once, whichever end is named first."""
    return tuple({frozenset(pair): pair for pair in reversed(list(pairs))}.values())[::-1]


def _known(mechanism: Mechanism, field: str, names: Iterable[str]) -> Pair:
    names = tuple(names)
    for name in names:
        if name not in mechanism.body_names:
            choices = mechanism.body_names
            raise InputError(Fault((field,), f"there is no body {nearest(name, choices)}", choices))
    if field == "pairs" and len(set(names)) != 2:
        raise InputError(Fault((field,), f"a spring needs two different bodies, found {':'.join(names)}"))
    return names  # type: ignore[return-value]
