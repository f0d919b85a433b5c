"""One picture of many builds: the distribution of the peak residual torque, and what causes it."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from ..robust import Tolerance
from . import style
from .figure import render

SIZE = (12.0, 5.0)  # [in]
BINS = 80
NAMED = 8  # parameters with a bar
SMALL = 0.02  # coordinates whose peaks stay below this share of the largest are left out


def save_builds(found: Tolerance, path: str | os.PathLike[str]) -> None:
    """Draw it; the file is written whole or not at all.

    Raises:
        InputError: a suffix other than .svg, .png or .pdf, or the folder cannot be written to.
    """
    render(path, SIZE, lambda figure: _draw(figure, found))


def _draw(figure: Any, found: Tolerance) -> None:
    name = style.clean(found.mechanism.name, 40)
    title = f"{name}  ·  {len(found.peak):,} builds"
    if found.yield_ is not None:
        title += f"  ·  {100 * found.yield_:.3g} % within friction"
    figure.text(0.02, 0.92, title, fontsize=15, weight="bold", color=style.INK, parse_math=False)
    axes = figure.add_axes((0.07, 0.15, 0.46, 0.7))
    for turns, line in ((True, "-"), (False, ":")):
        _histograms(axes, found, turns, line)
    units = " or ".join(dict.fromkeys(coordinate.load_unit for coordinate in found.coordinates))
    axes.set_xlabel(f"largest residual torque over {found.poses:,} poses [{units}]", color=style.INK)
    axes.set_ylabel("builds", color=style.INK)
    axes.set_xlim(left=0)
    axes.legend(frameon=False)
    bars = figure.add_axes((0.74, 0.15, 0.24, 0.7))
    ranked = found.ranked[:NAMED]
    bars.barh(range(len(ranked)), [100 * share for _, share in ranked], color=style.AFTER)
    labels = [style.clean(parameter.name, 30) for parameter, _ in ranked]
    bars.set_yticks(range(len(ranked)), labels, fontsize=10, parse_math=False)
    bars.invert_yaxis()
    bars.set_xlabel("share of mean square torque [%]", color=style.INK)
    for box in (axes, bars):
        for side in ("top", "right"):
            box.spines[side].set_visible(False)


def _histograms(axes: Any, found: Tolerance, turns: bool, line: str) -> None:
    own = [j for j, coordinate in enumerate(found.coordinates) if coordinate.turns == turns]
    largest = max((float(found.peak[:, j].max()) for j in own), default=0.0)
    for j in own:
        peak, colour = found.peak[:, j], style.spring_colour(j)
        if peak.max() <= SMALL * largest:
            continue
        counts, edges = np.histogram(peak, BINS, (0.0, float(np.percentile(peak, 99.9)) * 1.1 or 1.0))
        label = style.clean(found.coordinates[j], 24)
        axes.stairs(counts, edges, color=colour, linewidth=1.8, linestyle=line, label=label)
        if (held := found.friction.get(found.coordinates[j])) is not None:
            axes.axvline(held, color=colour, linestyle="--", linewidth=1.2)
