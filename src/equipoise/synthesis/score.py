"""The number that a mechanism's goal is about, of the mechanism as it stands, and the words for it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..io import Source, loaded
from ..kinematics import Tree
from ..model.coordinate import Coordinate, load_unit
from ..model.goal import Count, Goal
from ..model.mechanism import Mechanism
from .convex.least_squares_form import build
from .convex.peak import largest
from .problem import Problem

TINY = 1e-9  # of what was before: nothing


@dataclass(frozen=True)
class Terms:
    """How a goal's numbers are called and shown."""

    name: str
    unit: str

    @staticmethod
    def of(count: Count, coordinates: Iterable[Coordinate]) -> Terms:
        """Of what a goal counts of these coordinates, or of its own among them."""
        weighted = ", weighted" if any(factor != 1 for factor in count.joints.values()) else ""
        if count.heat:
            name = "most heat in any motor" if count.torque == "peak" else "heat in all motors together"
            return Terms(name + weighted, "W")
        if count.share_of:
            name = "largest share of any motor" if count.torque == "peak" else "root mean square share of all motors"
            return Terms(name + weighted, "share")
        unit, beyond = load_unit(coordinates), " beyond what friction holds" if count.friction else ""
        what = "force" if unit == "N" else "torque"
        return Terms(f"{'largest' if count.torque == 'peak' else 'root mean square'} {what}{beyond}{weighted}", unit)

    def show(self, value: float) -> str:
        """A value with its unit; of heat its root is given."""
        if self.unit == "W":
            return f"{value**2:.4g} W"
        return f"{100 * value:.3g} %" if self.unit == "share" else f"{value:.5g} {self.unit}"

    def sentence(self, value: float, before: float, bound: float | None) -> str:
        """The goal's number, what it is without the springs, and what no springs can undercut."""
        value = 0.0 if value < TINY * before else value
        text = f"{self.name}: {self.show(value)} (was {self.show(before)})"
        if bound is None:
            return text
        return f"{text}; no springs on these pairs and regions do better than {self.show(min(value, bound))}"


@dataclass(frozen=True)
class Score:
    """A mechanism's goal and how far it is reached.

    Attributes:
        value, before: what is left with the springs and without, in the unit of `terms`; of heat its root.
        bound: what no springs on the pairs of the design leave less than, where a design for this goal says it.
    """

    goal: Goal
    terms: Terms
    value: float
    before: float
    bound: float | None

    def __str__(self) -> str:
        return self.terms.sentence(self.value, self.before, self.bound)

    def to_dict(self) -> dict[str, Any]:
        """As plain data; heat in watts."""
        power = 2 if self.terms.unit == "W" else 1
        return {
            "for": self.goal.to_dict(),
            "name": self.terms.name,
            "unit": self.terms.unit,
            "value": self.value**power,
            "before": self.before**power,
            "bound": None if self.bound is None else self.bound**power,
        }


def score(mechanism: Source) -> Score | None:
    """How far a mechanism, or that of a file, reaches its goal; None where it has none.

    Raises:
        InputError: its loops cannot be closed, or a motor that counts is not known.
    """
    mechanism = loaded(mechanism)
    if not mechanism.goal:
        return None
    made = mechanism.provenance
    same = isinstance(made.get("goal"), Mapping) and made["goal"] == mechanism.goal.to_dict()
    bound = made.get("bound") if same else None
    terms = Terms.of(mechanism.goal.count, Tree.of(mechanism).coordinates)
    left, bare = _left(mechanism), _left(mechanism.with_springs(()))
    return Score(mechanism.goal, terms, left, bare, bound if isinstance(bound, float) else None)


def _left(mechanism: Mechanism) -> float:
    problem = Problem.of(mechanism, pairs=(), keep=True)
    return largest(problem) if problem.objective == "peak" else build(problem).unbalanced
