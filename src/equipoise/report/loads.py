"""The holding torque of every coordinate with and without springs, as bars."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..balance import Balance
from ..model.arrays import Array, Integers
from ..model.coordinate import Coordinate, Slide
from . import style

BARS_SHOWN = 12  # coordinates shown
NAME = 24  # letters of a coordinate's name
THICKEST = 0.3  # [in] a bar
TINY = 1e-9  # [N m or N] torque below this is shown as nothing
LOG = 0.02  # a residual below this share of the unbalanced torque needs a logarithmic axis to be seen
Kind = type[Coordinate]  # all that turn, or all that slide


def shown(balance: Balance) -> dict[Kind, Integers]:
    """Kind -> numbers of the coordinates to show, in their order, at most `BARS_SHOWN` in all."""
    turns = np.array([coordinate.turns for coordinate in balance.coordinates], bool)
    share = np.zeros(len(turns))
    for own in (turns, ~turns):
        largest = balance.unbalanced.max[own].max(initial=0)
        share[own] = balance.unbalanced.max[own] / largest if largest > 0 else 0.0
    keep = np.sort(np.argsort(-share, kind="stable")[:BARS_SHOWN])
    groups: dict[Kind, Integers] = {Coordinate: keep[turns[keep]], Slide: keep[~turns[keep]]}
    groups = {kind: rows for kind, rows in groups.items() if len(rows)}
    loaded = {kind: rows for kind, rows in groups.items() if _top(balance, rows) > TINY}
    return loaded or groups


def below(balance: Balance) -> float | None:
    """A round torque that no residual exceeds, when it is exact or nothing but rounding; None otherwise."""
    largest = float(balance.residual.max.max(initial=0))
    if not balance.exact and largest >= TINY:
        return None
    return max(TINY, 10.0 ** np.ceil(np.log10(largest))) if largest > 0 else TINY


def draw(axes: Any, balance: Balance, kind: Kind, rows: Integers) -> None:
    """Bars of coordinates `rows`, all of a kind: solid up to the rms, pale up to the largest."""
    springs, limit = bool(balance.mechanism.springs), below(balance)
    before = balance.unbalanced.max[rows], balance.unbalanced.rms[rows]
    after = balance.residual.max[rows], balance.residual.rms[rows]
    top = max(_top(balance, rows), TINY)
    start, log = 0.0, False
    if springs and limit is None:
        log = TINY < float(after[0].max()) < LOG * top
        start = _floor(np.concatenate([*before, *after]), top) if log else 0.0
    inches = axes.get_position().height * axes.figure.get_figheight() / len(rows)
    height = min(0.36, THICKEST / inches)
    size = min(11.0, 72 * inches * height * (0.95 if springs else 2.0))
    for i, row in enumerate(rows):
        y = i - height * 0.55 if springs else float(i)
        name = style.clean(balance.coordinates[row], NAME)
        axes.text(-0.015, i, name, transform=axes.get_yaxis_transform(), ha="right", va="center", parse_math=False)
        colours = (style.BEFORE, style.BEFORE_PALE, style.FAINT)
        _bar(axes, y, before[1][i], before[0][i], start, height, colours, _label(before[0][i]), size)
        if springs:
            colours = (style.AFTER, style.AFTER_PALE, style.AFTER)
            text = _label(after[0][i]) if limit is None else "exact" if balance.exact else "0"
            _bar(axes, i + height * 0.55, after[1][i], after[0][i], start, height, colours, text, size)
    if log:
        axes.set_xscale("log")
        axes.set_xlim(start, top * (top / start) ** 0.16)
    else:
        axes.set_xlim(0, top * 1.16)
    axes.set_ylim(len(rows) - 0.45, -0.55)
    axes.set_yticks([])
    axes.set_xlabel(f"holding {kind.load} [{kind.load_unit}]" + (", logarithmic" if log else ""))
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(style.FAINT)
    axes.tick_params(axis="x", colors=style.FAINT)
    axes.grid(axis="x", color=style.GRID, linewidth=0.8)
    axes.set_axisbelow(True)


def key(figure: Any, balance: Balance, left: float, top: float) -> None:
    """What the bars mean, with its upper left corner at (left, top) of the figure."""
    from matplotlib.legend_handler import HandlerTuple
    from matplotlib.patches import Patch

    pairs = [((style.BEFORE, style.BEFORE_PALE), "without springs")]
    if balance.mechanism.springs:
        pairs.append(((style.AFTER, style.AFTER_PALE), "with springs"))
    handles = [tuple(Patch(color=colour) for colour in colours) for colours, _ in pairs]
    figure.legend(
        handles, [text for _, text in pairs], loc="upper left", bbox_to_anchor=(left, top), ncols=2, frameon=False,
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0)}, handlelength=2.6, borderpad=0, borderaxespad=0,
        columnspacing=1.6,
    )  # fmt: skip


def _bar(
    axes: Any, y: float, rms: float, top: float, start: float, height: float, colours: Any, text: str, size: float
) -> None:
    solid, pale, ink = colours
    end = start
    if top > TINY:
        axes.barh(y, max(top - start, 0.0), left=start, height=height, color=pale)
        axes.barh(y, max(rms - start, 0.0), left=start, height=height, color=solid)
        end = max(top, start)
    look = {"va": "center_baseline", "color": ink, "fontsize": size, "parse_math": False}
    axes.annotate(text, (end, y), (5, 0), textcoords="offset points", **look)


def _label(top: float) -> str:
    return style.number(top) if top > TINY else "0"


def _top(balance: Balance, rows: Integers) -> float:
    residual = balance.residual.max[rows] if balance.mechanism.springs else np.zeros(1)
    return max(float(balance.unbalanced.max[rows].max()), float(residual.max()))


def _floor(values: Array, top: float) -> float:
    """Where a logarithmic axis starts: a power of ten under everything worth seeing, at most seven below the top."""
    seen = values[values > 1e-7 * top]
    return float(10.0 ** np.floor(np.log10(seen.min()) - 0.2))
