"""What the search found, as mechanisms with springs and in newton metres."""

from __future__ import annotations

from ...energy.certificate import proof_of
from ...model.mechanism import Mechanism
from ..design import FrontRow, LoadResidual
from .block_sets import FEASIBLE
from .few_springs import SpringSet
from .goal import Goal
from .least_squares_form import LeastSquaresForm
from .polish import Parts


def with_parts(reduced: LeastSquaresForm, parts: Parts) -> Mechanism:
    """What stays of the problem's mechanism, with a set of parts (batch of 1)."""
    mechanism = reduced.problem.kept
    for number, k, u in zip(parts.block[0], parts.k[0], parts.u[0], strict=True):
        block = reduced.blocks[number]
        mechanism = block.add(mechanism, float(k), u[: block.shape])
    return mechanism


def load_residuals(goal: Goal, parts: Parts) -> tuple[LoadResidual, ...]:
    """What a set of parts leaves under each load, in terms of the objective."""
    left, unbalanced = goal.loads(parts)
    return tuple(
        LoadResidual(load.name, load.weight, float(residual), float(before))
        for load, residual, before in zip(goal.reduced.problem.loads, left, unbalanced, strict=True)
    )


def front_row(goal: Goal, count: int, found: SpringSet, bound: float | None) -> FrontRow:
    """The line of at most `count` parts; exact only with a certificate.

    Args:
        bound: none of the sets with so many parts leaves less, as a share of the goal's unit.
    """
    mechanism = with_parts(goal.reduced, found.parts)
    proofs = (proof_of(case)[0] for load in goal.reduced.problem.loads for case in load.each(mechanism))
    least = None if bound is None else min(bound, found.value)
    return FrontRow(
        springs=count,
        residual=found.value * goal.unit,
        bound=None if least is None else (least if least >= FEASIBLE else 0.0) * goal.unit,
        pairs=tuple(goal.reduced.blocks[number].place for number in found.parts.block[0]),
        exact=all(proof is not None and proof.exact for proof in proofs),
    )
