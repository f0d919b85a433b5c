"""The smallest distances of springs to links and to each other over the workspace, and springs that do not pull."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..energy.extremes import climb
from ..io import Source, loaded
from ..kinematics import Tree, sample
from ..model.arrays import Array, frozen
from ..model.elements import lines
from ..model.errors import InputError
from ..model.mechanism import Mechanism
from ..model.validate import MAX_NUMBERS, MAX_SAMPLES, whole_number
from .pairs import Pairs

TURNED = 1e-3  # of the largest lever arm: a smaller one has no sign
NUMBERS = 40  # that are held for each pair and sample


@frozen
class Gap:
    """The smallest distance between the surfaces of a spring and a capsule or another spring [m], and its pose (n,)."""

    spring: str
    other: str
    distance: float
    configuration: Array


@dataclass(frozen=True)
class Line:
    """A spring's states: the share of poses in which it is `slack`, shorter than its free length, and, of each
    coordinate that it goes over centre about, the share in which it pulls the other, rarer way."""

    spring: str
    slack: float
    over_centre: dict[str, float]


@dataclass(frozen=True)
class Clearance:
    """What is true of the room around springs; `gaps` smallest first. A spring may touch the links it is fixed to."""

    gaps: tuple[Gap, ...]
    lines: tuple[Line, ...]

    @property
    def least(self) -> float:
        """[m] inf where there is nothing to come close to."""
        return min((gap.distance for gap in self.gaps), default=np.inf)

    def to_dict(self) -> dict[str, Any]:
        return {
            "least": self.least if np.isfinite(self.least) else None,
            "gaps": [{**vars(gap), "configuration": gap.configuration.tolist()} for gap in self.gaps],
            "springs": [vars(line) for line in self.lines],
        }


def clearance(mechanism: Source, *, samples: int | None = None, seed: int = 0) -> Clearance:
    """Judge the room around the springs of a mechanism or a file: random poses, then a climb from the closest of them.

    Raises:
        InputError: no springs, or loops that cannot be closed; or as `load`.
    """
    mechanism = loaded(mechanism)
    if not mechanism.springs:
        raise InputError(f"mechanism '{mechanism.name}' has no springs")
    tree = Tree.of(mechanism)
    samples = mechanism.workspace.samples if samples is None else samples
    pairs = Pairs(mechanism)
    held = NUMBERS * (len(pairs.names) + len(mechanism.springs) + 1)
    whole_number("samples", samples, 1, max(1, min(MAX_SAMPLES, MAX_NUMBERS // held)))
    q = sample(tree, samples, seed)
    least, where = climb(tree, lambda x: -pairs.distances(tree.poses(x)), q, seed)
    gaps = [Gap(*name, float(-d), at) for name, d, at in zip(pairs.names, least, where, strict=True)]
    return Clearance(tuple(sorted(gaps, key=lambda gap: gap.distance)), tuple(_lines(mechanism, q)))


def _lines(mechanism: Mechanism, q: Array) -> list[Line]:
    """Of each spring: slack poses, and the coordinates about which its lever arm changes sign."""
    tree, found = Tree.of(mechanism), []
    poses = tree.poses(q)
    velocities = tree.velocities(q, poses)
    for spring in lines(mechanism, "clearance"):
        arm = spring.lever_arms(tree, poses, velocities)
        floor = TURNED * np.abs(arm).max(initial=0)
        rarer = np.minimum((arm > floor).mean(axis=0), (arm < -floor).mean(axis=0))
        over: dict[str, float] = {
            name: float(share) for name, share in zip(tree.coordinates, rarer, strict=True) if share > 0
        }
        slack = float((spring.path(tree, poses) < spring.free_length).mean())
        found.append(Line(spring.name, slack, over))
    return found
