"""What the search found, as mechanisms with springs and in terms of the objective."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..balance import fourier_form
from ..elements import Element, Spring
from ..mechanism import Mechanism
from .design import FrontRow
from .gram import Gram
from .minimax import Peak
from .polish import Springs
from .problem import Objective, Problem
from .search import FEASIBLE, Found


@dataclass(frozen=True)
class Judged:
    """A spring set, the mechanism with it, and what it leaves as a share of the judge's unit."""

    mechanism: Mechanism
    springs: Springs
    value: float


class Judge:
    """Turns what the search found into mechanisms, in terms of the objective.

    Attributes:
        unit: [N m] the unbalanced torque.
        least: the bound as a share of it.
    """

    def __init__(self, gram: Gram, least: float, objective: Objective, bare: Mechanism) -> None:
        self.gram, self.bare = gram, bare
        self.peak = Peak.of(gram) if objective == "peak" else None
        self.unit = self.peak.unbalanced if self.peak else gram.unbalanced
        self.least = self.peak.bound().value if self.peak and least > 0 else least

    def __call__(self, found: Found) -> Judged:
        springs, value = found.springs, found.value
        if self.peak:
            springs, value = self.peak.polish(springs)
        own = _springs(self.gram.problem, springs, self.bare.springs)
        return Judged(replace(self.bare, springs=(*self.bare.springs, *own)), springs, value)

    def row(self, found: Found) -> FrontRow:
        """A line of the front; exact only with a certificate."""
        judged = self(found)
        series, _ = fourier_form(judged.mechanism)
        # the bounds of few springs are bounds of the mean square
        bound = None if self.peak or found.bound is None else min(found.bound, found.value)
        return FrontRow(
            springs=found.count,
            residual=judged.value * self.unit,
            bound=None if bound is None else (bound if bound >= FEASIBLE else 0.0) * self.unit,
            pairs=tuple(self.gram.problem.pairs[i] for i in judged.springs.pair[0]),
            exact=series is not None and series.exact,
        )


def _springs(problem: Problem, found: Springs, present: tuple[Element, ...]) -> list[Spring]:
    taken = {spring.name for spring in present}
    names = (name for i in range(1, 10_000) if (name := f"spring {i}") not in taken)
    springs = []
    for pair, k, y in zip(found.pair[0], found.k[0], found.y[0], strict=True):
        body_a, body_b = problem.pairs[pair]
        z = problem.lift((body_a, body_b)) @ y
        springs.append(Spring(next(names), body_a, _point(z[:3]), body_b, _point(z[4:]), float(k)))
    return springs


def _point(p: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in p)
    return x, y, z
