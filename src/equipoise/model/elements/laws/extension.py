"""The law of a hooked extension spring: it only pulls, and not before its initial tension."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf, isnan
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ...arrays import Array
from ...errors import Fault, at_least, finite, positive
from .law import Knob, Law, State, above, amount

if TYPE_CHECKING:
    from ....energy.kernel.trace import Trace, Value


@dataclass(frozen=True)
class Extension(Law):
    """``initial_tension + stiffness (s - cable - body_length)`` where s is longer than these two, else nothing: slack.

    Attributes:
        stiffness: [N/m], positive.
        body_length: between the insides of its hooks, not loaded [m].
        initial_tension: [N] that its coils press with on each other.
        longest: [m] that it may be stretched to.
        cable: [m] of a cable that it pulls at, which is part of s and not of the other lengths.
    """

    kind: ClassVar[str] = "extension"
    noun: ClassVar[str] = "an extension spring"
    knobs: ClassVar[tuple[Knob, ...]] = (
        Knob("stiffness", "stiffness [N/m]"),
        Knob("body_length", "body length [mm]", 1e3),
    )

    stiffness: float = amount("stiffness")
    body_length: float = amount("length")
    initial_tension: float = amount("force", 0.0)
    longest: float = amount("length", inf)
    cable: float = amount("length", 0.0)

    @property
    def begins(self) -> float:
        """The path at which it begins to pull [m]."""
        return self.body_length + self.cable

    def energy(self, s: Array) -> Array:
        over = np.maximum(s - self.begins, 0.0)
        return self.initial_tension * over + 0.5 * self.stiffness * over**2

    def pull(self, s: Array) -> Array:
        over = s - self.begins
        return np.where(over > 0, self.initial_tension + self.stiffness * over, 0.0)

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        over = t.clamp(s, self.begins)
        pull = t.mul(self.stiffness, over)
        force = t.add(t.mul(self.initial_tension, t.step(over)), pull) if self.initial_tension else pull
        # half of what it begins and ends with, times the way
        return t.mul(over, t.add(t.mul(0.5, pull), self.initial_tension)), force

    def faults(self) -> Iterator[Fault]:
        yield from positive(("stiffness",), self.stiffness, "N/m")
        yield from positive(("body_length",), self.body_length, "m")
        yield from at_least(("initial_tension",), self.initial_tension, 0, "N")
        yield from finite(("cable",), self.cable)
        if isnan(self.longest):
            yield Fault(("longest",), "must be a number")
        yield from above("longest", self.longest, "body_length", self.body_length)

    def mjcf(self) -> Mapping[str, tuple[float, ...]] | None:
        if self.initial_tension:
            return None
        return {"stiffness": (self.stiffness,), "springlength": (0.0, self.begins)}

    @property
    def states(self) -> tuple[State, ...]:
        slack = State("slack", self.begins, above=False, limit=False)
        return (
            (slack,) if self.longest == inf else (slack, State("over-stretched", self.longest + self.cable, True, True))
        )

    @property
    def free(self) -> float:
        return self.begins

    def scaled(self, factor: float) -> Extension:
        return self._times(factor, "stiffness", "initial_tension")
