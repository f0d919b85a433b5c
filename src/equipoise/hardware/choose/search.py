"""An anytime search: which parts, where. A usable answer first, then better ones, until the time is up or all is tried.

Every part is scored at thousands of places at once (`score`), the most promising are moved to where they leave least
(`polish`), and so on with other places, one spring after the other while the others stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import monotonic

import numpy as np

from ...model.arrays import Array
from ...model.progress import Progress, silent
from .mount import Mount
from .polish import left, polish
from .score import leading, score
from .slots import Judge, Slot

PLACES, QUICK = 1024, 256  # at a time; for the first answer
FIRST = 3  # parts that are polished before there is an answer
NEAR = 0.15  # of a region: how far places near a good one are
EXACT = 1e-9  # of what there is to balance
POLISHED, PLENTY = 3, 90  # places each part is polished from, at least, and all together, before the search ends


@dataclass(frozen=True)
class Progressed:
    """How far a search got: what was left [N m, scaled] after so many seconds."""

    seconds: float
    left: float


class Search:
    """Chooses one part for each of `sites`, a list of mounts for each spring.

    Attributes:
        best: the slots so far; empty before the first answer.
        left: what they leave [N m, scaled]: the largest, or root mean square.
        history: each better answer. answers: their slots, the best last.
        polished: places from which some part was polished.
        complete: whether every part that fits was polished from several places, and nothing better came of it.
    """

    def __init__(
        self, judge: Judge, sites: Sequence[Sequence[Mount]], start: Sequence[Array | None], *, peak: bool, seed: int
    ) -> None:
        self.judge, self.sites, self.peak = judge, sites, peak
        self.rng = np.random.default_rng(seed)
        self.load = judge.field.load
        self.start = start
        self.best: tuple[Slot, ...] = ()
        self.left = np.inf
        self.history: list[Progressed] = []
        self.answers: list[tuple[Slot, ...]] = []
        self.polished, self.complete, self.fit = 0, False, 1

    def run(self, seconds: float, ideal: Sequence[Array], progress: Progress | None = None) -> None:
        """Search for a time [s].

        Args:
            ideal: for each spring the torque (N * n,) that stands for it until it has a part.
        """
        self.began, self.seconds, self.say = monotonic(), seconds, progress or silent
        self._first(list(ideal))
        if not self.best:
            return
        quiet, number = 0, len(self.sites)
        tried: list[set[tuple[int, int]]] = [set() for _ in self.sites]
        while self._time() < seconds and self.left > self._exact and quiet < 2 * number:
            i = self.polished % number
            before = self.left
            more = self._improve(i, tried[i])
            quiet = 0 if self.left < before * (1 - 1e-3) or more else quiet + 1
        self.complete = self.left <= self._exact or quiet >= 2 * number

    @property
    def _exact(self) -> float:
        return EXACT * float(np.abs(self.load).max(initial=0.0))

    def _time(self) -> float:
        return monotonic() - self.began

    def _first(self, stand_in: list[Array]) -> None:
        """A part for every spring in turn; the others are ideal as long as they have none."""
        chosen: list[Slot | None] = [None] * len(self.sites)
        for i in range(len(self.sites)):
            others = self.load + sum((stand_in[j] for j in range(len(stand_in)) if j != i), np.zeros_like(self.load))
            best, least = None, np.inf
            for slot in self._candidates(i, others, None, FIRST):
                self.polished += 1
                (moved,) = polish(self.judge, (slot,), others, rounds=25)
                if self.judge.may(moved) and (value := left(self.judge, (moved,), others, False)) < least:
                    best, least = moved, value
            if best is None:
                return
            chosen[i], stand_in[i] = best, self.judge.torque(best)
        self._take(tuple(slot for slot in chosen if slot is not None))

    def _improve(self, i: int, tried: set[tuple[int, int]]) -> bool:
        """Polish the most promising parts for spring `i` not yet tried; whether there were any."""
        others = [slot for j, slot in enumerate(self.best) if j != i]
        load = self.load + sum((self.judge.torque(slot) for slot in others), np.zeros_like(self.load))
        fresh, polished = False, 0
        for slot in self._candidates(i, load, self.best[i], None):
            each = max(POLISHED, PLENTY // self.fit)
            times = sum((slot.row, t) in tried for t in range(each))
            if times == each:
                continue
            tried.add((slot.row, times))
            fresh, polished = True, polished + 1
            self.polished += 1
            (moved,) = polish(self.judge, (slot,), load, rounds=25)
            if self.judge.may(moved):
                together = (*self.best[:i], moved, *self.best[i + 1 :])
                if left(self.judge, together, self.load, False) < 2.0 * self.rms:
                    self._take(together)
            if self._time() > self.seconds or polished >= 40:
                break
        return fresh

    def _take(self, slots: tuple[Slot, ...]) -> None:
        """Polish them together, and keep them where they are better than the best."""
        moved = polish(self.judge, slots, self.load, rounds=40)
        if self.peak:
            moved = polish(self.judge, moved, self.load, peak=True, rounds=15)
        if not all(self.judge.may(slot) for slot in moved):
            return
        value = left(self.judge, moved, self.load, self.peak)
        if value < self.left:
            self.best, self.left = moved, value
            self.answers.append(moved)
            self.rms = left(self.judge, moved, self.load, False)
            self.history.append(Progressed(self._time(), value))
        share = self.left / (float(np.abs(self.load).max()) or 1.0)
        self.say(
            f"{self.polished} parts moved into place, {100 * share:.3g} % left", min(1.0, self._time() / self.seconds)
        )

    def _candidates(self, i: int, load: Array, near: Slot | None, count: int | None) -> list[Slot]:
        """Parts for spring `i`, each at the best of new places, those that leave least first."""
        found: list[tuple[float, Slot]] = []
        for mount in self.sites[i]:
            u = self._places(
                QUICK if count else PLACES,
                mount,
                near if near is not None and near.mount == mount else None,
                self.start[i],
            )
            scores = score(self.judge.field, mount, self.judge.table, load, u)
            most = len(self.judge.table) if count is None else count
            self.fit = max(self.fit, int(np.isfinite(scores.left).sum()))
            found += [(float(scores.left[p]), Slot(mount, int(p), scores.x[p])) for p in leading(scores, most)]
        return [slot for _, slot in sorted(found, key=lambda pair: pair[0])[:count]]

    def _places(self, places: int, mount: Mount, near: Slot | None, start: Array | None) -> Array:
        """(places, 6): inside and on the rims of the regions, near the last good place, and on rays through it."""
        u = self.rng.uniform(-1, 1, (places, 6))
        rim = self.rng.random((places, 2)) < 0.3
        for side in range(2):
            own = u[:, 3 * side : 3 * side + 3]
            size = np.linalg.norm(own, axis=1, keepdims=True)
            own /= np.where(rim[:, side : side + 1], size, np.maximum(size, 1.0))
        for origin, part in (
            (None if near is None else near.x[:6], slice(0, places // 3)),
            (start, slice(places // 3, places // 2)),
        ):
            if origin is not None:
                n = len(u[part])
                scale = np.exp(self.rng.normal(0, 0.5, (n, 2))).repeat(3, axis=1)
                u[part] = origin * scale + NEAR * self.rng.normal(size=(n, 6)) * self.rng.random((n, 1)) ** 2
        return u
