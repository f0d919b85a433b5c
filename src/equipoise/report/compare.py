"""Methods side by side, for the terminal and as a picture."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from ..study.compare import Compared, Comparison
from . import style
from .figure import render
from .numbers import percent

ROW = "{:<18} {:>9} {:>9} {:>7} {:>9} {:>9} {:>9}  {}"
HEAD = ROW.format("method", "left", "at least", "springs", "force", "energy", "mass", "can it be made?")
WIDE = 12.0  # [in]
BAR = 0.42  # [in] height of a row in the picture


def comparison_lines(found: Comparison) -> Iterator[RenderableType]:
    """The whole table."""
    yield Text(f"{found.mechanism.name}: what each method leaves of the torque (root mean square)", style="bold")
    yield Text(HEAD, style="dim")
    for row in found.rows:
        yield row_line(row)


def row_line(row: Compared) -> Text:
    """One row, of columns that are as wide whatever comes after it."""
    if row.springs is None:
        return Text(f"{row.name:<18} no: {row.note}", style="dim")
    made = "not known" if row.buildable is None else "yes" if row.buildable else "no"
    cells = (
        "0, proved" if row.exact else _share(row.rms if row.rms is not None else row.left),
        _share(row.bound),
        str(row.springs),
        f"{row.force:.4g} N",
        f"{row.energy:.4g} J",
        "-" if row.mass is None else f"{row.mass:.3g} kg",
    )
    note = f"{made}: {row.note.removeprefix('cannot be made: ')}" if row.note else made
    return Text(ROW.format(row.name, *cells, note), style="green" if row.exact and row.buildable else "")


def save_comparison(found: Comparison, path: str | os.PathLike[str]) -> None:
    """A bar for what each method leaves, with its bound as a mark and its largest force beside it.

    Raises:
        InputError: as `check_drawable`.
    """
    rows = [row for row in found.rows if row.springs is not None][::-1]
    render(path, (WIDE, 1.6 + BAR * max(1, len(rows))), lambda figure: _draw(figure, found.mechanism.name, rows))


def _draw(figure: Any, name: str, rows: list[Compared]) -> None:
    high = 1.6 + BAR * max(1, len(rows))
    axes = figure.add_axes((0.14, 0.85 / high, 0.5, 1 - 1.5 / high))
    left = [0.0 if row.exact else 100 * (row.rms if row.rms is not None else row.left or 0.0) for row in rows]
    colours = [style.AFTER if row.exact else style.SPRINGS[0] for row in rows]
    axes.barh(range(len(rows)), left, height=0.6, color=colours)
    for i, row in enumerate(rows):
        if row.bound is not None:
            axes.plot([100 * row.bound] * 2, [i - 0.38, i + 0.38], color=style.INK, linewidth=2)
        made = {None: "not known whether it can be made", True: "can be made", False: "cannot be made"}[row.buildable]
        count = f"{row.springs} spring{'' if row.springs == 1 else 's'}"
        left_over = "exact" if row.exact else f"{left[i]:.3g} %"
        text = f"{left_over} · {count} · {row.force:.3g} N · {made}"
        axes.annotate(text, (1.02, i), xycoords=("axes fraction", "data"), va="center", color=style.INK)
    axes.set_yticks(range(len(rows)), [row.name for row in rows])
    axes.set_xlabel("torque that is left [%], root mean square; the mark: no such springs leave less")
    axes.set_xlim(0, max(1.0, *left) * 1.05 if left else 1.0)
    axes.set_title(name, loc="left", fontweight="bold", color=style.INK)
    axes.spines[["top", "right"]].set_visible(False)


def _share(value: float | None) -> str:
    return "-" if value is None else percent(value)
