"""What the search found, as mechanisms with springs and in terms of the objective."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...energy.certificate import fourier_form
from ...model.mechanism import Mechanism
from ..design import FrontRow, LoadResidual
from .few_springs import FEASIBLE, SpringSet
from .least_squares_form import LeastSquaresForm
from .peak import Peak
from .polish import Parts


@dataclass(frozen=True)
class Candidate:
    """A set of parts, the mechanism with it, and what it leaves as a share of the judge's unit."""

    mechanism: Mechanism
    parts: Parts
    value: float


class Candidates:
    """Turns what the search found into mechanisms, in terms of the objective.

    Attributes:
        unit: [N m] the unbalanced torque.
        least: the bound as a share of it.
    """

    def __init__(self, reduced: LeastSquaresForm, least: float) -> None:
        self.reduced = reduced
        self.peak = Peak.of(reduced) if reduced.problem.objective == "peak" else None
        self.unit = self.peak.unbalanced if self.peak else reduced.unbalanced
        self.least = self.peak.bound().value if self.peak and least > 0 else least

    def __call__(self, found: SpringSet) -> Candidate:
        parts, value = found.parts, found.value
        if self.peak:
            parts, value = self.peak.polish(parts)
        mechanism = self.reduced.problem.kept
        for number, k, u in zip(parts.block[0], parts.k[0], parts.u[0], strict=True):
            block = self.reduced.blocks[number]
            mechanism = block.add(mechanism, float(k), u[: block.shape])
        return Candidate(mechanism, parts, value)

    def of_loads(self, judged: Candidate) -> tuple[LoadResidual, ...]:
        """What is left under each load, in terms of the objective."""
        if self.peak:
            torques = (self.peak.torque(judged.parts), self.peak.load)
            left, unbalanced = (self.unit * self.peak.of_loads(torque) for torque in torques)
        else:
            x = judged.parts.unknowns(self.reduced)
            left = [case.rms(x) for case in self.reduced.cases]
            unbalanced = [float(np.linalg.norm(case.load)) for case in self.reduced.cases]
        return tuple(
            LoadResidual(load.name, load.weight, float(residual), float(before))
            for load, residual, before in zip(self.reduced.problem.loads, left, unbalanced, strict=True)
        )

    def row(self, found: SpringSet) -> FrontRow:
        """A line of the front; exact only with a certificate."""
        judged = self(found)
        forms = (fourier_form(load.on(judged.mechanism))[0] for load in self.reduced.problem.loads)
        # the bounds of few parts are bounds of the mean square
        bound = None if self.peak or found.bound is None else min(found.bound, found.value)
        return FrontRow(
            springs=found.count,
            residual=judged.value * self.unit,
            bound=None if bound is None else (bound if bound >= FEASIBLE else 0.0) * self.unit,
            pairs=tuple(self.reduced.blocks[number].place for number in judged.parts.block[0]),
            exact=all(form is not None and form.exact for form in forms),
        )
