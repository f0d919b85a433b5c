"""Where a design counts: motions, poses with shares, a box that a point stays in. Values, as a file holds them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from .arrays import Array
from .errors import Fault, InputError
from .units import number

MOST = 20_000  # numbers of a motion or a list: a mechanism file holds no more
LARGEST, SHORTEST = 1e9, 1e-9  # [s, rad or m] of times and values, [s] between two times: beyond them rates overflow
USABLE = f"times and values are below {LARGEST:.0e} in size, and times are at least {SHORTEST:.0e} s apart"
CLOSED = 1e-9  # [rad or m] from the end to the start of a motion that closes
Rows = tuple[tuple[float, ...], ...]


def unusable(time: Array, values: Array) -> int | None:
    """The first row of times (T,) [s] and values (T, ...) [rad or m] that has no usable rate; None if all have."""
    sizes = np.abs(values).reshape(len(time), -1).max(axis=1, initial=0.0)
    far = (np.abs(time) > LARGEST) | (sizes > LARGEST) | (np.diff(time, prepend=-np.inf) < SHORTEST)
    return int(np.argmax(far)) if far.any() else None


@dataclass(frozen=True)
class Motion:
    """A motion through given positions.

    Attributes:
        coordinates: those that move; the others rest.
        time: (T,) [s], increasing.
        values: (T, coordinates) [rad or m].
        stops: at every row it stands still, and goes on to the next with minimum jerk; else it runs through them along
            a cubic spline. A motion that ends where it starts goes round and round.
        share: of its time, relative to that of other motions.

    Raises:
        InputError: times that do not increase, less than two rows (three of a spline), rows of another length.
    """

    coordinates: tuple[str, ...]
    time: tuple[float, ...]
    values: Rows
    stops: bool = False
    share: float = 1.0

    def __post_init__(self) -> None:
        values = tuple(tuple(float(x) for x in row) for row in self.values)
        object.__setattr__(self, "time", tuple(float(t) for t in self.time))
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "coordinates", tuple(self.coordinates))
        object.__setattr__(self, "share", number("share", self.share, positive=True))
        least = 2 if self.stops else 3
        steps = [b - a for a, b in zip(self.time, self.time[1:], strict=False)]
        if len(self.time) < least or min(steps) <= 0 or not all(map(isfinite, self.time)):
            raise InputError(Fault(("time",), f"a motion has at least {least} times, in increasing order"))
        if len(values) != len(self.time) or any(len(row) != len(self.coordinates) for row in values):
            raise InputError(Fault(("values",), "must have a row for every time, and a column for every coordinate"))
        if not all(isfinite(x) for row in values for x in row):
            raise InputError(Fault(("values",), "must be finite"))

    @property
    def cyclic(self) -> bool:
        """Whether it ends where it starts."""
        return all(abs(a - b) < CLOSED for a, b in zip(self.values[0], self.values[-1], strict=True))

    def to_dict(self) -> dict[str, Any]:
        """As a mechanism file has it."""
        columns = zip(*self.values, strict=True)
        joints = {name: list(column) for name, column in zip(self.coordinates, columns, strict=True)}
        return {
            "time": list(self.time),
            "joints": joints,
            **({"stops": True} if self.stops else {}),
            **({"share": self.share} if self.share != 1.0 else {}),
        }


@dataclass(frozen=True)
class Listed:
    """Poses one by one: `values` (N, coordinates) [rad or m], and what each counts (N,)."""

    coordinates: tuple[str, ...]
    values: Rows
    shares: tuple[float, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", tuple(tuple(float(x) for x in row) for row in self.values))
        object.__setattr__(self, "shares", tuple(number("share", x, positive=True) for x in self.shares))
        if not self.values or len(self.values) != len(self.shares):
            raise InputError(Fault(("values",), "must be poses, and a share for each"))

    def to_dict(self) -> dict[str, Any]:
        """As a mechanism file has it."""
        columns = zip(*self.values, strict=True)
        joints = {name: list(column) for name, column in zip(self.coordinates, columns, strict=True)}
        return {"joints": joints, **({"shares": list(self.shares)} if {*self.shares} != {1.0} else {})}


@dataclass(frozen=True)
class Box:
    """All poses inside the joint ranges in which a point of a body is in a box of the world [m]."""

    body: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if any(a > b for a, b in zip(self.low, self.high, strict=True)):
            raise InputError(Fault(("low",), f"must be at most 'high', found {[*self.low]}, {[*self.high]}"))

    def to_dict(self) -> dict[str, Any]:
        """As a mechanism file has it."""
        return {"body": self.body, "at": list(self.at), "low": list(self.low), "high": list(self.high)}


@dataclass(frozen=True)
class Where:
    """The poses that count: the joint ranges, or what is given instead of them.

    Attributes:
        motions: over their time; inertia counts.
        listed, box: see there.
        samples, seed: random poses inside the ranges, or in the box; by default exact averages where possible.
        whole_turns: all turning joints over whole turns, whatever their range.

    Raises:
        InputError: more than one of motions, a list and a box.
    """

    motions: tuple[Motion, ...] = ()
    listed: Listed | None = None
    box: Box | None = None
    samples: int | None = None
    seed: int = 0
    whole_turns: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "motions", tuple(self.motions))
        if sum((bool(self.motions), self.listed is not None, self.box is not None)) > 1:
            raise InputError("give motions, a list of poses or a box, and not several of them")

    @property
    def chosen(self) -> bool:
        """Whether poses are given instead of the joint ranges."""
        return bool(self.motions) or self.listed is not None or self.box is not None

    def where(self, count: int) -> str:
        """In words, where so many poses count."""
        if self.box is not None:
            return f"{count:,} random poses with the point of {self.box.body} in the box"
        if self.listed is not None:
            return f"the {count:,} poses of the list"
        return f"{'the motion' if len(self.motions) == 1 else f'{len(self.motions)} motions'}, at {count:,} times"

    def coordinates(self) -> Iterator[tuple[str, str]]:
        """Every coordinate that is named, and in which part."""
        for motion in self.motions:
            yield from (("motions", name) for name in motion.coordinates)
        if self.listed is not None:
            yield from (("list", name) for name in self.listed.coordinates)

    @property
    def size(self) -> int:
        """How many numbers a file has to hold."""
        every = [*self.motions, *([self.listed] if self.listed else [])]
        return sum(len(one.values) * (1 + len(one.coordinates)) for one in every)

    def to_dict(self) -> dict[str, Any]:
        """As a mechanism file has it, without what is as by default."""
        found = {
            "motions": [motion.to_dict() for motion in self.motions],
            "list": self.listed.to_dict() if self.listed else None,
            "box": self.box.to_dict() if self.box else None,
            "samples": self.samples,
            "seed": self.seed,
            "whole_turns": self.whole_turns,
        }
        return {name: value for name, value in found.items() if value}
