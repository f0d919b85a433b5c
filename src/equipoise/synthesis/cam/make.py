"""The profile of a chosen spring: its points as they are written, what runs on them, and how well that does."""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np

from ...model.arrays import Array
from ...model.elements.laws.profile import Cable, CamSpring, Pair, Profile, Roller
from .envelope import drawn, drive, of_cable, of_roller
from .search import STUB, Search, Trial, Wishes
from .springs import PUSHING
from .wanted import Wanted

POINTS = 181  # of a profile between the ends of the range
LEAD, LEAD_OUT = np.radians(30.0), np.radians(3.0)
"""[rad] that the cable lies on at least, where it is fixed; and that the profile goes on at its other end. Less where
the profile is nearly straight."""
OVER = np.radians(2.0)  # that a roller's profile goes on at both ends
TOUCH = 2e-5  # [m] that a profile may pass the line of its cable by
DIGITS = 12  # of points, in metres
GOOD = 1e-3  # share of the largest torque that the written points may differ by


def made(search: Search, trial: Trial, i: int, friction: float, diameter: float) -> Profile | None:
    """The profile of candidate number i; None where the rest of it would be in the way of its cable or roller."""
    wanted, wishes, offer = search.wanted, search.wishes, search.offers[int(trial.offer[i])]
    F0, k, a = (float(x[i]) for x in (trial.F0, trial.k, trial.a))
    angles = wanted.angles(POINTS)
    d = drive(wanted, wishes.turn, np.array([F0]), np.array([k]), angles)
    law, start = offer.law(k, F0, float(d.force.max()))
    spring = CamSpring(law, offer.part)
    body = "child" if wishes.turn > 0 else "parent"
    roller = wishes.roller is not None
    e = of_roller(d, np.array([a]), wishes.roller or 0.0, wishes.offset) if roller else of_cable(d, np.array([a]))
    points, along = drawn(d, e, a, wishes.bearing, roller)
    radius = e.radius[0]
    if ((points[1:] - points[:-1]) * along[:-1]).sum() < 0:
        points, along, radius = points[::-1], along[::-1], radius[::-1]
    ends = _bends(points)
    if roller:
        lengths = [OVER * float(e.reach.min())] * 2
    else:
        ends = [float(sign / r) for sign, r in zip(np.sign(ends), radius[[0, -1]], strict=True)]
        first, last = np.minimum(radius[[0, -1]], wishes.size / 2)
        lengths = [LEAD * first, LEAD_OUT * last]
    before = _arc(points[0], along[0], ends[0], -lengths[0], 24)
    after = _arc(points[-1], along[-1], ends[1], lengths[1], 4)
    rim = _pairs(np.vstack([before[::-1], points, after]))
    if roller:
        seat = a + (start if offer.kind in PUSHING else -start)
        line = Roller(wishes.roller or 0.0, wishes.bearing, wishes.offset, seat)
        found = Profile(rim, spring, body, roller=line, friction=friction)
    else:
        point = (a * cos(wishes.bearing), a * sin(wishes.bearing))
        found = Profile(rim, spring, body, Cable(point, 1.0, diameter=diameter), friction=friction)
        found = _tied(found, wanted, wishes, law.kind in PUSHING, start)
    return found if _sound(found, wanted) else None


def _tied(profile: Profile, wanted: Wanted, wishes: Wishes, pushes: bool, start: float) -> Profile:
    """With the length of its cable, and where the spring is behind a guide."""
    assert profile.cable is not None
    at = float(wanted.angles()[int(wanted.energy(wanted.angles()).argmin())])
    run = profile.run
    drawn = -1.0 if pushes else 1.0
    # how far the cable reaches from its end on the profile to its fixed point, where the spring is least loaded
    reach = drawn * np.interp(at, run.angle, run.length) + profile.cable.length
    most = float((drawn * run.length).max()) + profile.cable.length
    if not wishes.guide:
        behind, length = 0.0, reach - start
    elif pushes:
        behind = STUB
        length = start + reach + behind
    else:
        length = most + STUB
        behind = start - reach + length
    return replace(profile, cable=replace(profile.cable, length=float(length), behind=float(behind)))


def _arc(at: Array, along: Array, curvature: float, length: float, count: int) -> Array:
    """Points of an arc that goes on from a point, or back from it, without that point."""
    turn = curvature * length * (np.arange(count) + 1) / count
    side = np.array([-along[1], along[0]])
    straight = length * (np.arange(count) + 1) / count
    ahead, aside = (np.sinc(turn / np.pi), np.sinc(turn / 2 / np.pi) * np.sin(turn / 2))
    return at + (straight * ahead)[:, None] * along + (straight * aside)[:, None] * side


def _bends(points: Array) -> list[float]:
    """The curvature at both ends of a line through points, more than 0 to the left [1/m]."""
    found = []
    for p, q, r in (points[:3], points[-3:]):
        u, v, w = q - p, r - q, r - p
        found.append(2 * float(u[0] * v[1] - u[1] * v[0]) / float(np.prod([np.hypot(*x) for x in (u, v, w)])))
    return found


def _pairs(points: Array) -> tuple[Pair, ...]:
    return tuple((round(float(x), DIGITS), round(float(y), DIGITS)) for x, y in points)


def _sound(profile: Profile, wanted: Wanted) -> bool:
    """Whether the written points give the torque, and none of them is in the way of the cable or the roller."""
    run = profile.run
    if run.folds or run.angle[0] > wanted.low + 1e-6 or run.angle[-1] < wanted.high - 1e-6:
        return False
    angle = wanted.angles(721)
    off = np.interp(angle, run.angle, run.torque) - wanted.torque(angle)
    if np.abs(off).max() > GOOD * wanted.peak:
        return False
    points = np.array(profile.profile)
    if profile.roller:
        turned = profile.roller.direction - profile.turn * run.angle
        x, y = run.free, profile.roller.offset
        centre = np.stack([x * np.cos(turned) - y * np.sin(turned), x * np.sin(turned) + y * np.cos(turned)], axis=1)
        gap = np.linalg.norm(centre[::8, None] - points[None], axis=-1).min(axis=1) - profile.roller.radius
        return bool((gap > -TOUCH).all())
    step = np.gradient(run.contact, axis=0)
    normal = np.stack([step[:, 1], -step[:, 0]], axis=1) / np.linalg.norm(step, axis=1)[:, None]
    height = (points[None] - run.contact[::8, None]) @ normal[::8, :, None]
    return bool(min(height.max(), -height.min()) < TOUCH)
