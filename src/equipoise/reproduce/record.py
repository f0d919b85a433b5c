"""What a reproduction consists of: numbers beside the published ones, curves and maps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from math import isnan
from typing import Any, Literal, TypeVar

import numpy as np

from ..balance import Balance
from ..model.arrays import Array, frozen
from ..model.errors import EquipoiseError, InputError
from ..model.mechanism import Mechanism
from ..model.notebook import Shown

Verdict = Literal["agrees", "golden", "differs", "unprinted", "erratum", "refuted", "FAILS"]
Against = Literal["differs", "unprinted", "erratum", "refuted"]
"""Why the print does not hold: a difference with a reason; data that the paper does not print; a print that is wrong,
proved here; a claim that is refuted."""

T = TypeVar("T")

BROKEN = (EquipoiseError, ArithmeticError, LookupError, ValueError, TypeError, AssertionError)
"""What a section may raise when the source is broken, or finds nothing where the paper has something."""

EXACT = 1e-9  # of a value, or absolute where it is less than 1: how near an exact number has to be


@dataclass(frozen=True)
class Expectation:
    """What a number is held to: `value` within `tolerance`, or on one side of it ("<=", ">=")."""

    relation: Literal["=", "<=", ">="]
    value: float
    tolerance: float

    @staticmethod
    def of(text: str | float, exact: bool = False, spread: float = 0.0) -> Expectation:
        """Of "1.59", known to half a unit of its last digit unless it is exact; of "<= 2"; of a float, exact."""
        if isinstance(text, str) and text[:2] in ("<=", ">="):
            return Expectation("<=" if text[0] == "<" else ">=", float(text[2:]), spread)
        value = float(text)
        rounding = EXACT * max(1.0, abs(value)) if exact or not isinstance(text, str) else half_unit(text)
        return Expectation("=", value, rounding + spread)

    def holds(self, x: float) -> bool:
        """Whether it holds for `x`; never for NaN."""
        slack = self.tolerance * (1 + 1e-9)
        if self.relation == "=":
            return abs(x - self.value) <= slack
        return x <= self.value + slack if self.relation == "<=" else x >= self.value - slack


@dataclass(frozen=True)
class Row:
    """One number, with what it is held to: what the paper prints or claims, our own proved value, or both.

    Attributes:
        paper: key in `PAPERS`.
        item: what it is, with its place in the paper.
        published: as printed, for its last digit tells the rounding, or a claim such as "<= 2"; None where the paper
            prints none.
        computed: in `unit`.
        spread: how far the rounding of printed inputs may move `computed`; see `spread`.
        exact: the published number is not rounded: an integer, or a value that was chosen.
        golden: our own value, proved or computed in a second way: text whose last digit tells the tolerance, "<= 1e-9",
            or a float, which is exact. It is never shown as published.
        against: why `published` is expected not to hold. Then `golden` says what does.
        why: that reason in words.
        proof: of an erratum, whether what proves it was found.
        note: what a reader has to know, written from the results.

    Raises:
        ValueError: nothing is expected, or a print is contradicted without a value of our own or a reason.
    """

    paper: str
    item: str
    published: str | None
    computed: float
    unit: str = ""
    spread: float = 0.0
    exact: bool = False
    golden: str | float | None = None
    against: Against | None = None
    why: str = ""
    proof: bool = True
    note: str = ""

    def __post_init__(self) -> None:
        if self.published is None and self.golden is None:
            raise InputError(f"'{self.item}' is held to nothing")
        if self.against and (self.published is None or self.golden is None or not self.why):
            raise InputError(f"'{self.item}' contradicts the print without saying what, why, or what is true")

    @property
    def printed(self) -> Expectation | None:
        """What the paper says."""
        return None if self.published is None else Expectation.of(self.published, self.exact, self.spread)

    @property
    def own(self) -> Expectation | None:
        """What we say."""
        return None if self.golden is None else Expectation.of(self.golden)

    @property
    def value(self) -> float | None:
        """The published number."""
        return None if self.printed is None else self.printed.value

    @property
    def relative_difference(self) -> float | None:
        """(computed - published) / published; None where there is nothing to compare, or zero is printed."""
        return (self.computed - self.value) / abs(self.value) if self.value else None

    @property
    def verdict(self) -> Verdict:
        """Whether what is expected holds, and in what way; see `Against`."""
        if self.own is not None and not self.own.holds(self.computed):
            return "FAILS"
        if self.printed is None:
            return "golden"
        holds = self.printed.holds(self.computed)
        if self.against is None:
            return "agrees" if holds else "FAILS"
        return self.against if self.proof and not holds else "FAILS"

    @property
    def failure(self) -> str:
        """What is wrong with a row that fails."""
        found = f"computed {self.computed:.6g}{' ' * bool(self.unit)}{self.unit}"
        asked = [
            f"{name} {value}"
            for name, value, held in (("published", self.published, self.printed), ("golden", self.golden, self.own))
            if held is not None and not held.holds(self.computed)
        ]
        if not asked:
            asked = ["no proof of the erratum" if not self.proof else f"{self.against}, but it agrees with the print"]
        return f"{self.paper}, {self.item}: {found}, {', '.join(asked)}{f' ({self.note})' if self.note else ''}"

    def to_dict(self) -> dict[str, Any]:
        """An element of ``equipoise reproduce --json``."""
        held = self.printed if self.against is None and self.printed else self.own or self.printed
        assert held is not None
        return {
            "paper": self.paper,
            "item": self.item,
            "published": self.value,
            "computed": None if isnan(self.computed) else self.computed,
            "relative_difference": None if isnan(self.computed) else self.relative_difference,
            "note": "; ".join(part for part in (self.why, self.note) if part),
            "unit": self.unit,
            "golden": None if self.own is None else self.own.value,
            "relation": held.relation,
            "tolerance": held.tolerance,
            "verdict": self.verdict,
        }


def proved(paper: str, item: str, balance: Balance, published: str | None = None) -> Row:
    """The largest Fourier coefficient of the energy that varies, as a share of gravity's energy: of exact springs 0."""
    certificate = balance.certificate
    size = certificate.max_coefficient
    low, high = balance.gravity
    share = float("nan") if size is None else size / (high - low)
    proved = "proved at every configuration" if balance.exact else certificate.reason or "not balanced"
    return Row(paper, f"largest Fourier coefficient that varies over gravity's energy, {item}", published, share,
               exact=True, golden="<= 1e-12", note=f"{proved}; {certificate.kind}")  # fmt: skip


def half_unit(printed: str) -> float:
    """Half a unit in the last digit of a printed number: 0.005 for "1.23"."""
    exponent = Decimal(printed).as_tuple().exponent
    return 0.5 * 10.0 ** int(exponent)


def spread(f: Callable[..., float], printed: Sequence[str]) -> float:
    """How far `f` of printed numbers may be from `f` of the true ones: each rounded, all the worst way, first order."""
    x = [float(text) for text in printed]
    total = 0.0
    for i, text in enumerate(printed):
        h = half_unit(text)
        up, down = [*x], [*x]
        up[i], down[i] = x[i] + h, x[i] - h
        total += abs(f(*up) - f(*down)) / 2
    return total


@frozen
class Plot:
    """Curves over one axis: `series` maps a label to values (T,) over `x` (T,)."""

    name: str
    title: str
    xlabel: str
    ylabel: str
    x: Array
    series: dict[str, Array] = field(default_factory=dict)
    note: str = ""


@frozen
class Map:
    """Values over two axes: `panels` maps a label to z (len(y), len(x)); NaN is left blank."""

    name: str
    title: str
    xlabel: str
    ylabel: str
    zlabel: str
    x: Array
    y: Array
    panels: dict[str, Array]
    note: str = ""


@dataclass(frozen=True)
class Picture:
    """A mechanism to be drawn as a schematic."""

    name: str
    title: str
    mechanism: Mechanism
    note: str = ""


Figure = Plot | Map | Picture


@dataclass(frozen=True)
class Reproduction(Shown):
    """All of a paper: its numbers and pictures."""

    paper: str
    citation: str
    rows: tuple[Row, ...]
    figures: tuple[Figure, ...] = ()

    @staticmethod
    def of(
        paper: str,
        citation: str,
        sections: Sequence[Callable[[], Iterable[Row]]],
        drawings: Sequence[Callable[[], Iterable[Figure]]],
    ) -> Reproduction:
        """All sections and drawings; one that cannot be computed gives a row that fails."""
        failed: list[Row] = []

        def guarded(makers: Sequence[Callable[[], Iterable[T]]]) -> list[T]:
            made: list[T] = []
            for maker in makers:
                try:
                    made += maker()
                except BROKEN as error:
                    whole = getattr(maker, "func", maker)  # of a partial
                    what = (whole.__doc__ or whole.__name__).splitlines()[0]
                    failed.append(Row(paper, what, None, float("nan"), golden=0.0, note=repr(error)))
            return made

        rows, figures = guarded(sections), guarded(drawings)
        return Reproduction(paper, citation, (*rows, *failed), tuple(figures))


def vector(paper: str, item: str, printed: Sequence[str], computed: Sequence[float] | Array, **more: Any) -> list[Row]:
    """A row for each component of a vector in a body's frame."""
    values = np.asarray(computed, float)
    return [
        Row(paper, f"{item}.{axis}", text, float(value), **more)
        for axis, text, value in zip("xyz", printed, values, strict=True)
    ]
