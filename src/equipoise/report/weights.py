"""The counterweights of a design, for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..model.elements.along_line import millimetres
from ..synthesis.counterweights import Counterweights


def weight_lines(found: Counterweights, unbalanced: float) -> Iterator[RenderableType]:
    """How much they weigh, how much less any others could, where they are, and mass against residual if asked for.

    Args:
        unbalanced: [N m] rms torque without weights and springs.
    """
    left = f"leave at most {100 * found.residual / unbalanced:.4g} %" if found.residual else "balance exactly"
    if found.weights:
        yield Text(
            f"  weights     {kilograms(found.mass)} in all; bound {kilograms(found.bound)}: no weights of less {left}, "
            "whatever the springs on these pairs and regions"
        )
    else:
        yield Text(f"  weights     none: springs alone {left}")
    for weight in found.weights:
        yield Text(f"  {weight.name}: {kilograms(weight.mass)} on {weight.body} at {millimetres(weight.position)} mm")
    if found.front:
        yield _front(found, unbalanced)


def _front(found: Counterweights, unbalanced: float) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    for title in ("residual [N m]", "of unbalanced", "mass [kg]", "bound [kg]"):
        table.add_column(title, justify="right", no_wrap=True)
    for row in found.front:
        share = f"{100 * row.residual / unbalanced:.4g} %" if row.residual else "exact"
        table.add_row(f"{row.residual:.4f}", share, f"{row.mass:.4f}", f"{row.bound:.4f}")
    return table


def kilograms(mass: float) -> str:
    """A mass in the unit that suits it."""
    return f"{mass:.4g} kg" if mass >= 1 else f"{1e3 * mass:.4g} g"
