"""Which spring, preload and fixed point: many are tried at once, the best of them are varied.

What must hold of a profile is a list of demands, each a number and its limit. So an answer "no" can say which demand
fails, and how far it would have to give way for the others to hold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan
from typing import NamedTuple

import numpy as np

from ...model.arrays import Array, Booleans, Integers, frozen
from .envelope import drive, of_cable, of_roller
from .springs import PUSHING, Offer
from .wanted import Wanted

ANGLES = 61
GRID = 12  # values of each quantity that are tried
ROUNDS, KEPT, TRIES = 6, 20, 32  # the best so many are varied so often
BLOCK = 20_000  # candidates at once
PARTS = 120  # of a list at once
STUB = 0.01  # [m] of cable between the spring and the profile or guide, at the least
FULL = np.radians(330.0)
"""[rad] that a cable may lie on a profile in one plane."""
SLACK = 1e-9
MISSED = 1e-2  # share of a limit


class Demand(NamedTuple):
    """A number of a profile that must not be less (`above`), or more, than a limit; `help` says how it gives way."""

    name: str
    limit: float
    above: bool
    help: str
    unit: str = "mm"
    factor: float = 1e3


@dataclass(frozen=True)
class Wishes:
    """What is asked of a cam; lengths in m, forces in N.

    Attributes:
        turn: 1 where the profile turns with the joint, -1 against it.
        size: the farthest point of the profile from the axis, at most.
        least_radius: of curvature; hub: the axis is at least so far inside the profile, or None: then
            it may be outside, beside a plane that has room for it.
        fixed: the cable's fixed point, from the axis, at most; bearing: its direction [rad].
        at: the distance itself, where it is given.
        preload: the least force is at least this share of the largest.
        stiffness, force: the spring's rate and its least force, where they are given.
        guide: the spring is behind a guide, else it is between the profile and the fixed point.
        roller: radius of a roller in place of a cable; offset: of its line; lean: of its pressure at most [rad].
    """

    turn: float
    size: float
    least_radius: float
    hub: float | None
    fixed: float
    bearing: float
    preload: float
    at: float = nan
    stiffness: float = nan
    force: float = nan
    guide: bool = False
    roller: float | None = None
    offset: float = 0.0
    lean: float = 0.0

    @property
    def demands(self) -> list[Demand]:
        """What must hold, each in the order of the columns of `Trial.values`."""
        bent = "least radius of curvature" if self.roller is None else "least radius of what bulges"
        found = [
            Demand("largest size", self.size, False, "a size of {}"),
            Demand(bent, self.least_radius, True, "a least_radius of {}"),
            Demand("least force, of the largest,", self.preload, True, "a preload of {}", "%", 100.0),
            Demand("force, of what the spring bears,", 1.0, False, "a spring that bears {} of that", "%", 100.0),
            Demand("force, of where the spring begins,", 1.0, True, "", "%", 100.0),
        ]
        if self.hub is not None:
            found.append(Demand("the axis inside the profile by", self.hub, True, "a hub of {}"))
        if self.roller is not None:
            lean = Demand("lean of the roller's pressure", self.lean, False, "a lean of {}", "deg", 180 / np.pi)
            return [*found, lean]
        found.append(Demand("distance of the fixed point", self.fixed, False, "a fixed_within of {}"))
        found.append(Demand("angle that the cable lies on", FULL, False, "", "deg", 180 / np.pi))
        if not self.guide:
            found.append(Demand("room beside the spring", STUB, True, "guide=yes: the spring behind a guide"))
        return found


@frozen
class Trial:
    """Candidates: preload, rate and distance (C,), the offer of each, and what the demands are about (C, D).

    `valid` (C,) says whether there is a profile at all, `score` (C,) is less for smaller springs and profiles.
    """

    F0: Array
    k: Array
    a: Array
    offer: Integers
    values: Array
    valid: Booleans
    score: Array

    def take(self, index: Integers) -> Trial:
        """Some of them."""
        return Trial(*(getattr(self, name)[index] for name in self.__dataclass_fields__))

    def lacks(self, demands: Sequence[Demand]) -> Array:
        """(C, D) by how much each demand is missed, as a share of its limit; 0 where it holds."""
        limits = np.array([d.limit for d in demands])
        above = np.array([d.above for d in demands])
        gap = np.where(above, limits - self.values, self.values - limits)
        size = np.where(limits > 0, limits, 0.05)
        lacking = np.where(self.valid[:, None], np.nan_to_num(gap / size, nan=1e3, posinf=1e3), 1e4)
        return np.asarray(np.where(lacking > SLACK, lacking, 0.0))


def joined(trials: Sequence[Trial]) -> Trial:
    return Trial(*(np.concatenate([getattr(t, name) for t in trials]) for name in Trial.__dataclass_fields__))


class Search:
    """Springs and fixed points for one wanted energy."""

    def __init__(self, wanted: Wanted, wishes: Wishes, offers: Sequence[Offer], seed: int = 0) -> None:
        self.wanted, self.wishes, self.offers = wanted, wishes, offers
        self.demands = wishes.demands
        self.angles = wanted.angles(ANGLES)
        self.work = float(wanted.energy(self.angles).max())
        self.rng = np.random.default_rng(seed)
        self.rate = np.array([wishes.stiffness if o.rate != o.rate else o.rate for o in offers])
        self.most, self.least = np.array([[o.most, o.least] for o in offers]).T
        self.length = np.array([o.length for o in offers])
        # forces at which the largest lever is between a tenth of the largest size and four times as much
        self.forces = wanted.peak / wishes.size * np.array([0.25, 20.0])

    def best(self, count: int = 8) -> Trial:
        """The best candidates that meet every demand, best first: none where there is none."""
        found = self._descend(self._tried(), None)
        self.miss = float(found.take(np.array([0])).lacks(self.demands).sum())
        return found.take(np.flatnonzero(found.lacks(self.demands).sum(axis=1) == 0)[:count])

    def _descend(self, found: Trial, given_up: int | None) -> Trial:
        """The best candidates after rounds of variation, best first.

        Args:
            given_up: the number of a demand that need not hold: of those that meet all others, the nearest to it.
        """
        for i in range(ROUNDS):
            near = found.take(self._order(found, given_up)[:KEPT])
            found = joined([near, self._varied(near, 0.12 * 0.55**i)])
        return found.take(self._order(found, given_up))

    def _order(self, found: Trial, given_up: int | None) -> Integers:
        lacks = found.lacks(self.demands)
        score = found.score
        if given_up is not None:
            score = lacks[:, given_up]
            lacks = np.delete(lacks, given_up, axis=1)
        return np.asarray(np.lexsort((score, lacks.sum(axis=1))), np.intp)

    def _tried(self) -> Trial:
        n = GRID if len(self.offers) < 4 else GRID // 2 + 2
        share, size, far = (x.ravel() for x in np.meshgrid(*[(np.arange(n) + 0.5) / n] * 3, indexing="ij"))
        if not np.isnan(self.rate).any():  # the rate and the preload say what the largest force is
            share, far = (x.ravel() for x in np.meshgrid(*[(np.arange(2 * n) + 0.5) / (2 * n)] * 2, indexing="ij"))
            size = np.zeros_like(share)
        if len(self.offers) > 1:
            offer = np.repeat(np.arange(len(self.offers)), len(share))
            share, size, far = (np.tile(x, len(self.offers)) for x in (share, size, far))
        else:
            offer = np.zeros(len(share), int)
        return self.trial(np.stack([share, size, far], axis=1), offer)

    def _varied(self, near: Trial, step: float) -> Trial:
        x = self._coded(near)
        x = np.repeat(x, TRIES, axis=0)
        x = np.clip(x + step * self.rng.standard_normal(x.shape), 0, 1)
        return self.trial(x, np.repeat(near.offer, TRIES))

    # preload share, largest force and distance as numbers from 0 to 1

    def _lengths(self) -> tuple[float, float]:
        w = self.wishes
        return (
            (0.2 * w.size, w.fixed) if w.roller is None else ((w.hub or w.least_radius) + w.roller, w.size + w.roller)
        )

    def _coded(self, t: Trial) -> Array:
        F1 = np.sqrt(t.F0**2 + 2 * t.k * self.work)
        low, high = self._lengths()
        size = np.log(F1 / self.forces[0]) / np.log(self.forces[1] / self.forces[0])
        return np.stack([t.F0 / F1, size, np.log(t.a / low) / np.log(high / low)], axis=1)

    def trial(self, x: Array, offer: Integers) -> Trial:
        """Candidates by numbers x (C, 3) from 0 to 1 and the number of an offer (C,)."""
        blocks = [slice(i, i + BLOCK) for i in range(0, len(x), BLOCK)]
        return joined([self._block(x[own], offer[own]) for own in blocks])

    def _block(self, x: Array, offer: Integers) -> Trial:
        w = self.wishes
        share = np.clip(x[:, 0], 1e-3, 0.999)
        F1 = self.forces[0] * (self.forces[1] / self.forces[0]) ** x[:, 1]
        k = self.rate[offer]
        given = ~np.isnan(k)
        F1 = np.where(given, np.sqrt(2 * k * self.work / (1 - share**2)), F1)
        F0 = np.full(len(x), w.force) if w.force == w.force else share * F1
        k = np.where(given, k, np.maximum(F1**2 - F0**2, 1e-6 * F1**2) / (2 * self.work))
        low, high = self._lengths()
        a = np.full(len(x), w.at) if w.at == w.at else low * (high / low) ** x[:, 2]
        d = drive(self.wanted, w.turn, F0, k, self.angles)
        F1 = d.force.max(axis=1)
        own = [
            F0 / F1,
            F1 / self.most[offer],
            np.where(self.least[offer] > 0, F0 / np.maximum(self.least[offer], 1e-9), inf),
        ]
        if w.roller is None:
            e = of_cable(d, a)
            inside, least = (np.sign(np.median(d.h, axis=1))[:, None] * d.h).min(axis=1), e.radius.min(axis=1)
            step = abs(float(self.angles[1] - self.angles[0]))
            more = [a, np.abs(e.turn).sum(axis=1) * step]
            if not w.guide:
                bare = np.where(np.isnan(self.length[offer]), F1 / k, self.length[offer])
                length = bare[:, None] + (d.force - self.least[offer, None]) / k[:, None]
                more.append((e.free - length).min(axis=1))
        else:
            e = of_roller(d, a, w.roller, w.offset)
            inside, more = e.reach.min(axis=1), [np.abs(e.lean).max(axis=1)]
            # what is hollow only needs a larger radius than the roller's, which it always has
            least = np.where(e.radius > -w.roller, e.radius, inf).min(axis=1)
        reach = e.reach.max(axis=1)
        inner = [] if w.hub is None else [inside]
        values = np.stack([reach, least, *own, *inner, *more], axis=1)
        valid = np.isfinite(e.free).all(axis=1) & np.isfinite(reach)
        heavy = F1 * w.size / self.wanted.peak  # over the least force that a profile of this size needs
        score = F1**2 / (2 * k * self.work) + reach / w.size + heavy / 4
        if w.roller is None:
            score += 0.5 * a / w.fixed
        return Trial(F0, k, a, offer, values, valid, score)

    def refusal(self) -> tuple[str, list[str]]:
        """Which demands the nearest candidate misses, and each that by giving way would make the others hold."""
        tried = self._tried()
        best = self._descend(tried, None).take(np.array([0]))
        if not best.valid[0]:
            return "the cable would have to overtake its own line", []
        lacks = best.lacks(self.demands)[0]
        missed = min(MISSED, lacks.max())  # what is on its limit is no reason
        fails = [self._said(d, best.values[0, i]) for i, d in enumerate(self.demands) if lacks[i] >= max(missed, SLACK)]
        helps = []
        for i, demand in enumerate(self.demands):
            near = self._descend(tried, i).take(np.array([0]))
            value = demand.factor * float(near.values[0, i])
            if np.delete(near.lacks(self.demands)[0], i).sum() or not near.valid[0] or value <= 0 or not demand.help:
                continue
            helps.append(demand.help.format(f"{value:.4g} {demand.unit}"))
        return ", ".join(fails), helps

    def _said(self, demand: Demand, value: float) -> str:
        side = "at least" if demand.above else "at most"
        number, limit = (f"{demand.factor * x:.4g} {demand.unit}" for x in (value, demand.limit))
        return f"{demand.name} {number} where {side} {limit} is asked for"


def usable(offers: Sequence[Offer], wanted: Wanted, wishes: Wishes) -> list[Offer]:
    """Those that hold the energy and act the way that is needed."""
    work = float(wanted.energy(wanted.angles()).max())
    pushing = wishes.guide or wishes.roller is not None
    offers = [o for o in offers if pushing or o.kind not in PUSHING]
    return [o for o in offers if (o.most**2 - o.least**2) / (2 * o.rate) > work]
