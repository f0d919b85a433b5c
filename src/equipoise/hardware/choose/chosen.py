"""What can be asked of parts that exist, and what was chosen."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from ...balance import Balance
from ...model.errors import Fault, InputError, nearest
from ...model.mechanism import Mechanism
from ..sizing.limits import Limits
from ..stock.part import Stock, said
from .mount import REALISE, Realise
from .search import Progressed


@dataclass(frozen=True)
class Chosen:
    """The springs that were chosen.

    Attributes:
        mechanism: with them.
        balance: of it. unbalanced, residual: [N m] what is counted, `objective`, of it without and with the springs.
        ideal: what springs of zero free length would leave on the same pairs and regions, and `bound` what no such
            springs undercut, as shares of the load; None where that was not asked.
        parts: of each chosen spring in turn, and how each is realised.
        fits: how many parts of the list fit at all. complete: whether all were tried.
        polished: parts that were moved into place. seconds: that it took. history: how the answer got better.
    """

    mechanism: Mechanism
    balance: Balance
    objective: str
    residual: float
    unbalanced: float
    ideal: float | None
    parts: tuple[Stock, ...]
    offered: int
    complete: bool
    polished: int
    history: tuple[Progressed, ...] = ()
    limits: Limits = field(default_factory=Limits)

    @property
    def left(self) -> float:
        """The share of the load's peak that is left at the most, by the verdict on the finished mechanism."""
        return self.balance.relative

    @property
    def gap(self) -> float:
        """By how much of the load's peak another choice could be better: no springs leave less than nothing."""
        return self.left

    @property
    def first(self) -> float:
        """[s] until there was an answer."""
        return self.history[0].seconds if self.history else 0.0

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise stock --json``, without the balance."""
        return {
            "objective": self.objective,
            "left": self.left,
            "gap": self.gap,
            "proven": self.left <= 1e-9,
            "residual": self.residual,
            "unbalanced": self.unbalanced,
            "ideal": self.ideal,
            "complete": self.complete,
            "polished": self.polished,
            "offered": self.offered,
            "history": [asdict(step) for step in self.history],
            "cost": sum(part.mass for part in self.parts),
            "springs": [
                {"name": element.name, "realisation": getattr(element, "realisation", ""), "stock": said(part)}
                for element, part in zip(self.mechanism.springs[-len(self.parts) :], self.parts, strict=True)
            ],
        }


@dataclass(frozen=True)
class Choice:
    """What `choose_parts` can be asked for.

    Attributes:
        realise: ways to build springs in, of `REALISE`; of several the best for each spring.
        springs: how many, at most, where the mechanism has none (by default as few as ideal springs take); else one for
            each that it has.
        parallel: equal parts side by side, at most, as one spring.
        limits: margins that every part keeps. max_length, max_force: of every spring in use [m, N].
        pulley: radius of pulleys [m].
        without: parts that are not to be had.
        objective: "peak" or "rms" torque.
        seconds: to search for at most. seed: of random places and poses.
    """

    realise: tuple[Realise, ...] = ("direct",)
    springs: int | None = None
    parallel: int = 1
    limits: Limits = field(default_factory=Limits)
    max_length: float = np.inf
    max_force: float = np.inf
    pulley: float = 0.01
    without: tuple[str, ...] = ()
    objective: str = "peak"
    seconds: float = 60.0
    seed: int = 0

    def __post_init__(self) -> None:
        for one in self.realise:
            if one not in REALISE:
                raise InputError(Fault(("realise",), f"unknown realisation {nearest(one, REALISE)}", REALISE))
