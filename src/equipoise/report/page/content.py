"""What a report is made of: sections of texts, tables and pictures, free of how they look."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Number:
    """A number as it is read, with its full value."""

    value: float
    text: str


Cell = str | Number


@dataclass(frozen=True)
class Paragraph:
    """A text; `strong` for a section's answer."""

    text: str
    strong: bool = False


@dataclass(frozen=True)
class Items:
    """A list of texts."""

    texts: tuple[str, ...]


@dataclass(frozen=True)
class Code:
    """Lines that are typed or read as they are; `what` names them."""

    text: str
    what: str


@dataclass(frozen=True)
class Table:
    """A table whose first column names its rows."""

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    @staticmethod
    def of(caption: str, head: Iterable[str], rows: Iterable[Iterable[Cell]]) -> Table:
        """From any iterables."""
        return Table(caption, tuple(head), tuple(tuple(row) for row in rows))

    @property
    def numeric(self) -> tuple[bool, ...]:
        """Which columns hold nothing but numbers."""
        columns = ([row[j] for row in self.rows if row[j] != ""] for j in range(len(self.head)))
        return tuple(bool(cells) and all(isinstance(cell, Number) for cell in cells) for cells in columns)


@dataclass(frozen=True)
class Picture:
    """An SVG; `said` tells what it shows to those who do not see it."""

    svg: str
    caption: str
    said: str
    narrow: bool = False


Block = Paragraph | Items | Code | Table | Picture


@dataclass(frozen=True)
class Section:
    """A heading and what stands below it."""

    title: str
    blocks: tuple[Block, ...]

    @property
    def key(self) -> str:
        """For links."""
        return "-".join("".join(c if c.isalnum() else " " for c in self.title.lower()).split())


@dataclass(frozen=True)
class Report:
    """The whole.

    Attributes:
        verdict: in one sentence; good: whether it is balanced exactly.
        data: the JSON object of ``equipoise report --json``; its "balance" is that of ``equipoise check --json``.
    """

    title: str
    verdict: str
    good: bool
    sections: tuple[Section, ...]
    data: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise report --json``."""
        return self.data
