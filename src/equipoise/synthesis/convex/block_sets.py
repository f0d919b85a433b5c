"""Sets of blocks and their convex bounds: what no parts on so many blocks can undercut."""

from __future__ import annotations

from itertools import combinations
from math import comb

from ...model.errors import EquipoiseError
from ...model.progress import Progress, silent
from .least_squares_form import LeastSquaresForm
from .semidefinite import least_rms

FEASIBLE = 1e-6  # a convex bound below this share is zero within the solver's tolerance
EXHAUSTIVE = 500  # sets of blocks up to which every one gets its bound
BEAM = 6  # otherwise only the best so many sets are extended by one more block


class BlockSets:
    """The sets of the blocks of a problem, each with the bound of the root mean square torque, which is remembered."""

    def __init__(self, reduced: LeastSquaresForm, progress: Progress = silent) -> None:
        self.reduced, self.progress = reduced, progress
        self.bounds: dict[tuple[int, ...], float] = {}
        self.ordered: dict[int, tuple[list[tuple[int, ...]], bool]] = {}

    def bound(self, blocks: tuple[int, ...]) -> float:
        """Of the blocks with these numbers, as a share of the unbalanced torque; 0 where the solver finds none."""
        if blocks not in self.bounds:
            try:
                self.bounds[blocks] = least_rms(self.reduced.on(blocks)).value
            except EquipoiseError:
                self.bounds[blocks] = 0.0
        return self.bounds[blocks]

    def of_size(self, size: int) -> tuple[list[tuple[int, ...]], bool]:
        """Sets of `size` blocks, best bound first, and whether every one was looked at."""
        blocks = range(len(self.reduced.blocks))
        size = min(size, len(blocks))
        if size in self.ordered:
            return self.ordered[size]
        every = comb(len(blocks), size) <= EXHAUSTIVE
        if every:
            candidates = list(combinations(blocks, size))
        else:
            roots = self.of_size(size - 1)[0][:BEAM]
            candidates = sorted({tuple(sorted({*root, b})) for root in roots for b in blocks if b not in root})
        for i, candidate in enumerate(candidates):
            self.bound(candidate)
            self.progress(f"bounding sets of pairs, {size} at a time", (i + 1) / len(candidates))
        self.ordered[size] = sorted(candidates, key=self._order), every
        return self.ordered[size]

    def promising(self, most: int) -> list[tuple[int, ...]]:
        """Sets of at most `most` blocks, best bound first, small ones before others that do as well."""
        every = {chosen for size in range(1, most + 1) for chosen in self.of_size(size)[0]}
        return sorted(every, key=lambda chosen: (max(self.bound(chosen), FEASIBLE), len(chosen), chosen))

    def least(self, count: int, good: tuple[int, ...]) -> float | None:
        """The bound for `count` parts, wherever; None where there are too many sets.

        Args:
            good: the blocks of a set that does well: where its bound is zero, so is this.
        """
        rest = (number for number in range(len(self.reduced.blocks)) if number not in good)
        filled = tuple(sorted([*dict.fromkeys(good), *rest][:count]))
        if self.bound(filled) < FEASIBLE:
            return self.bound(filled)
        if comb(len(self.reduced.blocks), min(count, len(filled))) > EXHAUSTIVE:
            return None
        return self.bound(self.of_size(count)[0][0])

    def _order(self, chosen: tuple[int, ...]) -> tuple[float, tuple[int, ...]]:
        return max(self.bound(chosen), FEASIBLE), chosen
