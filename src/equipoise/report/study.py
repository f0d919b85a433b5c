"""A study for the terminal and as a figure: what it will take, how it went, its rows and their plot."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from statistics import median
from typing import Any

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..model.errors import Fault, InputError, nearest
from ..study.drive import duration
from ..study.make import Trial
from ..study.plan import OK, Plan
from . import style
from .figure import render

SIZE = (9.0, 5.4)  # [in]
SHOWN = 200  # rows in a terminal
KINDS = 10  # values of --by, one colour each
LOG = 300.0  # times that the largest is the smallest: a log scale


def plan_lines(plan: Plan, trial: Trial, workers: int) -> Iterator[RenderableType]:
    """What a study will take."""
    factors = [f"{len(axis):,} ({' with '.join(axis.values)})" for axis in plan.axes]
    yield Text(f"{len(plan):,} designs" + (f" = {' x '.join(factors)}" if factors else ""), style="bold")
    yield from row_lines(list(trial.rows))
    whole = trial.seconds * len(plan)
    some = f"{len(trial.rows)} design{'s' * (len(trial.rows) > 1)} tried: {trial.seconds:.2g} s of processor time each"
    yield Text(f"{some}; all take {duration(whole)}, on {workers} workers {duration(whole / workers)}")


def summary_lines(name: str, counts: Mapping[str, int], done: int, seconds: float, busy: float) -> Iterator[Text]:
    """How a study went.

    Args:
        counts: status -> rows; done: rows of this run, which took so many seconds; busy: of processor time, all rows.
    """
    rows = sum(counts.values())
    parts = [f"{count:,} {status}" for status, count in counts.items()]
    yield Text(f"{name}: {rows:,} rows, {', '.join(parts) or 'none'}", style="bold")
    if done:
        rate = f"{done / seconds:.3g} a second" if seconds else ""
        yield Text(
            f"{done:,} designs in {duration(seconds)}, {rate}; {1e3 * busy / rows:.3g} ms of processor time each"
        )


def row_lines(rows: Sequence[Mapping[str, Any]]) -> Iterator[RenderableType]:
    """Rows as a table."""
    if not rows:
        yield Text("no rows")
        return
    shown = [name for name in rows[0] if len(rows) > 1 or rows[0][name] is not None]
    shown = [name for name in shown if any(row[name] is not None for row in rows)]
    table = Table(box=None, header_style="dim", pad_edge=False)
    for name in shown:
        text = any(isinstance(row[name], str) for row in rows)
        table.add_column(name, justify="left" if text else "right", overflow="fold")
    for row in rows[:SHOWN]:
        table.add_row(*(_cell(row[name]) for name in shown))
    yield table
    if len(rows) > SHOWN:
        yield Text(f"and {len(rows) - SHOWN:,} more: add LIMIT, or read the Parquet files")


def _cell(value: Any) -> Text:
    if isinstance(value, bool) or value is None:
        return Text({True: "yes", False: "no", None: ""}[value])
    if isinstance(value, float):
        return Text(f"{value:.6g}")
    return Text(style.clean(str(value), 60))


def save_rows(
    rows: Sequence[Mapping[str, Any]], x: str, y: str, by: str | None, path: str | os.PathLike[str], title: str = ""
) -> None:
    """Plot one column against another, a line for each value of a third: the median, and the range behind it.

    Raises:
        InputError: there is no such column, it has no numbers, or as `render`.
    """
    for name in filter(None, (x, y, by)):
        if not rows or name not in rows[0]:
            choices = tuple(rows[0]) if rows else ()
            raise InputError(Fault(("--plot",), f"there is no column {nearest(name, choices)}", choices))
    kept = [row for row in rows if _number(row[y]) and row[x] is not None and row.get("status", OK) == OK]
    if not kept:
        raise InputError(Fault(("--plot",), f"no row has numbers for {x} and {y}"))
    kinds = sorted({row[by] for row in kept}, key=_order) if by else [None]
    if len(kinds) > KINDS:
        raise InputError(Fault(("--by",), f"'{by}' has {len(kinds)} values, at most {KINDS} are told apart"))
    render(path, SIZE, lambda figure: _draw(figure, kept, x, y, by, kinds, title))


def _draw(
    figure: Any, rows: Sequence[Mapping[str, Any]], x: str, y: str, by: str | None, kinds: Sequence[Any], title: str
) -> None:
    axes = figure.add_axes((0.11, 0.13, 0.66 if by else 0.86, 0.76))
    numeric = all(_number(row[x]) for row in rows)
    places = sorted({row[x] for row in rows}, key=_order)
    for i, kind in enumerate(kinds):
        own = [row for row in rows if by is None or row[by] == kind]
        columns = {place: [row[y] for row in own if row[x] == place] for place in places}
        columns = {place: values for place, values in columns.items() if values}
        at = list(columns) if numeric else [places.index(place) for place in columns]
        middle = [median(values) for values in columns.values()]
        colour = style.spring_colour(i)
        axes.plot(at, middle, marker="o", markersize=5, linewidth=2, color=colour, label=style.clean(_text(kind), 24))
        if any(len(values) > 1 for values in columns.values()):
            low, high = ([f(values) for values in columns.values()] for f in (min, max))
            axes.fill_between(at, low, high, color=colour, alpha=0.13, linewidth=0)
    if not numeric:
        axes.set_xticks(range(len(places)), [style.clean(str(place), 16) for place in places], rotation=35, ha="right")
    for name, values in (("x", places if numeric else []), ("y", [row[y] for row in rows])):
        if values and min(values) > 0 and max(values) > LOG * min(values):
            getattr(axes, f"set_{name}scale")("log")
    if axes.get_yscale() == "linear" and min(row[y] for row in rows) >= 0:
        axes.set_ylim(bottom=0)
    axes.set_xlabel(x, color=style.INK, parse_math=False)
    axes.set_ylabel(y, color=style.INK, parse_math=False)
    axes.grid(color=style.GRID)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if by:
        axes.legend(frameon=False, title=by, loc="upper left", bbox_to_anchor=(1.01, 1.02))
    figure.text(0.02, 0.94, title, weight="bold", color=style.INK, parse_math=False)


def _number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _order(value: Any) -> tuple[int, Any]:
    return (0, value) if _number(value) else (1, str(value))


def _text(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
