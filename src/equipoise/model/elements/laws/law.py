"""What every law answers: the force of an element as a function of its path, as numbers and as symbols."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, replace
from math import degrees, inf, isfinite
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np

from ...arrays import Array, Booleans
from ...errors import Fault
from ...units import SI_UNITS

if TYPE_CHECKING:
    from ....energy.fourier.frames import Frames
    from ....energy.fourier.series import Series
    from ....energy.kernel.trace import Trace, Value
    from .comparison import Comparison

Terms = tuple[tuple[str, float], ...]
"""Joints, each with its ratio."""


class State(NamedTuple):
    """What an element is on one side of a path.

    Attributes:
        name: as a report says it: "slack".
        beyond: the path [m or rad].
        above: whether it is so at longer paths, or at shorter ones.
        limit: whether it must not be.
        unit: "m" or "rad", where `beyond` is not of the element's path.
    """

    name: str
    beyond: float
    above: bool
    limit: bool
    unit: str = ""

    def holds(self, s: Array) -> Booleans:
        """Where it is so, by more than rounding."""
        margin = 1e-9 * max(1.0, abs(self.beyond))
        return s > self.beyond + margin if self.above else s < self.beyond - margin


Look = Literal["coil", "strut", "line"]
"""A coil, a cylinder with a rod, or a line."""


class Knob(NamedTuple):
    """A number of an element that a person turns: its field, its label with the unit, and how many of that unit are one
    of SI. Between `low` and `high` in the label's unit, or from nothing to a multiple of what it is."""

    field: str
    label: str
    factor: float = 1.0
    low: float | None = None
    high: float | None = None


def amount(dimension: str, default: Any = MISSING) -> Any:
    """A number of a law with a dimension of `SI_UNITS`: a key of the mechanism file."""
    return field(default=default, metadata={"dimension": dimension})


def listed(*dimensions: str, default: Any = MISSING) -> Any:
    """A list of a law, of numbers or of pairs of them: a key of the mechanism file. "path" and "force" are dimensions
    too, those of the element that the law is in."""
    return field(default=default, metadata={"columns": dimensions})


@dataclass(frozen=True)
class Law(ABC):
    """A force dU/ds of a path s [m or rad]: more than 0 pulls towards a smaller s.

    The fields are the keys of a mechanism file; `amount` and `listed` say their dimensions.

    Attributes:
        kind: as a mechanism file names it.
        noun: as a message names it.
        knobs: its numbers that a viewer offers to turn.
        look: how it is drawn between two points.
    """

    kind: ClassVar[str]
    noun: ClassVar[str]
    knobs: ClassVar[tuple[Knob, ...]] = ()
    look: ClassVar[Look] = "coil"

    # numbers

    @abstractmethod
    def energy(self, s: Array) -> Array:
        """[J] at paths s of any shape."""

    @abstractmethod
    def pull(self, s: Array) -> Array:
        """dU/ds [N or N m]."""

    def over(self, s: Array) -> Array:
        """``pull / s``; 0 where a path that is a length vanishes and has no direction."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(s > 0, self.pull(s) / s, 0.0)

    def extremes(self, low: float, high: float) -> tuple[float, float]:
        """Least and greatest force [N or N m] on the paths from `low` to `high`."""
        least, most = (float(self.pull(np.array(s))) for s in (low, high))
        return min(least, most), max(least, most)

    # proofs

    @property
    def polynomial(self) -> tuple[float, float, float] | None:
        """(c0, c1, c2) where the energy is ``c0 + c1 s + c2 s^2`` for every s, else None."""
        return None

    def series(self, frames: Frames, terms: Terms) -> Series | None:
        """The energy [J] on the sum of ratio times angle of joints as a finite series, or None."""
        if self.polynomial is None:
            return None
        c0, c1, c2 = self.polynomial
        angle = frames.value(terms)
        return angle.sum([frames.constant(np.array([[c0]])), angle.scaled(c1), (angle @ angle).scaled(c2)])

    # the kernel's symbols, without branches

    @property
    def scale(self) -> float:
        """What the kernel multiplies lengths by before it squares them: what makes the law cheapest."""
        return 1.0

    def of_square(self, t: Trace, square: Value) -> tuple[Value, Value, Value]:
        """From the square of a length times `scale`: length [m], energy [J], and ``force / length / scale^2``."""
        length = t.sqrt(square)
        energy, force = self.of_path(t, length)
        return length, energy, t.mul(force, t.inverse(length))

    @abstractmethod
    def of_path(self, t: Trace, s: Value) -> tuple[Value, Value]:
        """Energy [J] and force [N or N m] from the path itself."""

    # files

    @abstractmethod
    def faults(self) -> Iterator[Fault]:
        """What is wrong with its numbers, paths from the element on."""

    def values(self) -> dict[str, Any]:
        """The file's keys and their values; None where there is no limit."""
        return {f.name: plain(getattr(self, f.name)) for f in fields(self)}

    def mjcf(self) -> Mapping[str, tuple[float, ...]] | None:
        """As numbers of a tendon of MJCF, or None where it has none such."""
        return None

    def mjcf_bias(self) -> tuple[float, float] | None:
        """(b0, b1) of an actuator of MJCF with the force ``-(b0 + b1 s)``, where that is the law, or None."""
        return None

    # judged and shown

    @property
    def states(self) -> tuple[State, ...]:
        """Where it is slack, or must not be."""
        return ()

    @property
    def margin(self) -> float:
        """Friction [N or N m], either way; not in the force."""
        return 0.0

    def comparison(self, low: float, high: float) -> Comparison | None:
        """How what it is made of compares with it between two paths; None where nothing is said of that."""
        return None

    @property
    def strength(self) -> tuple[float, str]:
        """The number that says how strong it is, and its unit: its first one."""
        first = fields(self)[0]
        return float(getattr(self, first.name)), SI_UNITS[first.metadata["dimension"]]

    @property
    def free(self) -> float | None:
        """The path at which it exerts nothing [m or rad], where there is one."""
        return None

    def words(self) -> str:
        """What it is, for a terminal: its numbers that are not as if left out."""
        given = [f for f in fields(self) if getattr(self, f.name) != f.default]
        return ", ".join(f"{_name(f)} {_shown(f, getattr(self, f.name))}" for f in given)

    @abstractmethod
    def scaled(self, factor: float) -> Self:
        """The same, its force times `factor`."""

    def _times(self, factor: float, *names: str) -> Self:
        """The same with these numbers times the factor, as far as they are given."""
        given = {name: getattr(self, name) for name in names}
        return replace(self, **{name: factor * value for name, value in given.items() if value is not None})


def plain(value: Any) -> Any:
    """A value of a file as JSON has it: lists for tuples, None for no limit."""
    if isinstance(value, tuple):
        return [plain(item) for item in value]
    return None if value == inf else value


def _name(f: Field[Any]) -> str:
    return f.name.replace("_", " ")


def _shown(f: Field[Any], value: Any) -> str:
    if isinstance(value, tuple):
        return f"of {len(value)}"
    dimension = f.metadata["dimension"]
    factor, unit = {"length": (1e3, "mm"), "angle": (degrees(1), "deg")}.get(dimension, (1.0, SI_UNITS[dimension]))
    return f"{factor * value:.5g} {unit}".rstrip()


def above(name: str, value: float, other: str, least: float) -> Iterator[Fault]:
    """A fault where a number is not above another one [m]."""
    if isfinite(least) and not value > least:
        yield Fault((name,), f"must be more than '{other}', {least:g} m, found {value:g}")
