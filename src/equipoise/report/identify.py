"""What a measurement tells of a build, as text for a terminal; and what is left, as a table for a controller."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..energy.evaluate import Potential
from ..kinematics import Tree
from ..kinematics.sampling import bounds, inside
from ..model.arrays import Array
from ..model.mechanism import Mechanism
from ..robust.identify import Identified, Value

NOTHING = 1e-9  # of any unit
ROWS = 10_000  # of the table, at most


def identify_lines(found: Identified) -> Iterator[RenderableType]:
    """The values with their intervals, what cannot be told apart, what to turn, and what is left then."""
    name = found.mechanism.name
    yield Text(f"{name}: held {found.measured[0]:.4g} at most, {found.measured[1]:.4g} rms", style="bold")
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("")
    for title in ("in the file", "found", "95 % interval", "", "change"):
        table.add_column(title, justify="right", no_wrap=True)
    for value in found.values:
        table.add_row(Text(value.name), _shown(value.nominal), *_cells(value))
    yield table
    yield Text(f"noise of the measurement: {found.noise:.3g} N m (standard deviation of what these values leave)")
    for group in found.alike:
        alone = f"{group[0]} cannot be told from these measurements: it does not act on what was measured"
        text = f"{' and '.join(group)} cannot be told apart: they do the same to the measured torques"
        yield Text(text if len(group) > 1 else alone, style="yellow")
    if found.alike:
        yield Text("  weigh or measure one of them and say --known NAME, or --known masses", style="yellow")
    for number, turn in enumerate(found.turns, start=1):
        yield Text(f"turn {number}: {turn}; leaves {turn.left:.3g} rms", style="bold green")
    if not found.turns:
        yield Text("nothing to turn: what is left is doubtful, or no screw leaves a tenth less", style="bold")
    for c, before, after in zip(Tree.of(found.mechanism).coordinates, found.before, found.after, strict=True):
        after_text = f", {after:.3g} after these turns" if found.turns else ""
        yield Text(f"  {c}: largest torque left {before:.3g}{after_text} {c.load_unit}")


def _shown(x: float) -> str:
    return f"{x:.5g}" if abs(x) > NOTHING else "0"


def _cells(value: Value) -> tuple[str, ...]:
    if not value.told:
        return "-", "cannot be told apart", value.unit, "-"
    change = value.found - value.nominal
    relative = value.nominal and not value.name.startswith("preload")
    share = f"{100 * change / value.nominal:+.1f} %" if relative else f"{change:+.3g}"
    return f"{value.found:.5g}", f"{value.low:.5g} to {value.high:.5g}", value.unit, share


def remaining_table(mechanism: Mechanism) -> str:
    """The holding torque that is left on a grid over the joint ranges, as CSV: what a controller adds."""
    tree = Tree.of(mechanism)
    q = _grid(tree)
    torque = Potential(mechanism)(q).torque
    head = [f"{c} [{c.unit}]" for c in tree.coordinates]
    head += [f"torque:{c} [{c.load_unit}]" for c in tree.coordinates]
    rows = [",".join(f"{value:.7g}" for value in row) for row in np.hstack([q, torque])]
    return "\n".join([",".join(head), *rows]) + "\n"


def _grid(tree: Tree) -> Array:
    """(N, n) as fine in every coordinate; poses outside a dependent joint's range are left out."""
    each = max(2, int(ROWS ** (1 / max(tree.n, 1)) + 1e-9))
    each = min(each, 181)
    lines = [np.linspace(low, high, each) for low, high in zip(*bounds(tree), strict=True)]
    q = np.array(list(product(*lines))).reshape(-1, tree.n)
    return q[inside(tree, q, 1e-9)]
