"""The law of a compression spring between two points: it only pushes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ...arrays import Array
from ...errors import Fault, at_least, positive
from .law import Knob, Law, State, above, amount

if TYPE_CHECKING:
    from ....energy.kernel.trace import Trace, Value

ENDLESS = 1e6
"""[m] the end of the range in which MuJoCo leaves a compression spring slack."""


@dataclass(frozen=True)
class Compression(Law):
    """``stiffness (s - free_length)`` where s is shorter than that, else nothing: loose.

    Attributes:
        stiffness: [N/m], positive.
        free_length: not loaded [m].
        solid_length: with its coils on each other [m]; it must not get shorter.
    """

    kind: ClassVar[str] = "compression"
    noun: ClassVar[str] = "a compression spring"
    knobs: ClassVar[tuple[Knob, ...]] = (
        Knob("stiffness", "stiffness [N/m]"),
        Knob("free_length", "free length [mm]", 1e3),
    )

    stiffness: float = amount("stiffness")
    free_length: float = amount("length")
    solid_length: float = amount("length", 0.0)

    def energy(self, s: Array) -> Array:
        return 0.5 * self.stiffness * np.minimum(s - self.free_length, 0.0) ** 2

    def pull(self, s: Array) -> Array:
        return self.stiffness * np.minimum(s - self.free_length, 0.0)

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        past = t.sub(t.add(s, -self.free_length), t.clamp(s, self.free_length))
        return t.mul(self.stiffness / 2, t.mul(past, past)), t.mul(self.stiffness, past)

    def faults(self) -> Iterator[Fault]:
        yield from positive(("stiffness",), self.stiffness, "N/m")
        yield from at_least(("solid_length",), self.solid_length, 0, "m")
        yield from positive(("free_length",), self.free_length, "m")
        yield from above("free_length", self.free_length, "solid_length", self.solid_length)

    def mjcf(self) -> Mapping[str, tuple[float, ...]]:
        return {"stiffness": (self.stiffness,), "springlength": (self.free_length, ENDLESS)}

    @property
    def states(self) -> tuple[State, ...]:
        loose = State("loose", self.free_length, above=True, limit=False)
        solid = State("solid", self.solid_length, above=False, limit=True)
        return (loose, solid) if self.solid_length else (loose,)

    @property
    def free(self) -> float:
        return self.free_length

    def scaled(self, factor: float) -> Compression:
        return self._times(factor, "stiffness")
