"""What a search minimises: the root mean square torque, or the peak (`peak`)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ...model.arrays import Array, Integers
from .least_squares_form import LeastSquaresForm
from .polish import Parts, best_amounts, capped, limited, polish, rms_of
from .semidefinite import Bound, Program, least_rms, rms_program

MANY = 8  # sets that are polished to the end; of more the better ones
SHORT = 30  # iterations that tell which those are


class Goal(ABC):
    """Values are shares of `unit`.

    Attributes:
        reduced: the problem.
        unit: [N m] the torque without parts.
        numbers: (blocks,) of its blocks among those of the problem that it was made `on`.
    """

    reduced: LeastSquaresForm
    unit: float
    numbers: Integers

    @cached_property
    @abstractmethod
    def program(self) -> Program:
        """The convex program, compiled: its optimum bounds the values of all sets of parts."""

    @cached_property
    @abstractmethod
    def bound(self) -> Bound:
        """The program's optimum.

        Raises:
            EquipoiseError: the solver stopped far from it.
        """

    @abstractmethod
    def on(self, chosen: Sequence[int]) -> Goal:
        """The same on some of the blocks."""

    @abstractmethod
    def improve(self, parts: Parts) -> tuple[Parts, Array]:
        """Local optima near the more promising of these sets of parts, and their values (batch,)."""

    @abstractmethod
    def loads(self, parts: Parts) -> tuple[Array, Array]:
        """[N m] (loads,), (loads,) what a set of parts (batch of 1) leaves under each load, and what none leave."""


class Rms(Goal):
    """The root mean square torque of all joints together."""

    def __init__(self, reduced: LeastSquaresForm) -> None:
        self.reduced, self.unit = reduced, reduced.unbalanced
        self.numbers = np.arange(len(reduced.blocks))

    @cached_property
    def program(self) -> Program:
        return rms_program(self.reduced)

    @cached_property
    def bound(self) -> Bound:
        return least_rms(self.reduced)

    def on(self, chosen: Sequence[int]) -> Rms:
        part = Rms(self.reduced.on(chosen))
        part.numbers = self.numbers[list(chosen)]
        return part

    def improve(self, parts: Parts) -> tuple[Parts, Array]:
        fitted = best_amounts(self.reduced, parts)
        better = rms(self.reduced, fitted) < rms(self.reduced, parts)
        start = replace(parts, k=np.where(better[:, None], fitted.k, parts.k))
        if len(start) > MANY:
            start, value = polish(self.reduced, start, SHORT)
            start = start[np.argsort(value, kind="stable")[: max(MANY, len(start) // 4)]]
        found, value = polish(self.reduced, start)
        return self._within(found, value) if self.reduced.limits else (found, value)

    def _within(self, found: Parts, value: Array) -> tuple[Parts, Array]:
        """The sets within the limits: those that are, as they are."""
        fit = capped(self.reduced, found)
        over = np.flatnonzero((fit.k < found.k * (1 - 1e-9)).any(axis=1))
        if len(over):
            found = replace(found, k=found.k.copy(), u=found.u.copy())
            best, less = limited(self.reduced, found[over])
            found.k[over], found.u[over], value[over] = best.k, best.u, less
        return found, value

    def loads(self, parts: Parts) -> tuple[Array, Array]:
        x, cases = parts.unknowns(self.reduced), self.reduced.cases
        return np.array([case.rms(x) for case in cases]), np.array([float(np.linalg.norm(c.load)) for c in cases])


rms = rms_of
