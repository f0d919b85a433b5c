"""A design: the mechanism with its springs, the method that made it, and how far from the best possible it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING, Any

from .._version import __version__
from ..balance import Balance, check
from ..model.elements import Spring
from ..model.goal import BY_DEFAULT, Goal
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from ..model.units import Amount, quantity
from .counterweights import Counterweights
from .fewest import Fewest, fewest

if TYPE_CHECKING:
    from .convex.ordinary import Ordinary

REACHED = 1.001  # times the bound: as good as it


@dataclass(frozen=True)
class FrontRow:
    """The best design with at most `springs` springs: what it leaves [N m], and what no such design can undercut."""

    springs: int
    residual: float
    bound: float | None
    pairs: tuple[tuple[str, ...], ...]
    exact: bool


@dataclass(frozen=True)
class LoadResidual:
    """Of a load case: what it counts, the torque that is left and the torque without springs [N m]."""

    name: str
    weight: float
    residual: float
    unbalanced: float


@dataclass(frozen=True)
class Infeasible:
    """Proof that no springs on `pairs` balance exactly.

    Attributes:
        least: [N m] root mean square torque that every choice of springs leaves.
        far: the same with regions ten times as large, 0 where that is exact or not known: it tells whether the pairs
            or the regions are to blame.
        remedies: of the nearest other pairs, those any one of which would make exact balance possible.
        tried: how many other pairs that was.
        unit: N where all coordinates that count slide.
    """

    pairs: tuple[tuple[str, ...], ...]
    least: float
    far: float
    remedies: tuple[tuple[str, ...], ...]
    tried: int
    unit: str = "N m"

    def __str__(self) -> str:
        pairs = ", ".join(":".join(pair) for pair in self.pairs)
        text = f"exact balance is infeasible with springs on {pairs}: "
        text += f"every choice leaves at least {self.least:.4g} {self.unit} rms"
        if self.far > 0:
            text += f" ({self.far:.4g} {self.unit} rms even with attachments ten times as far out)"
        if self.remedies:
            text += "; adding any one of these pairs makes it feasible: "
            text += ", ".join(":".join(pair) for pair in self.remedies)
        elif self.tried:
            text += f"; none of the {self.tried} nearest other pairs makes it feasible by itself"
        return text


@dataclass(frozen=True)
class Design(Shown):
    """The answer of a method.

    Attributes:
        mechanism: with the springs.
        method: its name in `METHODS`.
        objective: what was minimised; the next three are in its terms.
        residual: [N m] torque that is left.
        unbalanced: [N m] torque without the springs.
        bound: [N m] no springs on the allowed pairs and regions can leave less; None for methods without one.
        joints: the coordinates that count, None for all.
        averaged: whether these are exact averages, over all poses inside the joint ranges, or over random poses.
        samples: the number of random poses, None when the averages are exact.
        free_parameters: the options the method was called with.
        exact_feasible: whether springs on the pairs can balance exactly, None when it is not known.
        infeasible: the proof that they cannot.
        loads: what is left under each load; the numbers above are for all together. `balance` is about the mechanism
            as it is.
        front: the best design for each number of springs, when it was asked for.
        by_chance: whether its springs come from random starts, the last resort where the program gives none as good.
        goal: what it was made for, where that is more than the objective; `residual` and its like are in its terms.
        ordinary: what was lost when the springs got a free length, or room.
        counterweights: what was designed beside the springs.
        brought: element with fixed ends -> [N m] rms that is left at least without it.
        judged: the verdict on `mechanism`, where making the design took one; of any other it says nothing.
    """

    mechanism: Mechanism
    method: str
    objective: str
    residual: float
    unbalanced: float
    bound: float | None = None
    joints: tuple[str, ...] | None = None
    averaged: bool = False
    samples: int | None = None
    free_parameters: Mapping[str, Any] = field(default_factory=dict)
    exact_feasible: bool | None = None
    infeasible: Infeasible | None = None
    loads: tuple[LoadResidual, ...] = ()
    front: tuple[FrontRow, ...] = ()
    by_chance: bool = False
    goal: Goal = BY_DEFAULT
    ordinary: Ordinary | None = None
    counterweights: Counterweights | None = None
    brought: Mapping[str, float] = field(default_factory=dict)
    judged: Balance | None = field(default=None, repr=False, compare=False)

    @staticmethod
    def of(mechanism: Mechanism, method: str, free_parameters: Mapping[str, Any]) -> Design:
        """The design of a method that has formulas instead of an objective: judged by the root mean square torque.

        Args:
            free_parameters: what was chosen, given or by default, in SI units.
        """
        balance = check(mechanism)
        residual, unbalanced = (sqrt(float(sum(load.rms**2))) for load in (balance.residual, balance.unbalanced))
        return Design(
            mechanism=mechanism,
            method=method,
            objective="rms",
            residual=residual,
            unbalanced=unbalanced,
            bound=0.0 if balance.exact else None,  # nothing leaves less than nothing
            samples=balance.certificate.samples,
            free_parameters=free_parameters,
            exact_feasible=True if balance.exact else None,
            judged=balance,
        ).with_provenance()

    @cached_property
    def balance(self) -> Balance:
        """The verdict on the finished mechanism, computed from it alone."""
        return self._known or check(self.mechanism)

    @cached_property
    def fewest(self) -> Fewest | None:
        """How many springs exact balance needs at least; None where no bound is known, or where springs stayed."""
        return (
            None if self.free_parameters.get("keep") or self.goal.poses.chosen else fewest(self.mechanism, self.joints)
        )

    def status(self, row: FrontRow) -> str:
        """Of a row of the front: "optimal" (its bound is reached), "cannot be exact" (proved), or "open"."""
        if row.exact or (row.bound is not None and row.residual <= REACHED * row.bound):
            return "optimal"
        return "cannot be exact" if self.fewest is not None and row.springs < self.fewest.springs else "open"

    @property
    def _known(self) -> Balance | None:
        return self.judged if self.judged is not None and self.judged.mechanism is self.mechanism else None

    @property
    def certified_gap(self) -> float | None:
        """(residual - bound) / unbalanced: how much better any other design could be."""
        if self.bound is None:
            return None
        return max(0.0, self.residual - self.bound) / self.unbalanced if self.unbalanced else 0.0

    def with_ordinary_springs(self, free_length: Amount | Mapping[str, Amount] | None = None, **options: Any) -> Design:
        """The same with free lengths, or room for its springs; see `OrdinaryOptions`. Its bound is no more."""
        from .convex.ordinary import OrdinaryOptions, ordinary

        found, asked = ordinary(self.mechanism, free_length, **options), OrdinaryOptions(free_length, **options)
        residual = sqrt(float(sum(found.balance.residual.rms**2)))
        unbalanced = sqrt(float(sum(found.balance.unbalanced.rms**2)))
        samples = found.balance.certificate.samples
        given = {**self.free_parameters, "free_length": dict(found.free_length)}
        given |= {name: getattr(asked, name) for name in options if name != "regions"}  # it has them
        if found.mechanism.springs == self.mechanism.springs:  # they were as they should be
            return replace(self, free_parameters=given, ordinary=found).with_provenance()
        return replace(
            self, mechanism=found.mechanism, objective="rms", residual=residual, unbalanced=unbalanced, bound=None,
            joints=None, averaged=False, samples=samples, loads=(), goal=BY_DEFAULT, free_parameters=given,
            ordinary=found, judged=found.balance,
        ).with_provenance()  # fmt: skip

    def with_diameter(self, diameter: Amount) -> Design:
        """The same design with springs of an outer diameter [m]."""
        size = quantity(diameter, "length", "diameter")
        springs = (
            replace(spring, diameter=size) if isinstance(spring, Spring) else spring
            for spring in self.mechanism.springs
        )
        return replace(self, mechanism=self.mechanism.with_springs(springs))

    def with_provenance(self) -> Design:
        """The same design whose mechanism says how it was made."""
        provenance = {
            "program": f"equipoise {__version__}",
            "method": self.method,
            "options": dict(self.free_parameters),
            "objective": self.objective,
            "residual": self.residual,
            "unbalanced": self.unbalanced,
            "bound": self.bound,
            "certified_gap": self.certified_gap,
        }
        if self.goal:
            provenance["goal"] = self.goal.to_dict()
        mechanism, known = replace(self.mechanism, provenance=provenance), self._known
        return replace(self, mechanism=mechanism, judged=known and replace(known, mechanism=mechanism))

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise design --json``."""
        return {
            "method": self.method,
            "certified_gap": self.certified_gap,
            "bound": self.bound,
            "objective": self.objective,
            "residual": self.residual,
            "unbalanced": self.unbalanced,
            "joints": None if self.joints is None else list(self.joints),
            "averaged": self.averaged,
            "samples": self.samples,
            "exact_feasible": self.exact_feasible,
            "infeasible": None if self.infeasible is None else {
                "pairs": [list(pair) for pair in self.infeasible.pairs],
                "least": self.infeasible.least,
                "far": self.infeasible.far,
                "remedies": [list(pair) for pair in self.infeasible.remedies],
            },
            "loads": [asdict(load) for load in self.loads],
            "front": [
                {
                    "springs": row.springs,
                    "residual": row.residual,
                    "bound": row.bound,
                    "pairs": [list(pair) for pair in row.pairs],
                    "exact": row.exact,
                    "status": self.status(row),
                }
                for row in self.front
            ],
            "by_chance": self.by_chance,
            **({"brought": dict(self.brought)} if self.brought else {}),
            "goal": self.goal.to_dict() or None,
            "fewest": None if self.fewest is None else self.fewest.to_dict(),
            "free_parameters": dict(self.free_parameters),
            "free_length": None if self.ordinary is None else self.ordinary.to_dict(),
            **({} if self.counterweights is None else {"counterweights": self.counterweights.to_dict()}),
            "balance": self.balance.to_dict(),
        }  # fmt: skip
