"""What a cam is made of: a profile that turns with a joint, a cable or a roller on it, and the spring behind that.

All is in the plane of the joint, whose axes are the first two rows of `frame_of(axis)`, in either of the joint's bodies
at angle 0. What the profile gives follows from the curve through its points alone. At each of its points the tangent is
where the cable leaves it, or the normal where the roller touches it; that the cable then ends in its fixed point, or
the roller on its line, says at which angle of the joint this is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import cached_property
from math import hypot, isfinite
from typing import Any

import numpy as np

from ...arrays import Array, frozen
from ...errors import Fault, at_least, finite, positive
from .curve import Curve
from .law import Law, plain
from .table import Points

Pair = tuple[float, float]
MOST = 2000
"""Points of a profile."""
FIXED_TO = ("child", "parent")


@dataclass(frozen=True)
class Cable:
    """A cable from the profile's first point, where it is fixed, along the profile to `point` and on to the spring.

    Attributes:
        point: of the other body [m]: the spring's fixed end, or a guide behind which the spring is.
        length: from the profile's first point to the spring's moving end [m].
        behind: from `point` on to the spring's fixed end [m].
        diameter: [m]; the profile is where the cable's middle runs.
    """

    point: Pair
    length: float
    behind: float = 0.0
    diameter: float = 0.0

    def faults(self) -> Iterator[Fault]:
        """What is wrong with it, paths from it on."""
        yield from finite(("point",), self.point)
        yield from positive(("length",), self.length, "m")
        yield from at_least(("behind",), self.behind, 0, "m")
        yield from at_least(("diameter",), self.diameter, 0, "m")


@dataclass(frozen=True)
class Roller:
    """A roller that a spring presses on the profile; it slides along a line of the other body.

    Attributes:
        radius: [m]; direction: of the line away from the axis [rad].
        offset: of the line from the axis [m], more than 0 on the left of its direction.
        seat: where the spring's fixed end is along the line [m].
    """

    radius: float
    direction: float
    offset: float = 0.0
    seat: float = 0.0

    def faults(self) -> Iterator[Fault]:
        """What is wrong with it, paths from it on."""
        yield from positive(("radius",), self.radius, "m")
        for name in ("direction", "offset", "seat"):
            yield from finite((name,), (getattr(self, name),))


@dataclass(frozen=True)
class CamSpring:
    """The spring behind the cable or the roller: a law on its length, and what it is ordered by."""

    law: Law
    part: str = ""


@frozen
class Run:
    """What a profile gives along its points, (n,) each, in the order of the joint's angle.

    Attributes:
        angle: of the joint [rad].
        length: of the spring [m].
        force: that the cable pulls or the spring presses with [N], more than 0 as it should.
        lever: change of the spring's energy per angle, over the force [m].
        energy: of the spring [J]; torque: its slope [N m].
        radius: of curvature [m], more than 0 where the profile is convex; inf where it is straight.
        reach: from the axis [m].
        free: of the cable from the profile to its point, or of the roller's centre from the axis, along its line [m].
        lean: of the roller's pressure on its line [rad]; 0 of a cable.
        contact: (n, 2) where on the profile, in its own body's axes [m].
        folds: whether the angle goes back somewhere: then the cable leaves the profile, or the roller does not fit.
    """

    angle: Array
    length: Array
    force: Array
    lever: Array
    energy: Array
    torque: Array
    radius: Array
    reach: Array
    free: Array
    lean: Array
    contact: Array
    folds: bool


@dataclass(frozen=True)
class Profile:
    """A profile with what runs on it.

    Attributes:
        profile: its points [m], from the end on where a cable is fixed to it.
        spring: behind the cable or roller.
        fixed_to: the body that the profile turns with: the joint's child or its parent.
        cable, roller: one of them.
        friction: share of the torque that is lost in the cable's bending or the roller's turning: a margin.
    """

    profile: Points
    spring: CamSpring
    fixed_to: str = "child"
    cable: Cable | None = None
    roller: Roller | None = None
    friction: float = 0.0

    @property
    def pushes(self) -> bool:
        """Whether the spring pushes: then it gets shorter as the cable or the roller takes energy to it."""
        return self.spring.law.kind in ("compression", "gas")

    @property
    def turn(self) -> float:
        """How much the profile turns against the other body for each radian of the joint."""
        return 1.0 if self.fixed_to == "child" else -1.0

    @cached_property
    def run(self) -> Run:
        """What it gives along its points."""
        curve = Curve.through(self.profile)
        with np.errstate(invalid="ignore", divide="ignore"):
            turned, drawn, slope, free, lean, radius = (self._cable if self.cable else self._roller)(curve)
        length = -drawn if self.pushes else drawn
        force = self.spring.law.pull(length) * (-1 if self.pushes else 1)
        angle, lever = self.turn * turned, self.turn * slope
        reach, energy = np.hypot(*curve.at.T), self.spring.law.energy(length)
        rows = (angle, length, force, lever, energy, force * lever, radius, reach, free, lean, curve.at)
        order = slice(None, None, -1) if angle[-1] < angle[0] else slice(None)
        rows = tuple(row[order] for row in rows)
        return Run(*rows, folds=not (np.diff(rows[0]) > 0).all())

    def _cable(self, c: Curve) -> tuple[Array, ...]:
        """Of each point of the curve: how far the profile is turned, how far the spring is drawn and its slope, what is
        free of the cable, its lean, and the radius of curvature."""
        assert self.cable is not None
        far = hypot(*self.cable.point)
        normal = np.stack([c.along[:, 1], -c.along[:, 0]], axis=1)
        h = (c.at * normal).sum(axis=1)
        free = np.sqrt(far**2 - h**2) - (c.at * c.along).sum(axis=1)
        end = c.at + free[:, None] * c.along
        turned = np.arctan2(self.cable.point[1], self.cable.point[0]) - np.unwrap(np.arctan2(end[:, 1], end[:, 0]))
        drawn = c.length + free - self.cable.length + self.cable.behind
        convex = np.sign(np.median(c.curvature))
        return _near(turned), drawn, -h, free, np.zeros_like(h), _inverse(convex * c.curvature)

    def _roller(self, c: Curve) -> tuple[Array, ...]:
        assert self.roller is not None
        r, e = self.roller.radius, self.roller.offset
        left = np.stack([-c.along[:, 1], c.along[:, 0]], axis=1)
        side = np.sign(np.median((c.at * left).sum(axis=1)))  # away from the axis
        Q = c.at + r * side * left
        dQ = (1 - r * side * c.curvature)[:, None] * c.along  # per length of the profile
        s = np.sqrt((Q**2).sum(axis=1) - e**2)
        ds = (Q * dQ).sum(axis=1) / s
        turned = self.roller.direction + np.arctan2(e, s) - np.unwrap(np.arctan2(Q[:, 1], Q[:, 0]))
        across = Q[:, 0] * dQ[:, 1] - Q[:, 1] * dQ[:, 0]
        dturned = -e * ds / (s**2 + e**2) - across / (Q**2).sum(axis=1)
        slope = ds / dturned
        return _near(turned), s - self.roller.seat, slope, s, np.arctan2(slope + e, s), _inverse(-side * c.curvature)

    def values(self) -> dict[str, Any]:
        """The file's keys and their values, as plain data."""
        own = {"profile": plain(self.profile), "fixed_to": self.fixed_to}
        for name in ("cable", "roller"):
            if (part := getattr(self, name)) is not None:
                own[name] = {f.name: plain(getattr(part, f.name)) for f in fields(part)}
        spring = {"kind": self.spring.law.kind, **self.spring.law.values()}
        own["spring"] = spring | ({"part": self.spring.part} if self.spring.part else {})
        return own | ({"friction": self.friction} if self.friction else {})

    def scaled(self, factor: float) -> Profile:
        """The same with a spring so many times as strong."""
        return replace(self, spring=replace(self.spring, law=self.spring.law.scaled(factor)))

    def faults(self) -> Iterator[Fault]:
        """What is wrong with it, paths from the element on."""
        if not 4 <= len(self.profile) <= MOST:
            yield Fault(("profile",), f"a profile has 4 to {MOST} points, found {len(self.profile)}")
        for i, point in enumerate(self.profile):
            if not np.isfinite(point).all():
                yield Fault(("profile", i), "must be finite")
            elif i and point == self.profile[i - 1]:
                yield Fault(("profile", i), "is the same as the one before")
        if (self.cable is None) == (self.roller is None):
            yield Fault(("profile",), "give 'cable' or 'roller', and not both: what runs on the profile")
        for name in ("cable", "roller"):
            if (own := getattr(self, name)) is not None:
                for fault in own.faults():
                    yield replace(fault, path=(name, *fault.path))
        for fault in self.spring.law.faults():
            yield replace(fault, path=("spring", *fault.path))
        if self.fixed_to not in FIXED_TO:
            yield Fault(("fixed_to",), f"unknown body '{self.fixed_to}'", FIXED_TO)
        if not (isfinite(self.friction) and 0 <= self.friction < 1):
            yield Fault(("friction",), f"must be a share from 0 to 1, found {self.friction:g}")


def _near(angle: Array) -> Array:
    """The same angle, so many whole turns away that its middle is within half a turn."""
    middle = float(np.nan_to_num(angle).mean())
    return np.asarray(angle - 2 * np.pi * np.round(middle / (2 * np.pi)))


def _inverse(curvature: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.asarray(1 / curvature)
