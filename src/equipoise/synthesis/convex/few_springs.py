"""Few parts: which blocks, such as pairs of bodies, and the best parts of them, such as springs.

The convex bound of a set of blocks bounds every design on it, so sets are tried in the order of their bounds; on each,
many random starts are polished under the true constraints.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import combinations, combinations_with_replacement, islice
from math import comb

import numpy as np

from ...model.progress import Progress
from .least_squares_form import LeastSquaresForm
from .polish import STALL, Parts, best_amounts, polish, shape
from .semidefinite import Bound, least_rms

ROUNDING_SHARE = 1e-11  # share of the unbalanced torque that is only rounding here; the certificate has the last word
FEASIBLE = 1e-6  # a convex bound below this share is zero within the solver's tolerance
EXHAUSTIVE = 500  # sets of blocks up to which every one gets its bound
BEAM = 6  # otherwise only the best so many sets are extended by one more block
SETS = 10  # sets of blocks polished for each number of parts
STARTS = 48  # random starts on each; the best quarter is polished to the end
SHORT = 30  # iterations for all starts
MORE = 128  # starts where an exact design may exist and was not found, on
MANY = 200  # sets over the square of the number of parts, which is how their cost grows
NEARLY = 1e-3  # relative: designs this close to the best of them count as equal
NOT_NEEDED = 1e-6  # relative: a part that improves less is not needed
CLOSE = 1.001  # times the bound: as good as it
SPLITS = 6  # ways to distribute the parts over the blocks of a set


@dataclass(frozen=True)
class SpringSet:
    """The best design found with at most `count` parts.

    Attributes:
        parts: one set (batch of 1).
        value: root mean square torque as a share of the unbalanced one.
        bound: no design with `count` parts leaves less; None where not every set of blocks was bounded.
    """

    count: int
    parts: Parts
    value: float
    bound: float | None

    @property
    def exact(self) -> bool:
        """Zero to rounding."""
        return self.value < ROUNDING_SHARE


@dataclass
class SpringSearch:
    """The search over sets of blocks of one problem. Remembers the bound of every set, and the sets by size."""

    reduced: LeastSquaresForm
    seed: int = 0
    progress: Progress | None = None
    bounds: dict[tuple[int, ...], Bound] = field(default_factory=dict)
    ordered: dict[int, tuple[list[tuple[int, ...]], bool]] = field(default_factory=dict)

    def bound(self, blocks: tuple[int, ...]) -> float:
        """The convex bound of the blocks with these numbers."""
        if blocks not in self.bounds:
            self.bounds[blocks] = least_rms(self.reduced.on(blocks))
        return self.bounds[blocks].value

    @property
    def floor(self) -> float:
        """The convex bound of all blocks together."""
        return self.bound(tuple(range(len(self.reduced.blocks))))

    def sets(self, size: int) -> tuple[list[tuple[int, ...]], bool]:
        """Sets of `size` blocks, best bound first, and whether every one was looked at."""
        blocks = range(len(self.reduced.blocks))
        size = min(size, len(blocks))
        if size in self.ordered:
            return self.ordered[size]
        every = comb(len(blocks), size) <= EXHAUSTIVE
        if every:
            candidates = list(combinations(blocks, size))
        else:
            roots = self.sets(size - 1)[0][:BEAM]
            candidates = sorted({tuple(sorted({*root, b})) for root in roots for b in blocks if b not in root})
        for i, candidate in enumerate(candidates):
            self.bound(candidate)
            self._report(f"bounding sets of pairs, {size} at a time", (i + 1) / len(candidates))
        self.ordered[size] = sorted(candidates, key=lambda c: (max(self.bound(c), FEASIBLE), c)), every
        return self.ordered[size]

    def best(self, count: int) -> SpringSet:
        """The best design found with at most `count` parts."""
        sets, every = self.sets(count)
        bound = self.bound(sets[0]) if every else None
        smaller = [s for size in range(1, min(count, len(self.reduced.blocks))) for s in self.sets(size)[0][:SETS]]
        promising = sorted([*sets[:SETS], *smaller], key=lambda c: (max(self.bound(c), FEASIBLE), len(c)))[: 2 * SETS]
        best = self._try(promising, count, bound, STARTS)
        if not best.exact:
            # exact designs may exist on any set whose bound is zero, and small regions hide them from most starts
            tried = [s for size in range(1, count + 1) for s in self.sets(size)[0]]
            for chosen in [s for s in dict.fromkeys(tried) if self.bound(s) < FEASIBLE][: MANY // count**2 + 1]:
                found = self._polished(chosen, count, bound, MORE)
                best = found if self._better(found, best) else best
                self._report(f"looking for {count} exact spring{'s' * (count > 1)}", 0.0)
                if best.exact:
                    break
        return best

    def front(self, most: int) -> Iterator[SpringSet]:
        """The best designs found with at most 1, 2, ... parts, until exact, or as good as the bound, or `most`."""
        floor = self.floor
        last = self.best(1)
        yield last
        while last.count < most and not last.exact and (floor <= FEASIBLE or last.value > CLOSE * floor):
            found = self.best(last.count + 1)
            kept = found if self._better(found, last) else last
            last = replace(kept, count=found.count, bound=found.bound)
            yield last

    def pruned(self, found: SpringSet) -> SpringSet:
        """The same without the parts that are not needed: none can go without a loss."""
        count = found.parts.k.shape[1]
        for i in range(count if count > 1 else 0):
            parts, value = polish(self.reduced, found.parts.without(i))
            less = replace(found, parts=parts, value=float(value[0]))
            if less.exact if found.exact else less.value <= found.value * (1 + NOT_NEEDED):
                return self.pruned(less)
        return found

    def _try(self, sets: list[tuple[int, ...]], count: int, bound: float | None, starts: int) -> SpringSet:
        best = self._polished(sets[0], count, bound, starts)
        for i, chosen in enumerate(sets[1:], 2):
            if self.bound(chosen) > best.value:
                break  # no design on this set, nor on any later one, can be better
            found = self._polished(chosen, count, bound, starts)
            best = found if self._better(found, best) else best
            self._report(f"polishing {count} spring{'s' * (count > 1)}", i / len(sets))
        return best

    def _polished(self, chosen: tuple[int, ...], count: int, bound: float | None, starts: int) -> SpringSet:
        reduced = self.reduced.on(chosen)
        rng = np.random.default_rng([self.seed, count, *chosen])
        spare = count - len(chosen)
        splits = list(islice(combinations_with_replacement(range(len(chosen)), spare), SPLITS))
        local = np.repeat([[*range(len(chosen)), *extra] for extra in splits], starts, axis=0)
        start = Parts.at(reduced, local, np.ones(local.shape), rng.uniform(-1, 1, (*local.shape, shape(reduced))))
        parts, value = polish(reduced, best_amounts(reduced, start), SHORT)
        parts, value = polish(reduced, parts[np.argsort(value)[: len(parts) // 4 + 8]])
        good = np.flatnonzero(value <= max(value.min() * (1 + NEARLY), 10 * STALL))
        winner = good[parts.cost(reduced)[good].argmin()]  # among equals, the one that stores least
        best = parts[winner : winner + 1]
        return SpringSet(count, replace(best, block=np.array(chosen)[best.block]), float(value[winner]), bound)

    def _better(self, one: SpringSet, other: SpringSet) -> bool:
        if one.exact and other.exact:
            return bool(one.parts.cost(self.reduced)[0] < other.parts.cost(self.reduced)[0])
        return one.value < other.value

    def _report(self, what: str, done: float) -> None:
        if self.progress:
            self.progress(what, done)
