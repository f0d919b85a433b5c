"""What a reproduction consists of: numbers beside the published ones, curves and maps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any, Literal

import numpy as np

from ..model.arrays import Array

Verdict = Literal["agrees", "differs", "erratum", "computed"]


@dataclass(frozen=True)
class Row:
    """One number, published beside computed.

    Attributes:
        paper: key in `PAPERS`.
        item: what it is, with its place in the paper.
        published: as printed, for its last digit tells the rounding; None where the paper prints none.
        computed: in `unit`.
        spread: how far the rounding of printed inputs may move `computed`; see `spread`.
        erratum: why print and truth differ: the number in print is wrong, or what it rests on.
        note: what a reader has to know.
    """

    paper: str
    item: str
    published: str | None
    computed: float
    unit: str = ""
    spread: float = 0.0
    erratum: str = ""
    note: str = ""

    @property
    def value(self) -> float | None:
        """The published number."""
        return None if self.published is None else float(self.published)

    @property
    def rounding(self) -> float:
        """Half a unit in the last printed digit."""
        return 0.0 if self.published is None else half_unit(self.published)

    @property
    def relative_difference(self) -> float | None:
        """(computed - published) / published; None where there is nothing to compare, or zero is printed."""
        return (self.computed - self.value) / abs(self.value) if self.value else None

    @property
    def verdict(self) -> Verdict:
        """Whether they agree within the rounding of the number and of what it was computed from."""
        if self.erratum:
            return "erratum"
        if self.value is None:
            return "computed"
        near = abs(self.computed - self.value) <= (self.rounding + self.spread) * (1 + 1e-9)
        return "agrees" if near else "differs"

    def to_dict(self) -> dict[str, Any]:
        """An element of ``equipoise reproduce --json``."""
        return {
            "paper": self.paper,
            "item": self.item,
            "published": self.value,
            "computed": self.computed,
            "relative_difference": self.relative_difference,
            "note": "; ".join(part for part in (self.erratum, self.note) if part),
            "unit": self.unit,
            "rounding": self.rounding + self.spread,
            "verdict": self.verdict,
        }


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


@dataclass(frozen=True)
class Plot:
    """Curves over one axis: `series` maps a label to values (T,) over `x` (T,)."""

    name: str
    title: str
    xlabel: str
    ylabel: str
    x: Array
    series: dict[str, Array] = field(default_factory=dict)
    note: str = ""


@dataclass(frozen=True)
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
class Reproduction:
    """All of a paper: its numbers and pictures."""

    paper: str
    citation: str
    rows: tuple[Row, ...]
    figures: tuple[Plot | Map, ...] = ()


def vector(paper: str, item: str, printed: Sequence[str], computed: Sequence[float] | Array, **more: Any) -> list[Row]:
    """A row for each component of a vector in a body's frame."""
    values = np.asarray(computed, float)
    return [
        Row(paper, f"{item}.{axis}", text, float(value), **more)
        for axis, text, value in zip("xyz", printed, values, strict=True)
    ]
