"""The constant law: a force along a line or cable, a torque on a joint."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from ...arrays import Array
from ...errors import Fault
from .law import Knob, Law, Look, amount

if TYPE_CHECKING:
    from ....energy.kernel.trace import Trace, Value


@dataclass(frozen=True)
class _Constant(Law):
    """The same at every path; the one field is it."""

    kind: ClassVar[str] = "constant"
    look: ClassVar[Look] = "line"

    @property
    def amount(self) -> float:
        """[N or N m], more than 0 towards a smaller path."""
        return float(getattr(self, fields(self)[0].name))

    def energy(self, s: Array) -> Array:
        return self.amount * s

    def pull(self, s: Array) -> Array:
        return np.full_like(s, self.amount, dtype=float)

    @property
    def polynomial(self) -> tuple[float, float, float]:
        return 0.0, self.amount, 0.0

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        return t.mul(self.amount, s), self.amount

    def faults(self) -> Iterator[Fault]:
        if not (np.isfinite(self.amount) and self.amount):
            yield Fault((fields(self)[0].name,), f"must be finite and not 0, found {self.amount:g}")

    def mjcf_bias(self) -> tuple[float, float]:
        return self.amount, 0.0

    def scaled(self, factor: float) -> Self:
        return self._times(factor, fields(self)[0].name)


@dataclass(frozen=True)
class ConstantForce(_Constant):
    """The same force at every length, as of a drum spring.

    Attributes:
        force: [N]; more than 0 pulls the ends together.
    """

    noun: ClassVar[str] = "a constant force"
    knobs: ClassVar[tuple[Knob, ...]] = (Knob("force", "force [N]"),)

    force: float = amount("force")


@dataclass(frozen=True)
class ConstantTorque(_Constant):
    """The same torque at every angle.

    Attributes:
        torque: [N m]; more than 0 turns towards smaller angles.
    """

    noun: ClassVar[str] = "a constant torque"
    knobs: ClassVar[tuple[Knob, ...]] = (Knob("torque", "torque [N m]"),)

    torque: float = amount("torque")
