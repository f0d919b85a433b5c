"""Plots as SVG text, for pages that load nothing: signed bars of two quantities, and curves over one axis.

Colours come from CSS variables with the light theme's values as default, so that a page can redefine them for the dark
one. Every picture names itself for readers that do not see it.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from ..model.arrays import Array
from . import style

WIDTH = 360  # of every plot, in its own units; a page scales it
ROW = 30  # height of a coordinate's two bars
NAMES = 104  # room for the names
HEIGHT = 190  # of curves
COLOURS = (style.BEFORE, style.SPRINGS[1], style.AFTER, style.SPRINGS[0])
INK, GRID = f"var(--ink, {style.INK})", f"var(--grid, {style.GRID})"


def bars(
    names: Sequence[str], before: Array, after: Array, units: Sequence[str], title: str, floor: float = 1e-9
) -> str:
    """Two signed bars for each name: `before` grey, `after` green, with their values; less than `floor` is 0."""
    before, after = (np.where(np.abs(values) < floor, 0.0, values) for values in (before, after))
    top = max(float(np.abs(np.concatenate([before, after, [floor]])).max()), floor)
    signed = bool(min(before.min(initial=0), after.min(initial=0)) < 0)
    room = WIDTH - NAMES - (104 if signed else 62)
    zero = NAMES + (room / 2 + 48 if signed else 0)
    unit = room / (2 * top if signed else top)
    parts = []
    for i, name in enumerate(names):
        y = i * ROW + 4
        parts.append(_text(0, y + 14, style.clean(name, 17), "start"))
        rows = ((before[i], f"var(--before, {style.BEFORE})"), (after[i], f"var(--after, {style.AFTER})"))
        for j, (value, colour) in enumerate(rows):
            width, top_y = abs(value) * unit, y + 11 * j
            left = zero if value >= 0 else zero - width
            parts.append(f'<rect x="{left:.1f}" y="{top_y}" width="{width:.1f}" height="9" rx="1.5" fill="{colour}"/>')
            at, anchor = (zero + width + 4, "start") if value >= 0 else (zero - width - 4, "end")
            label = f"{style.number(value)} {units[i]}"
            parts.append(_text(at, top_y + 8, label, anchor, 9))
    height = len(names) * ROW + 6
    parts.append(f'<line x1="{zero:.1f}" y1="0" x2="{zero:.1f}" y2="{height - 4}" stroke="{INK}" stroke-width="0.8"/>')
    said = "; ".join(
        f"{name}: {style.number(b)} without, {style.number(a)} {u} with springs"
        for name, b, a, u in zip(names, before, after, units, strict=True)
    )
    return _picture(height, f"{title}. {said}", parts)


def curves(x: Array, series: dict[str, Array], xlabel: str, ylabel: str, title: str) -> str:
    """Curves over `x` (T,) with a legend; values (T,), NaN leaves a gap."""
    values = np.concatenate([np.asarray(y, float) for y in series.values()])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    pad = max(0.06 * (high - low), 1e-9 * max(abs(low), abs(high)), 1e-9)
    low, high = low - pad, high + pad
    left, right, top, bottom = 46, WIDTH - 8, 26, HEIGHT - 30
    first, last = (float(x[0]), float(x[-1])) if len(x) > 1 else (0.0, 1.0)
    parts = []
    for value in ticks(low, high):
        y = bottom - (value - low) / (high - low) * (bottom - top)
        parts.append(f'<line x1="{left}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}" stroke="{GRID}"/>')
        parts.append(_text(left - 4, y + 3, f"{value:.6g}", "end", 9))
    for value in ticks(first, last):
        at = left + (value - first) / max(last - first, 1e-12) * (right - left)
        parts.append(_text(at, bottom + 12, f"{value:.6g}", "middle", 9))
    step = (right - left) / max(1, len(series))
    for i, (label, y) in enumerate(series.items()):
        colour = f"var(--curve-{i}, {COLOURS[i % len(COLOURS)]})"
        at = left + i * step
        parts.append(f'<line x1="{at:.0f}" y1="9" x2="{at + 16:.0f}" y2="9" stroke="{colour}" stroke-width="2.5"/>')
        parts.append(_text(at + 20, 12, label, "start", 10))
        px = left + (np.asarray(x, float) - first) / max(last - first, 1e-12) * (right - left)
        py = bottom - (np.asarray(y, float) - low) / (high - low) * (bottom - top)
        line = f'fill="none" stroke="{colour}" stroke-width="1.8"'
        parts += [f'<polyline points="{piece}" {line}/>' for piece in _pieces(px, py)]
    parts.append(_text((left + right) / 2, HEIGHT - 4, xlabel, "middle", 10))
    parts.append(_text(left - 38, top - 6, ylabel, "start", 9))
    said = "; ".join(f"{name}: {_range(np.asarray(y, float))}" for name, y in series.items())
    return _picture(HEIGHT, f"{title}. {ylabel} over {xlabel}. {said}", parts)


def ticks(low: float, high: float, most: int = 5) -> list[float]:
    """At most `most` + 1 round values from `low` to `high`."""
    if not high > low:
        return [low]
    raw = (high - low) / most
    power = 10.0 ** np.floor(np.log10(raw))
    step = float(next(m * power for m in (1, 2, 5, 10) if m * power >= raw * (1 - 1e-9)))
    count = np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1)
    return [float(k * step) + 0.0 for k in count]


def _range(y: Array) -> str:
    y = y[np.isfinite(y)]
    return f"from {y.min():.4g} to {y.max():.4g}" if len(y) else "nothing"


def _pieces(x: Array, y: Array) -> list[str]:
    pieces: list[list[str]] = [[]]
    for a, b in zip(x, y, strict=True):
        if np.isfinite(b):
            pieces[-1].append(f"{a:.1f},{b:.1f}")
        elif pieces[-1]:
            pieces.append([])
    return [" ".join(piece) for piece in pieces if piece]


def _text(x: float, y: float, text: str, anchor: str, size: int = 11) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}" fill="{INK}">{escape(text)}</text>'


def _picture(height: float, title: str, parts: list[str]) -> str:
    head = f'<svg viewBox="0 0 {WIDTH} {height:.0f}" role="img" aria-label="{escape(title)}" width="100%"'
    head += ' font-family="system-ui, sans-serif" xmlns="http://www.w3.org/2000/svg">'
    return head + "".join(parts) + "</svg>"
