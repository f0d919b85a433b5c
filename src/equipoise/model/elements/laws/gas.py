"""The law of a gas spring: it pushes, harder the further it is pushed in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from ...arrays import Array
from ...errors import Fault, at_least, positive
from .law import Knob, Law, Look, State, above, amount

if TYPE_CHECKING:
    from ....energy.kernel.trace import Trace, Value

STATED = 293.15
"""[K] at which vendors state forces: 20 C."""
COLDEST, HOTTEST = 200.0, 400.0  # [K]


@dataclass(frozen=True)
class Gas(Law):
    """Pushes with `force` at its longest and with `force_shortest` at its shortest; linear between.

    It goes on linearly beyond its stroke, which `states` reports. Forces go with the absolute temperature.

    Attributes:
        force: [N] at `longest`, at 20 C.
        longest, shortest: the ends of its stroke [m].
        force_shortest: [N] at `shortest`, at 20 C; or
        progression: the same as a multiple of `force`.
        temperature: [K].
        friction: [N] either way: a margin beside the force, no part of it.
    """

    kind: ClassVar[str] = "gas"
    noun: ClassVar[str] = "a gas spring"
    look: ClassVar[Look] = "strut"
    knobs: ClassVar[tuple[Knob, ...]] = (
        Knob("force", "force [N]"),
        Knob("temperature", "temperature [K]", 1.0, 233.15, 353.15),
    )

    force: float = amount("force")
    longest: float = amount("length")
    shortest: float = amount("length")
    force_shortest: float | None = amount("force", None)
    progression: float | None = amount("number", None)
    temperature: float = amount("temperature", STATED)
    friction: float = amount("force", 0.0)

    @property
    def slope(self) -> float:
        """[N/m] how much harder it pushes for each metre that it is pushed in."""
        if self.force_shortest is not None:
            inmost = self.force_shortest
        else:
            inmost = self.force * (1.0 if self.progression is None else self.progression)
        return self.warmth * (inmost - self.force) / (self.longest - self.shortest)

    @property
    def warmth(self) -> float:
        """What its temperature multiplies its forces by."""
        return self.temperature / STATED

    @property
    def start(self) -> float:
        """[N] what it would push with at length 0."""
        return self.warmth * self.force + self.slope * self.longest

    def energy(self, s: Array) -> Array:
        out = s - self.longest
        return out * (0.5 * self.slope * out - self.warmth * self.force)

    def pull(self, s: Array) -> Array:
        return self.slope * (s - self.longest) - self.warmth * self.force

    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        out, force = t.add(s, -self.longest), self.warmth * self.force
        leaning = t.mul(self.slope, out)
        return t.mul(out, t.add(t.mul(0.5, leaning), -force)), t.add(leaning, -force)

    def faults(self) -> Iterator[Fault]:
        yield from positive(("force",), self.force, "N")
        yield from positive(("shortest",), self.shortest, "m")
        yield from above("longest", self.longest, "shortest", self.shortest)
        yield from at_least(("friction",), self.friction, 0, "N")
        if (self.force_shortest is None) == (self.progression is None):
            yield Fault(("progression",), "give 'progression' or 'force_shortest', and not both")
        for name, unit in (("force_shortest", "N"), ("progression", "times")):
            if (value := getattr(self, name)) is not None:
                yield from positive((name,), value, unit)
        if not COLDEST <= self.temperature <= HOTTEST:
            problem = (
                f"must be from {COLDEST:g} to {HOTTEST:g} K, found {self.temperature:g}; a number without a unit is"
            )
            yield Fault(("temperature",), f"{problem} in kelvin: write '45 degC'")

    def mjcf_bias(self) -> tuple[float, float]:
        return -self.start, self.slope

    @property
    def states(self) -> tuple[State, ...]:
        return (
            State("past its longest", self.longest, above=True, limit=True),
            State("past its shortest", self.shortest, above=False, limit=True),
        )

    @property
    def margin(self) -> float:
        return self.friction

    @property
    def strength(self) -> tuple[float, str]:
        return self.warmth * self.force, "N"

    def scaled(self, factor: float) -> Gas:
        return self._times(factor, "force", "force_shortest")
