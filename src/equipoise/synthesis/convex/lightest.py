"""The lightest counterweights: the least mass with which springs on the allowed pairs leave no more than is asked.

The mass is linear in the unknowns and what is left is convex in them, so the least mass is a convex program of its own,
and so is every point of the front of mass against residual. Then weights and springs are taken out of the program as
those of a design of few springs, within a trifle more than the least mass; the springs are looked for once more with
these weights on the mechanism.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...model.arrays import Array, Booleans, frozen
from ...model.errors import EquipoiseError, InfeasibleError
from ...model.mechanism import PointMass
from ...model.progress import Progress
from ..counterweights import Counterweights, MassRow
from ..problem import Problem
from .block_sets import FEASIBLE
from .candidates import with_parts
from .counterweight_block import CounterweightBlock
from .few_springs import ROUNDING_SHARE
from .goal import Rms, rms
from .least_squares_form import LeastSquaresForm
from .polish import Parts, polish
from .reweighted import few_parts
from .semidefinite import Bound, Program, least_rms, rms_program

SLACKS = (1e-6, 1e-4, 1e-2)  # mass beside the least, as a share of it, with which real springs are looked for
PRICES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)  # of a part
HOLD = 100.0  # what a mass that is twice as much as is allowed counts, in shares of the unbalanced torque
STEPS = 10  # of the front, from what springs leave without weights to what is asked
ZERO = 1e-8  # share of the unbalanced torque that the program takes for exact
OVER = 1e-3  # of the mass that is allowed, that a found set may have more
CLOSE = 1e-6  # relative: as little as is asked


@frozen
class Lightest:
    """The lightest weights of a problem, with springs.

    Attributes:
        reduced: the problem; parts: weights and springs (a batch of 1), None where springs alone do it.
        share: of the unbalanced torque that may be left.
        counterweights: the weights as masses, with the bound of their mass.
    """

    reduced: LeastSquaresForm
    share: float
    parts: Parts | None
    counterweights: Counterweights

    @property
    def alone(self) -> Parts | None:
        """The weights, where they take no springs."""
        return self.parts if self.parts is not None and _heavy(self.reduced, self.parts).all() else None

    @property
    def with_weights(self) -> Problem:
        """The problem with the weights on the mechanism, and springs left to choose."""
        problem = self.reduced.problem
        masses = (*problem.mechanism.masses, *self.counterweights.weights)
        rest = tuple(block for block in problem.beside if not isinstance(block, CounterweightBlock))
        return replace(problem, mechanism=problem.mechanism.with_masses(masses), beside=rest)

    def springs_on(self, reduced: LeastSquaresForm) -> Parts | None:
        """Its springs, as parts of another form of the same problem, to start a search from."""
        if self.parts is None:
            return None
        kept = np.flatnonzero(~_heavy(self.reduced, self.parts))
        block = [[reduced.blocks.index(self.reduced.blocks[i]) for i in self.parts.block[0, kept]]]
        width = max(own.shape for own in reduced.blocks)
        return Parts.at(reduced, np.array(block), self.parts.k[:, kept], self.parts.u[:, kept, :width])


def weighs(problem: Problem) -> bool:
    """Whether it asks for counterweights."""
    return any(isinstance(block, CounterweightBlock) for block in problem.beside)


def lightest(reduced: LeastSquaresForm, share: float, front: bool, seed: int, progress: Progress) -> Lightest:
    """The lightest weights with which springs leave at most a share of the unbalanced torque, 0 for exact balance.

    Raises:
        InfeasibleError: no weights and springs do it; the message has the least that is left.
    """
    least, unit = least_rms(reduced).value, reduced.unbalanced
    if least > max(share * (1 + CLOSE), FEASIBLE):
        what = f"{100 * share:.4g} % of the unbalanced torque" if share else "exact balance"
        raise InfeasibleError(
            f"{what} is out of reach with these counterweights and springs: every choice leaves at least "
            f"{least * unit:.4g} N m rms, {100 * least:.4g} % of the unbalanced torque"
        )
    progress("finding the least mass", 0.0)
    alone = _with_springs_alone(reduced)
    rows = tuple(_rows(reduced, np.linspace(alone, share, STEPS + 1), progress)) if front else ()
    if alone <= max(share, FEASIBLE):
        return Lightest(reduced, share, None, Counterweights((), 0.0, share * unit, rows))
    bound = _least_mass(reduced, share)
    for slack in SLACKS:
        parts = _few(_Capped(reduced, bound.value * (1 + slack)), share, seed, progress)
        if parts is not None:
            return Lightest(reduced, share, parts, _counterweights(reduced, parts, bound.value, share * unit, rows))
    raise EquipoiseError(
        f"counterweights of {bound.value:.4g} kg may do it, but none were found with springs within "
        f"{100 * SLACKS[-1]:g} % of that mass: allow more residual torque, or larger regions"
    )


class _Capped(Rms):
    """The least torque with weights of at most `most` [kg] in total."""

    def __init__(self, reduced: LeastSquaresForm, most: float) -> None:
        super().__init__(reduced)
        self.most = most

    @cached_property
    def program(self) -> Program:
        program = rms_program(self.reduced)
        program.add("nonnegative", np.array([self.most]), _masses(self.reduced, program))
        return program

    def on(self, chosen: Sequence[int]) -> _Capped:
        part = _Capped(self.reduced.on(chosen), self.most)
        part.numbers = self.numbers[list(chosen)]
        return part


def _masses(reduced: LeastSquaresForm, program: Program) -> list[tuple[int, int, Array]]:
    """The total mass as one row of a program."""
    return [
        (0, start, scale * block.amount[None])
        for block, start, scale in zip(reduced.blocks, program.starts, program.scale, strict=False)
        if isinstance(block, CounterweightBlock)
    ]


def _held(reduced: LeastSquaresForm, mass: float) -> LeastSquaresForm:
    """With one more row: how far the total mass is from `mass` [kg]."""
    forms = []
    for block, form in zip(reduced.blocks, reduced.forms, strict=True):
        row = np.zeros((1, *form.shape[1:]))
        if isinstance(block, CounterweightBlock):
            row[0] = HOLD / mass * block.amount
        forms.append(np.concatenate([form, row]))
    return replace(reduced, forms=tuple(forms), d=np.append(reduced.d, -HOLD))


def _least_mass(reduced: LeastSquaresForm, share: float) -> Bound:
    """The least total mass [kg] with which no more than a share is left; its unknowns leave that, or ZERO."""
    program = Program(reduced, extra=1)
    norm = np.concatenate([[max(share, ZERO)], reduced.d, [reduced.rest]])
    program.add("second order", norm, [(1, start, -own) for _, start, own in program.columns])
    mass = program.width - 1
    program.add("nonnegative", np.zeros(1), [(0, mass, -np.eye(1)), *_masses(reduced, program)])
    return program.solve()


def _with_springs_alone(reduced: LeastSquaresForm) -> float:
    """What they leave at least, as a share; 1 without any."""
    springs = [i for i, block in enumerate(reduced.blocks) if not isinstance(block, CounterweightBlock)]
    return least_rms(reduced.on(springs)).value if springs else 1.0


def _few(goal: _Capped, share: float, seed: int, progress: Progress) -> Parts | None:
    """Weights and few springs that leave no more than the share; None where no price on them led to any."""
    best: Parts | None = None
    for number, price in enumerate(PRICES):
        progress("choosing weights and springs", number / len(PRICES))
        try:
            start = few_parts(goal, price, np.random.default_rng([seed, number]))
        except EquipoiseError:  # at another price it may not stop
            continue
        if start is None:
            continue
        found, _ = polish(_held(goal.reduced, goal.most), start)  # or real springs are paid for by more mass
        if not share:
            found, _ = polish(goal.reduced, found)
        mass = (found.k * _heavy(goal.reduced, found)).sum()
        if rms(goal.reduced, found)[0] > max(share, ROUNDING_SHARE) or mass > goal.most * (1 + OVER):
            continue
        if best is None or _size(goal.reduced, found) < _size(goal.reduced, best):
            best = found
    return best


def _size(reduced: LeastSquaresForm, parts: Parts) -> tuple[int, int]:
    """The number of springs, then of weights."""
    heavy = _heavy(reduced, parts)
    return int((~heavy).sum()), int(heavy.sum())


def _heavy(reduced: LeastSquaresForm, parts: Parts) -> Booleans:
    """(parts,) which are weights."""
    return np.array([isinstance(reduced.blocks[i], CounterweightBlock) for i in parts.block[0]])


def _counterweights(
    reduced: LeastSquaresForm, parts: Parts, bound: float, residual: float, front: tuple[MassRow, ...]
) -> Counterweights:
    kept = len(reduced.problem.kept.masses)
    weights: Iterable[PointMass] = with_parts(reduced, parts).masses[kept:]
    return Counterweights(tuple(weights), bound, residual, front)


def _rows(reduced: LeastSquaresForm, shares: Array, progress: Progress) -> Iterator[MassRow]:
    """Mass against residual. The mass falls as more may be left, so no bound is below that of a larger residual."""
    for i, share in enumerate(shares):
        progress("finding the front of mass", i / len(shares))
        found = _least_mass(reduced, float(share))
        mass = sum(
            float(block.amount @ x)
            for block, x in zip(reduced.blocks, found.x, strict=True)
            if isinstance(block, CounterweightBlock)
        )
        yield MassRow(float(share) * reduced.unbalanced, max(mass, found.value), found.value)
