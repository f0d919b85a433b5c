"""What a cable runs along between its ends: points, and round pulleys that it lies on.

A cable on an endless cylinder is the shortest one that does not pass opposite the side that is given: the tests find
the same in MuJoCo. In the plane of the pulley it is two tangents and an arc, of the length P; rolled out, it is
straight, so its length is ``sqrt(P^2 + dz^2)`` with the distance dz of its ends along the axis. Where it does not
touch, it is straight.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array, frozen, vec3
from ..errors import Fault, finite, known, positive
from ..rotation import frame_of
from .element import Vec3

if TYPE_CHECKING:
    from ...kinematics import Poses, Tree, Velocities

TOUCH = 1e-12  # [m] nearer than this is on the cylinder


@dataclass(frozen=True)
class Guide:
    """A point of a body that a cable runs through.

    Attributes:
        body: its name.
        point: in the body's frame [m].
    """

    body: str
    point: Vec3

    def faults(self, bodies: tuple[str, ...]) -> Iterator[Fault]:
        """What is wrong with it, paths from it on."""
        yield from known(("body",), self.body, "body", bodies)
        yield from finite(("point",), self.point)


@dataclass(frozen=True)
class Pulley(Guide):
    """A round pulley that a cable lies on; `point` is its centre.

    Attributes:
        radius: [m], of the cable's middle.
        axis: in the body's frame, of any length but zero.
        side: a point outside the pulley on the side that the cable takes, in the body's frame [m].
    """

    radius: float
    axis: Vec3
    side: Vec3

    @property
    def frame(self) -> Array:
        """(3, 3) its axes as rows in the body's frame, its own axis last."""
        return frame_of(np.array(self.axis) / np.linalg.norm(self.axis))

    @property
    def towards(self) -> Array:
        """(2,) the direction of its side in its plane; no unit vector."""
        return (self.frame @ np.subtract(self.side, self.point))[:2]

    def faults(self, bodies: tuple[str, ...]) -> Iterator[Fault]:
        yield from super().faults(bodies)
        yield from positive(("radius",), self.radius, "m")
        for name in ("axis", "side"):
            yield from finite((name,), getattr(self, name))
        if not any(self.axis):
            yield Fault(("axis",), "must not be zero")
        sound = all(map(isfinite, (*self.axis, *self.side, *self.point))) and any(self.axis) and self.radius > 0
        if sound and (far := float(np.linalg.norm(self.towards))) <= self.radius:
            yield Fault(
                ("side",), f"must be outside the pulley, farther than its radius from its axis, found {far:g} m"
            )

    def circle(self, count: int = 24) -> list[Vec3]:
        """Points of its rim from the side all around, in the body's frame [m]."""
        start = np.arctan2(*self.towards[::-1])
        turn = start + np.linspace(0, 2 * np.pi, count + 1)
        rim = self.radius * np.stack([np.cos(turn), np.sin(turn), np.zeros(count + 1)], axis=1)
        return [vec3(p) for p in rim @ self.frame + np.array(self.point)]

    def wrap(self, tree: Tree, poses: Poses, x_a: Array, x_b: Array) -> Wrap:
        """How a cable between two points of the world (N, 3) [m] lies on it."""
        P = tree.index[self.body]
        R = self.frame @ np.swapaxes(poses.R[:, P], 1, 2)  # world -> its own axes
        centre = poses.point(P, np.array(self.point))
        a, b = (np.einsum("nij,nj->ni", R, x - centre) for x in (x_a, x_b))
        side = self.towards / np.linalg.norm(self.towards)
        return _wrapped(a, b, side, self.radius, R)

    def velocity(self, tree: Tree, poses: Poses, velocities: Velocities, x: Array) -> Array:
        """(N, 3, n) of what turns with it at points of the world (N, 3)."""
        P = tree.index[self.body]
        arm = x - poses.p[:, P]
        return velocities.v[:, P] + np.cross(velocities.w[:, P], arm[:, :, None], axis=1)


@frozen
class Wrap:
    """A cable between two points and a pulley.

    Attributes:
        length: (N,) [m].
        angle: (N,) of the arc that it lies on [rad]; 0 where it does not touch.
        fleet: (N,) angle between the cable and the plane of the pulley that it lies on [rad], else 0.
        pull_a, pull_b: (N, 3) change of the length per motion of either end, in the world.
        free_a, free_b: (N,) [m] from either end to where it touches; to the other end where it does not.
    """

    length: Array
    angle: Array
    fleet: Array
    pull_a: Array
    pull_b: Array
    free_a: Array
    free_b: Array


def _wrapped(a: Array, b: Array, side: Array, r: float, R: Array) -> Wrap:
    """Of ends (N, 3) in the pulley's axes, to which R (N, 3, 3) turns the world's; `side` (2,) is a unit vector."""
    rise, flat = b[:, 2] - a[:, 2], (a[:, :2], b[:, :2])
    # angles from the side on: the cable never passes opposite to it
    bearing = [np.arctan2(p @ (-side[1], side[0]), p @ side) for p in flat]
    turn = bearing[1] - bearing[0]
    far = [np.linalg.norm(p, axis=1) for p in flat]
    outside = np.minimum(*far) >= r
    to_touch = [np.arccos(np.minimum(r / np.maximum(size, r), 1.0)) for size in far]
    angle = np.where(outside, np.maximum(np.abs(turn) - to_touch[0] - to_touch[1], 0.0), 0.0)
    on, way = (angle > 0)[:, None], np.sign(turn)
    ends = []  # from where the cable leaves each end to the end; straight, from one end to the other
    for p, other, size, off, sign in zip(flat, flat[::-1], far, to_touch, (way, -way), strict=True):
        touching = _turned(p, sign * off) * (r / np.maximum(size, r))[:, None]
        ends.append(p - np.where(on, touching, other))
    reach = [np.linalg.norm(u, axis=1) for u in ends]
    P = np.where(on[:, 0], reach[0] + reach[1] + r * angle, reach[0])
    length = np.maximum(np.hypot(P, rise), TOUCH)
    pulls = []
    for u, size, sign in zip(ends, reach, (-1.0, 1.0), strict=True):
        own = np.concatenate([(P / np.maximum(size, TOUCH))[:, None] * u, sign * rise[:, None]], axis=1)
        pulls.append(np.einsum("nij,ni->nj", R, own / length[:, None]))
    free = [size * length / np.maximum(P, TOUCH) for size in reach]
    return Wrap(length, angle, np.where(on[:, 0], np.arctan2(np.abs(rise), P), 0.0), *pulls, *free)


def _turned(p: Array, angle: Array) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1]], axis=1)
