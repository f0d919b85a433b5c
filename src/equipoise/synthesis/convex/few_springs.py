"""Few parts, such as springs, out of the program's own optimum, and the best set for every number of them.

A price on parts thins the optimum out (`reweighted`); it is split into parts, and these are polished under the true
constraints. Sets with fewer parts come from higher prices, and from taking parts away one by one. Random starts are the
last resort, where none of these comes near the bound.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from ...model.errors import EquipoiseError
from ...model.progress import Progress, silent
from .block_sets import FEASIBLE, BlockSets
from .goal import Goal, Rms, rms
from .polish import Parts
from .random_starts import random_parts
from .reweighted import few_parts

ROUNDING_SHARE = 1e-11  # share of the unbalanced torque that is only rounding here; the certificate has the last word
NEAR = 0.01  # of the unbalanced torque: close enough to the bound to stop adding springs
CLOSE = 1e-3  # relative: as good as the bound
NEARLY = 1e-5  # relative: sets this close to the best of them count as equal
PRICES = (1e-2, 1e-3, 3e-4, 3e-2, 3e-3)  # of a part
LOW = 1e-3  # the price on few blocks
ROUNDS = 3  # of all prices with other first weights, while the bound is not reached
BEAM = 3  # sets of each size that parts are taken away from
LARGEST = 12  # parts of a set that is looked at
SETS = 24  # sets of blocks for random starts
FEW = 5  # parts: of sets with more only the best gets smaller, without starts around it
AROUND = 3  # starts around each set that a part was taken away from
SCATTER = 0.3  # by which their shapes and the logarithms of their amounts scatter


@dataclass(frozen=True)
class SpringSet:
    """A set of parts (batch of 1) and what it leaves.

    Attributes:
        value: what the goal is about, as a share of its unit.
        exact: zero to rounding at every pose.
        cost: what equal designs should have little of, see `Parts.cost`.
        by_chance: it comes from a random start.
    """

    parts: Parts
    value: float
    exact: bool
    cost: float
    by_chance: bool = False

    @property
    def count(self) -> int:
        return self.parts.k.shape[1]


@dataclass
class SpringSearch:
    """The search for one goal.

    Attributes:
        most: parts that are wanted, at most.
        target: what is good enough, as a share of the goal's unit; by default what is exact, or near the bound.
        found: the best sets of each number of parts, once it was `explored`.
        seen: the blocks on which the program by itself was solved; tried: the prices at which it was on all.
    """

    goal: Goal
    most: int
    seed: int = 0
    progress: Progress = silent
    found: dict[int, list[SpringSet]] = field(default_factory=dict)
    seen: set[tuple[int, ...]] = field(default_factory=set)
    tried: set[tuple[int, int]] = field(default_factory=set)
    explored: bool = False
    target: float | None = None

    @cached_property
    def sets(self) -> BlockSets:
        return BlockSets(self.goal.reduced, self.progress)

    @cached_property
    def floor(self) -> float:
        """The bound, 0 where the solver found none: nothing leaves less than nothing."""
        try:
            return self.goal.bound.value
        except EquipoiseError:
            return 0.0

    def start(self, parts: Parts | None, target: float) -> None:
        """Take a set that is known, and what is good enough, as a share of the goal's unit."""
        self.target = target
        if parts is not None:
            self.offer(self.goal, parts)

    def best(self, most: int) -> SpringSet | None:
        """The best set with at most so many parts, of equal ones the one with the fewest; None where there is none."""
        if not self.explored:
            self.explored = True
            self._explore()
        return self._best_of(most)

    def _best_of(self, most: int) -> SpringSet | None:
        """The best of those found so far."""
        sets = [one for count in sorted(self.found) if count <= most for one in self.found[count]]
        exact = [one for one in sets if one.exact]
        least = min((one.value for one in sets), default=0.0)
        good = exact or [one for one in sets if one.value <= least * (1 + NEARLY)]
        return min(good, key=lambda one: (one.count, one.cost), default=None)

    def front(self) -> Iterator[SpringSet]:
        """The best sets with at most 1, 2, ... parts, until exact, or as good as the bound, or `most`."""
        for count in range(1, self.most + 1):
            found = self.best(count)
            if found is not None:
                yield found
                if found.exact or (self.floor >= FEASIBLE and found.value <= self.floor * (1 + CLOSE)):
                    break

    def few(self) -> SpringSet | None:
        """The fewest parts found that are enough; where the bound is not zero, without looking further than to them."""
        if self.floor >= FEASIBLE and not self.explored:
            for number in range(len(PRICES)):
                self._at_price(0, number)
                if self._fewest(self.most):
                    break
            self._shrink()
        if self.floor < FEASIBLE or not self._fewest(self.most):
            self.best(self.most)
        return self._best_of(self._fewest(self.most))

    def enough(self, found: SpringSet) -> bool:
        """Whether more parts are not worth it: it is exact, or near a bound that says that none are."""
        if self.target is not None:
            return found.exact or found.value <= self.target
        return found.exact or (self.floor >= FEASIBLE and found.value <= self.floor + NEAR)

    def _explore(self) -> None:
        for turn in range(ROUNDS):
            for number in range(len(PRICES)):
                self._at_price(turn, number)
            if self._fewest(LARGEST):
                break
        self._shrink()
        if self.floor < FEASIBLE:  # exact with fewer, perhaps; above it the bound has been reached
            most = min(self.most, (self._fewest(LARGEST) or LARGEST) - 1)
            while most and self._on_fewer(most):
                most -= 1
        hope = self.floor < FEASIBLE or (self.floor < 1 - FEASIBLE and not self._fewest(LARGEST))
        if hope and not self._fewest(self.most):
            self._by_chance(self.most)

    def _fewest(self, most: int) -> int:
        """The fewest parts that are enough; 0 where no set of at most so many is."""
        every = (count for count, sets in self.found.items() if count <= most and any(map(self.enough, sets)))
        return min(every, default=0)

    def _at_price(self, turn: int, number: int) -> None:
        if (turn, number) not in self.tried:
            self.tried.add((turn, number))
            self._by_program(self.goal, PRICES[number], [turn, number])
            self.progress("choosing springs", (number + 1) / len(PRICES))

    def _by_program(self, goal: Goal, price: float, seed: Sequence[int]) -> None:
        try:
            parts = few_parts(goal, price, np.random.default_rng([self.seed, *seed]))
        except EquipoiseError:  # at another price it may not stop
            return
        if parts is not None and parts.k.shape[1] <= LARGEST:
            self.offer(goal, parts)

    def _on_fewer(self, count: int) -> bool:
        """The program on sets of few blocks that may be enough; whether one was, with so many parts."""
        for size in range(1, count + 1):
            for chosen in self.sets.of_size(size)[0]:
                if self.sets.bound(chosen) > max(self.floor, FEASIBLE):
                    break
                if chosen not in self.seen:
                    self.seen.add(chosen)
                    self._by_program(self.goal.on(chosen), LOW, chosen)
                    if self._fewest(count):
                        return True
        return False

    def _by_chance(self, count: int) -> None:
        """Random starts, until so many parts are enough."""
        sets = self.sets.promising(count)[:SETS]
        for i, chosen in enumerate(sets):
            if isinstance(self.goal, Rms) and self.sets.bound(chosen) > self._least(count):
                break  # no set of parts on these blocks, nor on any later ones, can be better
            self.offer(self.goal, random_parts(self.goal.reduced, chosen, count, self.seed), by_chance=True)
            self.progress("choosing springs from random starts", (i + 1) / len(sets))
            if self._fewest(count):
                break

    def _least(self, most: int) -> float:
        return min((one.value for count, sets in self.found.items() if count <= most for one in sets), default=np.inf)

    def offer(self, goal: Goal, start: Parts, by_chance: bool = False) -> None:
        """Take what starts, all of one size, are polished to."""
        parts, values = goal.improve(start)
        exact = rms(goal.reduced, parts) < ROUNDING_SHARE
        costs = parts.cost(goal.reduced)
        sets = self.found.setdefault(parts.k.shape[1], [])
        for i in range(len(parts)):
            own = replace(parts[i : i + 1], block=goal.numbers[parts.block[i : i + 1]])
            sets.append(SpringSet(own, float(values[i]), bool(exact[i]), float(costs[i]), by_chance))
        sets.sort(key=lambda one: (not one.exact, one.cost if one.exact else one.value))
        del sets[BEAM:]

    def _shrink(self) -> None:
        """Take parts away one by one, down to one, and blocks, on which the program is solved again."""
        rng = np.random.default_rng(self.seed)
        for count in range(max(self.found, default=1), 1, -1):
            sets = self.found.get(count, [])[: BEAM if count <= FEW else 1]
            for places in (tuple(np.unique(one.parts.block).tolist()) for one in sets):
                for chosen in combinations(places, len(places) - 1):
                    if chosen and chosen not in self.seen:
                        self.seen.add(chosen)
                        self._by_program(self.goal.on(chosen), LOW, chosen)
            if sets:
                less = Parts.joined([one.parts.without(i) for one in sets for i in range(count)])
                around = [less.scattered(self.goal.reduced, SCATTER, rng) for _ in range(AROUND if count <= FEW else 0)]
                self.offer(self.goal, Parts.joined([less, *around]))
            self.progress("taking springs away", 1 / count)
