"""The smallest distances of springs, weights and links over the workspace, and springs that do not pull."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..energy.extremes import climb
from ..io import Source, loaded
from ..kinematics import Poses, Tree, sample
from ..model.arrays import Array, frozen
from ..model.elements import AlongLine, Spring
from ..model.errors import EquipoiseWarning, InputError
from ..model.mechanism import Mechanism
from ..model.validate import MAX_NUMBERS, MAX_SAMPLES, whole_number
from .pairs import Pairs

TURNED = 1e-3  # of the largest lever arm: a smaller one has no sign
NUMBERS = 40  # that are held for each pair and sample


@frozen
class Gap:
    """The smallest distance between the surfaces of a spring or weight and another part [m], and its pose (n,)."""

    spring: str
    other: str
    distance: float
    configuration: Array


@dataclass(frozen=True)
class SpringStates:
    """A spring's states: the share of poses in which it is `slack`, shorter than its free length, and, of each
    coordinate that it goes over centre about, the share in which it pulls the other, rarer way."""

    spring: str
    slack: float
    over_centre: dict[str, float]


@dataclass(frozen=True)
class Clearance:
    """What is true of the room around springs and weights. A spring may touch the links it is fixed to.

    Attributes:
        gaps: smallest first.
        lines: the springs between two points.
        nearest: (samples,) least distance of all at each random pose [m]; inf where there is nothing to come close to.
        links: whether anything says how large the links are; where nothing does, they are not judged.
        left_out: what is not judged, and why.
    """

    gaps: tuple[Gap, ...]
    lines: tuple[SpringStates, ...]
    nearest: tuple[float, ...] = ()
    links: bool = True
    left_out: tuple[str, ...] = ()

    @property
    def least(self) -> float:
        """[m] inf where there is nothing to come close to."""
        return min((gap.distance for gap in self.gaps), default=np.inf)

    @property
    def of_springs(self) -> tuple[Gap, ...]:
        """The gaps that a spring has a part in: what moving springs can change."""
        springs = {line.spring for line in self.lines}
        return tuple(gap for gap in self.gaps if springs & {gap.spring, gap.other})

    @property
    def least_of_springs(self) -> float:
        """[m] inf where there is nothing for springs to come close to."""
        return min((gap.distance for gap in self.of_springs), default=np.inf)

    def free(self, limit: float) -> float:
        """The share of the random poses in which every distance is at least `limit` [m]."""
        return float(np.mean(np.array(self.nearest) >= limit)) if self.nearest else 1.0

    def clear(self, limit: float) -> bool:
        """Whether every distance is at least `limit` [m], those to the links included."""
        return self.links and self.least >= limit

    def to_dict(self, limit: float = 0.0) -> dict[str, Any]:
        return {
            "least": self.least if np.isfinite(self.least) else None,
            "judged": {"links": self.links, "left_out": list(self.left_out)},
            "free": {"share": self.free(limit), "limit": limit, "samples": len(self.nearest)},
            "gaps": [{**vars(gap), "configuration": gap.configuration.tolist()} for gap in self.gaps],
            "springs": [vars(line) for line in self.lines],
        }


def clearance(mechanism: Source, *, samples: int | None = None, seed: int = 0) -> Clearance:
    """Judge the room around the springs, cables, weights and auxiliary links of a mechanism or a file.

    At random poses, then by a climb from the closest of them. Links are as large as the file's capsules and shapes say.

    Raises:
        InputError: no springs and no weights, loops that cannot be closed, or a shape that needs the extra `room`; or
            as `load`.

    Warns:
        EquipoiseWarning: meshes that are missing, by name.
    """
    mechanism = loaded(mechanism)
    if not mechanism.springs and not mechanism.masses:
        raise InputError(f"mechanism '{mechanism.name}' has no springs and no weights")
    tree = Tree.of(mechanism)
    samples = mechanism.workspace.samples if samples is None else samples
    pairs = Pairs(mechanism)
    if pairs.room.missing:
        what = "meshes that are not there or cannot be read are not judged"
        warnings.warn(f"{what}: {', '.join(pairs.room.missing)}", EquipoiseWarning, stacklevel=2)
    held = NUMBERS * (len(pairs.names) + len(mechanism.springs) + 1)
    whole_number("samples", samples, 1, max(1, min(MAX_SAMPLES, MAX_NUMBERS // held)))
    q = sample(tree, samples, seed)
    known = np.full(len(pairs.names), np.inf)
    _, where = climb(tree, lambda x: -pairs.distances(tree.poses(x), known), q, seed)
    least = np.diagonal(pairs.distances(tree.poses(where))) if len(where) else np.zeros(0)
    poses = tree.poses(q)
    gaps = [Gap(*name, float(d), at) for name, d, at in zip(pairs.names, least, where, strict=True)]
    return Clearance(
        tuple(sorted(gaps, key=lambda gap: gap.distance)),
        tuple(_lines(mechanism, poses, tree, q)),
        tuple(pairs.nearest(poses).tolist()),
        pairs.room.links,
        (*pairs.room.sizeless, *pairs.room.missing),
    )


def _lines(mechanism: Mechanism, poses: Poses, tree: Tree, q: Array) -> list[SpringStates]:
    """Of each spring along a line: slack poses, and the coordinates about which its lever arm changes sign."""
    found = []
    velocities = tree.velocities(q, poses)
    for spring in mechanism.springs:
        if not isinstance(spring, AlongLine):
            continue
        arm = spring.lever_arms(tree, poses, velocities)
        floor = TURNED * np.abs(arm).max(initial=0)
        rarer = np.minimum((arm > floor).mean(axis=0), (arm < -floor).mean(axis=0))
        over: dict[str, float] = {
            name: float(share) for name, share in zip(tree.coordinates, rarer, strict=True) if share > 0
        }
        path = spring.path(tree, poses)
        short = [path < spring.free_length] if isinstance(spring, Spring) else []
        short += [state.holds(path) for state in spring.law.states if state.name == "slack"]
        found.append(SpringStates(spring.name, float(np.any(short, axis=0).mean()) if short else 0.0, over))
    return found
