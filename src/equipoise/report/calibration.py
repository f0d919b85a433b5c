"""A calibration, for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..synthesis.calibrate.calibrate import Calibration, Change
from .numbers import pose as at
from .style import number

UNITS = {
    "stiffness": (1.0, "N/m"), "free_length": (1e3, "mm"), "rest": (float(np.degrees(1)), "deg"), "force": (1.0, "N"),
    "initial_tension": (1.0, "N"), "torque": (1.0, "N m"), "progression": (1.0, ""), "mass": (1.0, "kg"),
}  # fmt: skip
FEW = 12  # poses that are listed


def calibration_lines(found: Calibration) -> Iterator[RenderableType]:
    """What is left and why not less, what to set, and the torque at each pose before and after."""
    where = "at the poses given" if found.given else f"over {len(found.poses):,} poses of the whole workspace"
    if found.exact:
        yield Text(f"BALANCED {where}", style="bold green")
    elif not found.proofs:
        yield Text(f"NEARLY BALANCED {where}", style="bold yellow")
    for proof in found.proofs:
        what = "torque" if proof.unit == "N m" else "force of a slide"
        yield Text(
            f"Impossible: at least {proof.least:.7g} {proof.unit} is left {where}, as the largest {what}; "
            f"these settings leave {found.largest(proof.unit):.7g} {proof.unit}",
            style="bold yellow",
        )
        terms = " ".join(
            f"{'-' if w < 0 else '+'} {abs(w):.4g} {name} ({_pose(found, i)})" for name, i, w in proof.terms
        )
        yield Text(f"  proof: whatever is set, this mean of torques is never less: {terms.removeprefix('+ ')}")
    yield _changes(found)
    for name in found.unused:
        yield Text(f"  {name} does no good here: it is left out")
    if found.held:
        yield Text(f"  as they were: {', '.join(found.held)}")
    if found.given:
        yield _torques(found)


def _pose(found: Calibration, i: int) -> str:
    return f"pose {i + 1}" if found.given else at(found.coordinates, found.poses[i])


def _changes(found: Calibration) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    for title in ("set", "number", "from", "to", "within", "unit"):
        table.add_column(title, justify="left" if title in ("set", "number", "unit") else "right", no_wrap=True)
    turning = {e.name for e in found.mechanism.springs if e.path_unit == "rad"}
    for change in found.changes:
        factor, unit = UNITS[change.field]
        unit = "N m/rad" if change.field == "stiffness" and change.item in turning else unit
        cells = (f"{round(factor * value, 9):.6g}" for value in (change.before, change.after))
        table.add_row(Text(change.item), change.field, *cells, _within(change, factor), unit)
    return table


def _within(change: Change, factor: float) -> str:
    low, high = (f"{factor * limit:.5g}" for limit in change.limits)
    return low if low == high else f"{low} to {high}"


def _torques(found: Calibration) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("pose", no_wrap=True)
    for title in ("joint", "at", "before", "after", "unit"):
        table.add_column(title, justify="left" if title in ("joint", "unit") else "right", no_wrap=True)
    floor = 1e-9 * max(1.0, float(np.abs(found.before).max(initial=0.0)))
    for i, (q, before, after) in enumerate(zip(found.poses[:FEW], found.before, found.after, strict=False), 1):
        for j, name in enumerate(found.coordinates):
            left = [f"< {floor:.0e}" if 0 < abs(t[j]) < floor else number(float(t[j])) for t in (before, after)]
            table.add_row(
                str(i) if j == 0 else "", Text(name), name.show(q[j]).removeprefix(f"{name} "), *left, name.load_unit
            )
    return table
