"""How far a spring is stretched, as it is really installed: a function of where its far end is.

Every law takes the vector d (N, 3) [m] from attachment A to attachment B, in the frame of A's body, and gives the
stretch (N,) [m] and its gradient (N, 3) by d. The energy is k/2 stretch^2; that of zero free length is d's length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...model.arrays import Array
from ...model.elements import Vec3

Stretch = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class Straight:
    """A spring in line between its attachments; `free_length` [m] 0 is the ideal."""

    free_length: float = 0.0

    def __call__(self, d: Array) -> tuple[Array, Array]:
        length = np.linalg.norm(d, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            direction = np.where(length[:, None] > 0, d / length[:, None], 0.0)
        return length - self.free_length, direction


@dataclass(frozen=True)
class Pulley:
    """A cable from B over a pulley at A to a spring elsewhere on A's body.

    The cable comes to A along `along` and leaves over a pulley that touches it there and swivels about it; in a planar
    mechanism that is a pair of fixed pulleys, one on either side. With `radius` 0, an eyelet, it is ideal.

    Attributes:
        radius: of the pulley, to the middle of the cable [m].
        along: unit vector in the frame of A's body.
        preload: [m] by which the spring is stretched when the cable's far end is at A.
    """

    radius: float
    along: Vec3
    preload: float = 0.0

    def __call__(self, d: Array) -> tuple[Array, Array]:
        c, r = np.array(self.along), self.radius
        x = d @ c
        across = d - x[:, None] * c
        y = np.linalg.norm(across, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            n = np.where(y[:, None] > 0, across / y[:, None], 0.0)
        # in the plane of c and n the pulley's centre is at (0, r); the cable lies on it from (0, 0) on, over `wrap`
        free = np.sqrt(np.maximum(x**2 + (y - r) ** 2 - r**2, 0.0))
        wrap = np.mod(np.arctan2(y - r, x) + np.arctan2(r, free) + SLIP, 2 * np.pi) - SLIP
        stretch = r * wrap + free + self.preload
        return stretch, np.cos(wrap)[:, None] * c + np.sin(wrap)[:, None] * n


SLIP = 1e-9  # [rad] a wrap just below nothing is nothing, not a whole turn


def beyond(law: Pulley, d: Array) -> Array:
    """(N,) [m] how far B is outside the pulley; negative where no cable can be drawn."""
    x = d @ np.array(law.along)
    y = np.linalg.norm(d - x[:, None] * np.array(law.along), axis=1)
    return np.hypot(x, y - law.radius) - law.radius
