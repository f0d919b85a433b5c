"""The linear law, both ways."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi, sqrt
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ...arrays import Array
from ...errors import Fault, finite, positive
from .law import Knob, Law, amount

if TYPE_CHECKING:
    from ....energy.kernel.trace import Trace, Value


@dataclass(frozen=True)
class Linear(Law):
    """``stiffness (s - free_length)``, both ways: it also pushes when shorter.

    Attributes:
        stiffness: [N/m], or [N m/rad] on a joint.
        free_length: where it exerts nothing [m or rad]; below 0 on a line, it is tightened beyond zero length.
    """

    kind: ClassVar[str] = "linear"
    noun: ClassVar[str] = "a linear spring"
    knobs: ClassVar[tuple[Knob, ...]] = (Knob("stiffness", "stiffness [N/m]"),)

    stiffness: float = amount("stiffness")
    free_length: float = amount("length", 0.0)

    def energy(self, s: Array) -> Array:
        return 0.5 * self.stiffness * (s - self.free_length) ** 2

    def pull(self, s: Array) -> Array:
        return self.stiffness * (s - self.free_length)

    def over(self, s: Array) -> Array:
        if not self.free_length:
            return np.full_like(s, self.stiffness)
        return super().over(s)

    @property
    def polynomial(self) -> tuple[float, float, float]:
        k, s0 = self.stiffness, self.free_length
        return k / 2 * s0**2, -k * s0, k / 2

    @property
    def scale(self) -> float:
        return sqrt(self.stiffness)

    def of_square(self, t: Trace, square: Value) -> tuple[Value, Value, Value]:
        size = t.sqrt(square)
        length = t.mul(1 / self.scale, size)
        if not self.free_length:
            return length, t.mul(0.5, square), 1.0
        free = self.free_length * self.scale
        over = t.add(size, -free)
        return length, t.mul(0.5, t.mul(over, over)), t.share(size, free)

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        over = t.add(s, -self.free_length)
        return t.mul(self.stiffness / 2, t.mul(over, over)), t.mul(self.stiffness, over)

    def faults(self) -> Iterator[Fault]:
        yield from positive(("stiffness",), self.stiffness, "N/m")
        yield from finite(("free_length",), self.free_length)

    def mjcf(self) -> Mapping[str, tuple[float, ...]]:
        # one number would leave a slack range from 0 to it
        return {"stiffness": (self.stiffness,), "springlength": (self.free_length, self.free_length)}

    def mjcf_bias(self) -> tuple[float, float]:
        return -self.stiffness * self.free_length, self.stiffness

    @property
    def free(self) -> float:
        return self.free_length

    def scaled(self, factor: float) -> Linear:
        return self._times(factor, "stiffness")


@dataclass(frozen=True)
class Torsional(Linear):
    """The same on a joint: ``stiffness (angle - rest)``; `free_length` is the angle at rest."""

    kind: ClassVar[str] = "torsion"
    noun: ClassVar[str] = "a torsion spring"
    knobs: ClassVar[tuple[Knob, ...]] = (
        Knob("stiffness", "stiffness [N m/rad]"),
        Knob("rest", "relaxed at [deg]", 180 / pi, -360.0, 360.0),
    )

    def faults(self) -> Iterator[Fault]:
        yield from positive(("stiffness",), self.stiffness, "N m/rad")
        yield from finite(("rest",), self.free_length)

    @property
    def strength(self) -> tuple[float, str]:
        return self.stiffness, "N m/rad"
