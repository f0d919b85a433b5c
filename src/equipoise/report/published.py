"""Reproductions as text: a table for the terminal, and one in Markdown for files and the documentation."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..io.files import write_text
from ..reproduce import Reproduction, Row
from ..reproduce.record import Figure, Picture
from .plots import save_plot
from .schematic import to_text

STYLES = {"agrees": "green", "golden": "green", "FAILS": "bold red"}
TITLES = ("item", "published", "golden", "computed", "unit", "difference", "verdict")
WORDS = {
    "agrees": "agree with the paper",
    "golden": "with our own value",
    "differs": "differ for a known reason",
    "unprinted": "differ for data that the paper does not print",
    "erratum": "errata, proved",
    "refuted": "claims refuted",
    "FAILS": "FAIL",
}


def reproduction_lines(one: Reproduction) -> Iterator[RenderableType]:
    """The paper, its numbers beside the computed ones, the notes, and a count of the verdicts."""
    yield Text(f"{one.paper}: {one.citation}", style="bold")
    table = Table(box=None, pad_edge=False, header_style="dim")
    for title in TITLES:
        table.add_column(title, justify="left" if title in ("item", "unit", "verdict") else "right")
    for row in one.rows:
        verdict = Text(row.verdict, style=STYLES.get(row.verdict, "yellow"))
        table.add_row(*(Text(cell) for cell in _cells(row)[:-1]), verdict)
    yield table
    for row in one.rows:
        for text in filter(None, (row.against and f"{row.against}: {row.why}", row.note)):
            yield Text(f"  {row.item}: {text}", style="dim")
    yield Text(summary(one))


def failure_lines(found: Sequence[Reproduction]) -> Iterator[RenderableType]:
    """The rows that fail, one a line; nothing when none does."""
    for row in (row for one in found for row in one.rows):
        if row.verdict == "FAILS":
            yield Text(f"FAILS: {row.failure}", style=STYLES["FAILS"])


def reproduction_markdown(one: Reproduction) -> str:
    """The same as Markdown."""
    lines = [f"# {one.paper}", "", one.citation, "", "| " + " | ".join(TITLES) + " | note |"]
    lines.append("|---" * (len(TITLES) + 1) + "|")
    for row in one.rows:
        notes = "; ".join(filter(None, (row.why, row.note)))
        lines.append("| " + " | ".join([*_cells(row), notes]).replace("\n", " ") + " |")
    lines += ["", summary(one), ""]
    for figure in one.figures:
        lines += [f"![{figure.title}]({file_name(one, figure)})", ""]
    return "\n".join(lines)


def file_name(one: Reproduction, figure: Figure) -> str:
    """What the file of a figure is called: a schematic is an SVG file."""
    return f"{one.paper}-{figure.name}.{'svg' if isinstance(figure, Picture) else 'png'}"


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure of a paper to a file.

    Raises:
        InputError: the file cannot be written.
    """
    if isinstance(figure, Picture):
        write_text(path, to_text(figure.mechanism))
    else:
        save_plot(figure, path)


def summary(one: Reproduction) -> str:
    """How many numbers have each verdict."""
    count = Counter(row.verdict for row in one.rows)
    return ", ".join(f"{count[verdict]} {words}" for verdict, words in WORDS.items() if count[verdict]) + "."


def _cells(row: Row) -> tuple[str, ...]:
    difference = row.relative_difference
    share = "" if difference is None else f"{100 * difference:+.2g} %"
    golden = row.golden if isinstance(row.golden, str) else "" if row.golden is None else f"{row.golden:.6g}"
    return row.item, row.published or "", golden, f"{row.computed:.6g}", row.unit, share, row.verdict
