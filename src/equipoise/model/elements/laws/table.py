"""The law of a table: measured points of path and force, interpolated smoothly and without overshoot."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...arrays import Array
from ...errors import Fault
from .law import Law, State, listed
from .pieces import Pieces

if TYPE_CHECKING:
    from ....energy.kernel.trace import Trace, Value

Points = tuple[tuple[float, float], ...]
MOST = 200
"""Points of a table."""


def of_points(points: Points, noun: str) -> Iterator[Fault]:
    """What is wrong with the points of a table."""
    if not 2 <= len(points) <= MOST:
        yield Fault(("points",), f"a {noun} has 2 to {MOST} points, found {len(points)}")
    for i, point in enumerate(points):
        if not np.isfinite(point).all():
            yield Fault(("points", i), "must be finite")
        elif i and point[0] <= points[i - 1][0]:
            yield Fault(("points", i), f"must go up: {point[0]:g} follows {points[i - 1][0]:g}")


@dataclass(frozen=True)
class Table(Law):
    """Through measured points of path and force by cubics that rise and fall only where the points do (PCHIP).

    Beyond its ends the force stays as it is there, which `states` reports.

    Attributes:
        points: of length [m] and force [N], or of angle [rad] and torque [N m]; more than 0 pulls towards less.

    Source: Fritsch and Carlson, Monotone piecewise cubic interpolation, SIAM J. Numer. Anal. 17 (1980) 238, as scipy's
    `PchipInterpolator` has it.
    """

    kind: ClassVar[str] = "table"
    noun: ClassVar[str] = "a measured spring"

    points: Points = listed("path", "force")

    @cached_property
    def pieces(self) -> Pieces:
        """The cubics."""
        from scipy.interpolate import PchipInterpolator

        s, force = np.array(self.points, float).T
        found = PchipInterpolator(s, force)
        return Pieces(found.x, found.c)

    def energy(self, s: Array) -> Array:
        return self.pieces.energy(s)

    def pull(self, s: Array) -> Array:
        return self.pieces.pull(s)

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        return self.pieces.of_path(t, s)

    def extremes(self, low: float, high: float) -> tuple[float, float]:
        return self.pieces.extremes(low, high)

    def faults(self) -> Iterator[Fault]:
        yield from of_points(self.points, "table")

    def values(self) -> dict[str, Any]:
        return {"points": [list(point) for point in self.points]}

    @property
    def states(self) -> tuple[State, ...]:
        return outside(self.points)

    @property
    def strength(self) -> tuple[float, str]:
        return max((force for _, force in self.points), key=abs), ""

    def words(self) -> str:
        return f"{len(self.points)} points"

    def scaled(self, factor: float) -> Table:
        return replace(self, points=tuple((s, factor * force) for s, force in self.points))


def outside(points: Points) -> tuple[State, State]:
    """That a table was left."""
    return (
        State("below its table", points[0][0], above=False, limit=True),
        State("beyond its table", points[-1][0], above=True, limit=True),
    )
