"""Curves and maps of the reproductions as figures."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from ..reproduce import Map, Plot
from . import style
from .figure import render

WIDE = (9.0, 5.2)  # [in] a plot
PANEL = (5.2, 4.8)  # [in] a panel of a map
COLOURS = (style.BEFORE, style.SPRINGS[0], style.AFTER, *style.SPRINGS[1:])
DASHES = ("-", "--", "-", "-.", ":")


def save_plot(plot: Plot | Map, path: str | os.PathLike[str]) -> None:
    """Draw curves or maps. The same input gives the same bytes; the file is written whole or not at all.

    Args:
        path: ends in .svg, .png or .pdf.

    Raises:
        InputError: another suffix, or the folder is missing or cannot be written to.
    """
    if isinstance(plot, Plot):
        render(path, WIDE, lambda figure: _curves(figure, plot))
    else:
        width = PANEL[0] * len(plot.panels)
        render(path, (width, PANEL[1]), lambda figure: _panels(figure, plot))


def _curves(figure: Any, plot: Plot) -> None:
    axes = figure.add_axes((0.1, 0.2, 0.87, 0.68))
    for i, (label, values) in enumerate(plot.series.items()):
        look = {"color": COLOURS[i % len(COLOURS)], "linestyle": DASHES[i % len(DASHES)], "linewidth": 2.2}
        axes.plot(plot.x, values, label=label, **look)
    _dress(axes, plot)
    axes.grid(color=style.GRID)
    axes.margins(x=0)
    axes.legend(frameon=False, ncols=min(4, len(plot.series)), loc="upper center", bbox_to_anchor=(0.5, -0.12))
    axes.set_title(plot.title, loc="left", fontweight="bold", color=style.INK)
    _note(figure, plot.note)


def _panels(figure: Any, plot: Map) -> None:
    values = np.concatenate([np.ravel(z) for z in plot.panels.values()])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    colours = "viridis" if low >= 0 else "RdBu_r"
    limits = {"vmin": low, "vmax": high} if low >= 0 else {"vmin": -max(-low, high), "vmax": max(-low, high)}
    width = 0.86 / len(plot.panels)
    images = []
    for i, (label, z) in enumerate(plot.panels.items()):
        axes = figure.add_axes((0.08 + i * width, 0.17, width * 0.8, 0.64))
        images.append(axes.pcolormesh(plot.x, plot.y, z, cmap=colours, shading="nearest", rasterized=True, **limits))
        _dress(axes, plot)
        axes.set_ylabel(plot.ylabel if i == 0 else "")
        axes.set_title(label, fontsize=12, color=style.INK)
    bar = figure.colorbar(images[0], cax=figure.add_axes((0.915, 0.17, 0.012, 0.64)))
    bar.set_label(plot.zlabel)
    figure.text(0.02, 0.93, plot.title, fontweight="bold", fontsize=13, color=style.INK)
    _note(figure, plot.note)


def _dress(axes: Any, plot: Plot | Map) -> None:
    axes.set_xlabel(plot.xlabel, color=style.INK)
    axes.set_ylabel(plot.ylabel, color=style.INK)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _note(figure: Any, note: str) -> None:
    figure.text(0.02, 0.015, note, fontsize=10, color=style.FAINT)
