"""A motion as a figure: torque, power and energy over time, with the springs and without."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from ..model.arrays import Array
from ..simulate import Playback
from . import style
from .figure import render

SIZE = (9.0, 9.6)  # [in]


def save_motion(found: Playback, path: str | os.PathLike[str]) -> None:
    """Draw it; with the springs in full lines, without them in thin dashes. Joints that do nothing are left out.

    Args:
        path: ends in .svg, .png or .pdf.

    Raises:
        InputError: another suffix, or the folder is missing or cannot be written to.
    """
    render(path, SIZE, lambda figure: _panels(figure, found))


def _panels(figure: Any, found: Playback) -> None:
    figure.text(0.02, 0.97, f"{found.name}: the motion with springs (full) and without (dashed)",
                fontweight="bold", fontsize=13, color=style.INK)  # fmt: skip
    units = sorted({name.load_unit for name in found.coordinates})
    rows = (
        (f"torque [{' or '.join(units)}]", found.torque, found.unsprung),
        ("power [W]", *found.power),
        ("energy [J]", None, None),
    )
    for i, (label, sprung, bare) in enumerate(rows):
        axes = figure.add_axes((0.1, 0.68 - 0.305 * i, 0.68, 0.25))
        if sprung is None or bare is None:
            series = {"gravity": found.gravity, "springs": found.springs, "both": found.gravity + found.springs,
                      "kinetic": found.kinetic}  # fmt: skip
            for colour, (name, values) in zip(_colours(len(series)), series.items(), strict=True):
                axes.plot(found.time, values, color=colour, label=name, linewidth=2)
        else:
            _joints(axes, found, sprung, bare)
        axes.set_ylabel(label, color=style.INK)
        axes.grid(color=style.GRID)
        axes.margins(x=0)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=10)
        if i == len(rows) - 1:
            axes.set_xlabel("time [s]", color=style.INK)
    figure.text(
        0.02, 0.015, "from MuJoCo; potential energies are counted from the start", fontsize=10, color=style.FAINT
    )


def _joints(axes: Any, found: Playback, sprung: Array, bare: Array) -> None:
    most = np.maximum(np.abs(sprung), np.abs(bare)).max(axis=0)
    shown = np.flatnonzero(most > 1e-3 * (most.max(initial=0.0) or 1.0)).tolist()
    for colour, j in zip(_colours(len(shown)), shown, strict=True):
        axes.plot(found.time, bare[:, j], color=colour, linewidth=1, linestyle="--")
        axes.plot(found.time, sprung[:, j], color=colour, linewidth=2, label=found.coordinates[j])


def _colours(count: int) -> list[str]:
    every = [*style.SPRINGS, style.BEFORE, style.AFTER]
    return [every[i % len(every)] for i in range(count)]
