"""Few springs: which pairs of bodies, and the best springs on them.

The convex bound of a set of pairs bounds every design on it, so sets are tried in the order of their bounds; on each,
many random starts are polished under the true constraints.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations, combinations_with_replacement, islice
from math import comb

import numpy as np

from .bound import Bound, least_rms
from .gram import Gram
from .polish import STALL, Springs, best_stiffness, polish, project
from .problem import Progress

EXACT = 1e-11  # share of the unbalanced torque that counts as exact here; the certificate has the last word
FEASIBLE = 1e-6  # a convex bound below this share is zero within the solver's tolerance
EXHAUSTIVE = 500  # sets of pairs up to which every one gets its bound
BEAM = 6  # otherwise only the best so many sets are extended by one more pair
SETS = 10  # sets of pairs polished for each number of springs
STARTS = 48  # random starts on each
NEARLY = 1e-3  # relative: designs this close to the best of them count as equal
FIRST = 30  # iterations from every start, before
SECOND = 24  # starts, the best so far, are polished to the end
SPLITS = 6  # ways to distribute the springs over the pairs of a set


@dataclass(frozen=True)
class Found:
    """The best design found with at most `count` springs.

    Attributes:
        springs: one set (batch of 1).
        value: root mean square torque as a share of the unbalanced one.
        bound: no design with `count` springs leaves less; None where not every set of pairs was bounded.
    """

    count: int
    springs: Springs
    value: float
    bound: float | None

    @property
    def exact(self) -> bool:
        """Zero to rounding."""
        return self.value < EXACT


@dataclass
class Search:
    """The search over sets of pairs of one problem. Remembers the bound of every set."""

    gram: Gram
    seed: int = 0
    progress: Progress | None = None
    bounds: dict[tuple[int, ...], Bound] = field(default_factory=dict)

    def bound(self, pairs: tuple[int, ...]) -> float:
        """The convex bound of the pairs with these numbers."""
        if pairs not in self.bounds:
            self.bounds[pairs] = least_rms(self.gram.on(list(pairs)))
        return self.bounds[pairs].value

    def sets(self, size: int) -> tuple[list[tuple[int, ...]], bool]:
        """Sets of `size` pairs, best bound first, and whether every one was looked at."""
        pairs = range(len(self.gram.problem.pairs))
        size = min(size, len(pairs))
        every = comb(len(pairs), size) <= EXHAUSTIVE
        if every:
            candidates = list(combinations(pairs, size))
        else:
            roots = self.sets(size - 1)[0][:BEAM]
            candidates = sorted({tuple(sorted({*root, p})) for root in roots for p in pairs if p not in root})
        for i, candidate in enumerate(candidates):
            self.bound(candidate)
            self._report(f"bounding sets of {size} pairs", (i + 1) / len(candidates))
        return sorted(candidates, key=lambda c: (max(self.bound(c), FEASIBLE), c)), every

    def best(self, count: int) -> Found:
        """The best design with at most `count` springs."""
        sets, every = self.sets(count)
        bound = self.bound(sets[0]) if every else None
        smaller = [s for size in range(1, min(count, len(self.gram.problem.pairs))) for s in self.sets(size)[0][:SETS]]
        promising = sorted([*sets[:SETS], *smaller], key=lambda c: (max(self.bound(c), FEASIBLE), len(c)))[: 2 * SETS]
        best: Found | None = None
        for i, chosen in enumerate(promising):
            if best is not None and self.bound(chosen) > best.value:
                break  # no design on this set, nor on any later one, can be better
            found = self._polished(chosen, count, bound)
            if best is None or self._better(found, best):
                best = found
            self._report(f"polishing {count} springs", (i + 1) / len(promising))
        assert best is not None  # there is always at least one pair
        return best

    def front(self, most: int) -> Iterator[Found]:
        """The best designs with at most 1, 2, ... springs, until exact, or as good as the bound, or `most`."""
        floor = self.bound(tuple(range(len(self.gram.problem.pairs))))
        last: Found | None = None
        for count in range(1, most + 1):
            found = self.best(count)
            last = (
                found
                if last is None or self._better(found, last)
                else Found(count, last.springs, last.value, found.bound)
            )
            yield last
            if last.exact or (floor > FEASIBLE and last.value < 1.001 * floor):
                return

    def _polished(self, chosen: tuple[int, ...], count: int, bound: float | None) -> Found:
        gram = self.gram.on(list(chosen))
        rng = np.random.default_rng([self.seed, count, *chosen])
        spare = count - len(chosen)
        splits = list(islice(combinations_with_replacement(range(len(chosen)), spare), SPLITS))
        local = np.repeat([[*range(len(chosen)), *extra] for extra in splits], STARTS, axis=0)
        u = project(rng.uniform(-1, 1, (*local.shape, 2, 3)), gram.box[local])
        start = best_stiffness(gram, Springs(local, np.ones(local.shape), u))
        springs, value = polish(gram, start, FIRST)
        springs, value = polish(gram, springs[np.argsort(value)[:SECOND]])
        good = np.flatnonzero(value <= max(value.min() * (1 + NEARLY), 10 * STALL))
        winner = good[springs.store(gram)[good].argmin()]  # among equals, the one that stores least
        chosen_springs = springs[winner : winner + 1]
        numbered = Springs(np.array(chosen)[chosen_springs.pair], chosen_springs.k, chosen_springs.u)
        return Found(count, numbered, float(value[winner]), bound)

    def _better(self, one: Found, other: Found) -> bool:
        if one.exact and other.exact:
            return bool(one.springs.store(self.gram)[0] < other.springs.store(self.gram)[0])
        return one.value < other.value

    def _report(self, what: str, done: float) -> None:
        if self.progress:
            self.progress(what, done)
