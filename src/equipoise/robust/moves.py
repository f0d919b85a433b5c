"""What can be moved on a spring, and ways to follow a payload with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import Any, Literal

import numpy as np

from ..model.arrays import Array, frozen
from ..model.elements import lines
from ..model.mechanism import Mechanism

What = Literal["p_a", "p_b", "free_length"]
SPRINGS_MOVED = 3  # springs moved at once


@dataclass(frozen=True)
class Handle:
    """What can be moved: an attachment, or the free length, which is the preload."""

    spring: int
    what: What


@frozen
class Move:
    """An attachment (3,) or free length (1,) [m] of a spring at the smallest and at the largest payload."""

    spring: str
    what: What
    low: Array
    high: Array

    @property
    def travel(self) -> float:
        """[m] from the one to the other."""
        return float(np.linalg.norm(self.high - self.low))


@dataclass(frozen=True)
class Way:
    """One way to follow the payload.

    Attributes:
        share: what is left at the worse end of the range, of what the range of payload itself does, root mean square.
        work: [J] least and greatest over the workspace that goes into the springs from the smallest to the largest
            payload; negative is given back.
        low, high: the mechanism, without the payload, set for either.
    """

    moves: tuple[Move, ...]
    share: float
    work: tuple[float, float]
    low: Mechanism
    high: Mechanism

    def to_dict(self) -> dict[str, Any]:
        moves = [
            {"spring": m.spring, "what": m.what, "low": m.low.tolist(), "high": m.high.tolist(), "travel": m.travel}
            for m in self.moves
        ]
        return {"moves": moves, "share": self.share, "work": list(self.work)}


def sets(handles: Sequence[Handle]) -> Iterator[tuple[Handle, ...]]:
    """The handles, at most one of each spring and at most `SPRINGS_MOVED`, fewer first."""
    springs = sorted({handle.spring for handle in handles})
    for count in range(1, min(SPRINGS_MOVED, len(springs)) + 1):
        for some in combinations(springs, count):
            yield from product(*([h for h in handles if h.spring == i] for i in some))


def value(mechanism: Mechanism, handle: Handle) -> Array:
    return np.atleast_1d(np.array(getattr(lines(mechanism, "adjust")[handle.spring], handle.what), float))


def moved(mechanism: Mechanism, handles: Sequence[Handle], step: Array) -> Mechanism:
    """Every handle by its part of the step; a free length stays at least 0."""
    springs, start = list(lines(mechanism, "adjust")), 0
    for handle in handles:
        now = value(mechanism, handle)
        new = now + step[start : start + len(now)]
        start += len(now)
        changed = float(max(new[0], 0.0)) if handle.what == "free_length" else tuple(new.tolist())
        springs[handle.spring] = replace(springs[handle.spring], **{handle.what: changed})
    return mechanism.with_springs(springs)
