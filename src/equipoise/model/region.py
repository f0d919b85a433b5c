"""Where springs may be attached to a body: a ball, a box that may be flat, a point; several are a union."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import TYPE_CHECKING, Literal

import numpy as np

from .arrays import Array
from .elements import Vec3
from .errors import Fault, InputError, Path, finite, nearest
from .units import Amount, quantity

if TYPE_CHECKING:
    from .mechanism import Joint

Shape = Literal["ball", "box"]
SHAPES: tuple[Shape, ...] = ("ball", "box")
EXTREME = 1e6  # regions so much smaller or larger than the mechanism are beyond double precision
ROUNDING = 4 * np.finfo(float).eps
ORIGIN = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Region:
    """Where a spring may be attached to a body: within `half` of `centre`, in the body's frame [m].

    A ball of radius ``half[0]``, or a box of half sides `half`. A half side of 0 keeps a box in a plane, two keep it on
    a line, three at a point. The centre may be the name of a joint on the body: it is where that joint sits.
    """

    centre: Vec3 | str
    half: Vec3
    shape: Shape = "ball"

    @staticmethod
    def ball(radius: Amount, centre: Iterable[Amount] | str = ORIGIN) -> Region:
        """A ball around `centre` [m]."""
        r = quantity(radius, "length", "radius")
        return Region(_centre(centre), (r, r, r), "ball")

    @staticmethod
    def box(half: Amount | Iterable[Amount], centre: Iterable[Amount] | str = ORIGIN) -> Region:
        """A box around `centre`, +-`half` along each axis of the body [m]."""
        sides = [half] * 3 if isinstance(half, (str, float, int)) else half
        return Region(_centre(centre), _point(sides, "half"), "box")

    @staticmethod
    def point(centre: Iterable[Amount] | str = ORIGIN) -> Region:
        """A fixed point [m]."""
        return Region(_centre(centre), ORIGIN, "box")

    @staticmethod
    def of(given: Region | Amount, body: str, shape: Shape = "ball") -> Region:
        """The region itself, or the one of this radius, or half side, around the body's origin [m]."""
        if isinstance(given, Region):
            return given
        size = quantity(given, "length", "regions", body)
        if size == 0:
            raise InputError(Fault(("regions", body), "its size must be more than 0 m, found 0"))
        return Region.ball(size) if shape == "ball" else Region.box(size)

    @property
    def axes(self) -> tuple[int, ...]:
        """Those of the body along which there is a choice."""
        return tuple(i for i, h in enumerate(self.half) if h)

    @property
    def at(self) -> Vec3:
        """The centre [m]; a joint's name has been looked up by `on`."""
        if isinstance(self.centre, str):
            raise InputError(f"where joint '{self.centre}' sits is known with a mechanism: Region.on")
        return self.centre

    def on(self, body: str, joints: Sequence[Joint]) -> Region:
        """The region with the place of its joint as centre, on a body of a mechanism with these joints.

        Raises:
            InputError: no such joint is on the body.
        """
        if not isinstance(self.centre, str):
            return self
        here = {j.name: j.xyz for j in joints if j.parent == body} | {j.name: ORIGIN for j in joints if j.child == body}
        if self.centre not in here:
            raise InputError(
                Fault(("centre",), f"body '{body}' has no joint {nearest(self.centre, here)}", tuple(here))
            )
        return replace(self, centre=here[self.centre])

    def times(self, factor: float) -> Region:
        """The region enlarged about its centre."""
        hx, hy, hz = (factor * h for h in self.half)
        return replace(self, half=(hx, hy, hz))

    @property
    def lift(self) -> Array:
        """(4, 4) maps the region's own coordinates [u; 1], u in the unit ball or box, to body coordinates [p; 1]."""
        L = np.diag([*self.half, 1.0])
        L[:3, 3] = self.at
        return L

    def inside(self, u: Array) -> Array:
        """(3,) [m] where u (3,), a point of the unit ball or box, is in the body's frame, not outside by rounding."""
        centre, half = np.array(self.at), np.array(self.half)
        away = np.abs(centre) if self.shape == "box" else np.full(3, np.abs(centre).max())
        return centre + u * np.maximum(half - ROUNDING * (half + away), 0.0)

    def faults(self, path: Path = ()) -> Iterator[Fault]:
        """What is wrong with its numbers."""
        if not isinstance(self.centre, str):
            yield from finite((*path, "centre"), self.centre)
        sizes = self.half[:1] if self.shape == "ball" else self.half
        if not (all(map(isfinite, sizes)) and min(sizes) >= 0 and (self.shape == "box" or sizes[0] > 0)):
            least = "more than 0 m" if self.shape == "ball" else "at least 0 m"
            found = ", ".join(f"{size:g}" for size in sizes)
            yield Fault((*path, self.shape), f"its size must be {least}, found {found}")

    def check(self, body: str, reach: float) -> None:
        """Whether its sizes, where they are not 0, are in proportion to a mechanism of this reach [m].

        Raises:
            InputError: they are not, or are no sizes.
        """
        for fault in self.faults():
            raise InputError(Fault(("regions", body), fault.message))
        for size in self.half:
            if size and not reach / EXTREME <= size <= reach * EXTREME:
                limits = f"{reach / EXTREME:.1g} m and {reach * EXTREME:.1g} m"
                raise InputError(Fault(("regions", body), f"its size must be between {limits}, found {size:g} m"))

    def to_dict(self) -> dict[str, object]:
        """As plain data."""
        return {"shape": self.shape, "centre": list(self.at), "half": list(self.half)}


@dataclass(frozen=True)
class Attachment:
    """A region of a body, as a mechanism file has it; several of one body are a union."""

    body: str
    region: Region


def _centre(centre: Iterable[Amount] | str) -> Vec3 | str:
    return centre if isinstance(centre, str) else _point(centre, "centre")


def _point(values: Iterable[Amount], field: str) -> Vec3:
    x, y, z = (quantity(value, "length", field) for value in values)
    return x, y, z
