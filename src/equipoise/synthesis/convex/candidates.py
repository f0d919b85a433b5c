"""What the search found, as mechanisms with springs and in terms of the objective."""

from __future__ import annotations

from dataclasses import dataclass

from ...balance import fourier_form
from ...model.mechanism import Mechanism
from ..design import FrontRow
from .few_springs import FEASIBLE, Found
from .least_squares_form import Gram
from .peak import Peak
from .polish import Parts


@dataclass(frozen=True)
class Judged:
    """A set of parts, the mechanism with it, and what it leaves as a share of the judge's unit."""

    mechanism: Mechanism
    parts: Parts
    value: float


class Judge:
    """Turns what the search found into mechanisms, in terms of the objective.

    Attributes:
        unit: [N m] the unbalanced torque.
        least: the bound as a share of it.
    """

    def __init__(self, gram: Gram, least: float) -> None:
        self.gram = gram
        self.peak = Peak.of(gram) if gram.problem.objective == "peak" else None
        self.unit = self.peak.unbalanced if self.peak else gram.unbalanced
        self.least = self.peak.bound().value if self.peak and least > 0 else least

    def __call__(self, found: Found) -> Judged:
        parts, value = found.parts, found.value
        if self.peak:
            parts, value = self.peak.polish(parts)
        mechanism = self.gram.problem.kept
        for number, k, u in zip(parts.block[0], parts.k[0], parts.u[0], strict=True):
            block = self.gram.blocks[number]
            mechanism = block.add(mechanism, float(k), u[: block.shape])
        return Judged(mechanism, parts, value)

    def row(self, found: Found) -> FrontRow:
        """A line of the front; exact only with a certificate."""
        judged = self(found)
        series, _ = fourier_form(judged.mechanism)
        # the bounds of few parts are bounds of the mean square
        bound = None if self.peak or found.bound is None else min(found.bound, found.value)
        return FrontRow(
            springs=found.count,
            residual=judged.value * self.unit,
            bound=None if bound is None else (bound if bound >= FEASIBLE else 0.0) * self.unit,
            pairs=tuple(self.gram.blocks[number].place for number in judged.parts.block[0]),
            exact=series is not None and series.exact,
        )
