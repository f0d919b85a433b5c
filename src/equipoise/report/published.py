"""Reproductions as text: a table for the terminal, and one in Markdown for files and the documentation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..reproduce import Reproduction, Row

STYLES = {"agrees": "green", "computed": "", "erratum": "yellow", "differs": "bold red"}
TITLES = ("item", "published", "computed", "unit", "difference", "verdict")


def reproduction_lines(one: Reproduction) -> Iterator[RenderableType]:
    """The paper, its numbers beside the computed ones, the notes, and a count of the verdicts."""
    yield Text(f"{one.paper}: {one.citation}", style="bold")
    table = Table(box=None, pad_edge=False, header_style="dim")
    for title in TITLES:
        table.add_column(title, justify="left" if title in ("item", "unit", "verdict") else "right")
    for row in one.rows:
        table.add_row(*(Text(cell) for cell in _cells(row)[:-1]), Text(row.verdict, style=STYLES[row.verdict]))
    yield table
    for row in one.rows:
        for text in filter(None, (row.erratum and f"erratum: {row.erratum}", row.note)):
            yield Text(f"  {row.item}: {text}", style="dim")
    yield Text(summary(one))


def reproduction_markdown(one: Reproduction) -> str:
    """The same as Markdown."""
    lines = [f"# {one.paper}", "", one.citation, "", "| " + " | ".join(TITLES) + " | note |"]
    lines.append("|---" * (len(TITLES) + 1) + "|")
    for row in one.rows:
        notes = "; ".join(filter(None, (row.erratum, row.note)))
        lines.append("| " + " | ".join([*_cells(row), notes]).replace("\n", " ") + " |")
    lines += ["", summary(one), ""]
    for figure in one.figures:
        lines += [f"![{figure.title}]({one.paper}-{figure.name}.png)", ""]
    return "\n".join(lines)


def summary(one: Reproduction) -> str:
    """How many numbers agree, differ, are errata in print, or were not printed."""
    count = Counter(row.verdict for row in one.rows)
    return (
        f"{count['agrees']} agree within rounding, {count['differs']} differ, "
        f"{count['erratum']} errata, {count['computed']} not printed"
    )


def _cells(row: Row) -> tuple[str, ...]:
    difference = row.relative_difference
    share = "" if difference is None else f"{100 * difference:+.2g} %"
    return row.item, row.published or "", f"{row.computed:.6g}", row.unit, share, row.verdict
