"""Where a spring may be attached to a body: a ball or a box, and the coordinates of its own that a search moves in."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..model.arrays import Array, Booleans
from ..model.elements import Vec3
from ..model.errors import Fault, InputError
from ..model.units import Amount, quantity

Shape = Literal["ball", "box"]
SHAPES: tuple[Shape, ...] = ("ball", "box")
EXTREME = 1e6  # regions so much smaller or larger than the mechanism are beyond double precision
ROUNDING = 4 * np.finfo(float).eps
RIM = 1 - 1e-12  # in a region's own coordinates: on its boundary


@dataclass(frozen=True)
class Region:
    """Where a spring may be attached to a body: within `half` of `centre`, in the body's frame [m].

    A ball of radius ``half[0]``, or a box of half sides `half`.
    """

    centre: tuple[float, float, float]
    half: tuple[float, float, float]
    shape: Shape = "ball"

    @staticmethod
    def ball(radius: Amount, centre: Iterable[Amount] = (0.0, 0.0, 0.0)) -> Region:
        """A ball around `centre` [m]."""
        r = quantity(radius, "length", "radius")
        return Region(_point(centre, "centre"), (r, r, r), "ball")

    @staticmethod
    def box(half: Amount | Iterable[Amount], centre: Iterable[Amount] = (0.0, 0.0, 0.0)) -> Region:
        """A box around `centre`, +-`half` along each axis of the body [m]."""
        sides = [half] * 3 if isinstance(half, (str, float, int)) else half
        return Region(_point(centre, "centre"), _point(sides, "half"), "box")

    @staticmethod
    def of(given: Region | Amount, body: str, shape: Shape = "ball") -> Region:
        """The region itself, or the one of this radius, or half side, around the body's origin [m]."""
        if isinstance(given, Region):
            return given
        size = quantity(given, "length", "regions", body)
        return Region.ball(size) if shape == "ball" else Region.box(size)

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

    def inside(self, u: Array) -> Array:
        """(3,) [m] where u (3,), a point of the unit ball or box, is in the body's frame, not outside by rounding."""
        centre, half = np.array(self.centre), np.array(self.half)
        away = np.abs(centre) if self.shape == "box" else np.full(3, np.abs(centre).max())
        return centre + u * np.maximum(half - ROUNDING * (half + away), 0.0)

    def check(self, body: str, reach: float) -> None:
        """Whether its size is in proportion to a mechanism of this reach [m].

        Raises:
            InputError: it is not, or it has no size.
        """
        size = max(self.half)
        if not (np.isfinite([*self.half, *self.centre]).all() and min(self.half) >= 0 and size > 0):
            raise InputError(Fault(("regions", body), f"its size must be more than 0 m, found {size:g}"))
        if not reach / EXTREME <= size <= reach * EXTREME:
            limits = f"{reach / EXTREME:.1g} m and {reach * EXTREME:.1g} m"
            raise InputError(Fault(("regions", body), f"its size must be between {limits}, found {size:g} m"))


def _point(values: Iterable[Amount], field: str) -> Vec3:
    x, y, z = (quantity(value, "length", field) for value in values)
    return x, y, z


def project(u: Array, is_box: Booleans) -> Array:
    """The nearest point of each region: the unit box or the unit ball. u: (..., 3), is_box: (...)."""
    norm = np.linalg.norm(u, axis=-1, keepdims=True)
    return np.where(is_box[..., None], np.clip(u, -1, 1), u / np.maximum(norm, 1.0))


def free_directions(u: Array, gradient: Array, is_box: Booleans) -> Array:
    """(..., 3, 3) projectors onto the steps that do not leave a region through its boundary, downhill of `gradient`."""
    out_of_box = (np.abs(u) >= RIM) & (gradient * u < 0)
    at_rim = (np.linalg.norm(u, axis=-1) >= RIM) & (np.einsum("...i,...i", gradient, u) < 0)
    keep_box = np.where(out_of_box, 0.0, 1.0)[..., None] * np.eye(3)
    keep_ball = np.eye(3) - np.where(at_rim[..., None, None], u[..., :, None] * u[..., None, :], 0.0)
    return np.where(is_box[..., None, None], keep_box, keep_ball)
