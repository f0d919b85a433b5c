"""A search for layouts as text: what balances, with springs, and how many candidates the rest was."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..synthesis.planar.arm import upward
from ..synthesis.planar.layouts import Feasible, LayoutSearch, labels, name, span

COSTS = {"springs": "springs", "span": "joints that springs span", "weighted": "weighted cost"}


def layout_lines(search: LayoutSearch, equations: str = "") -> Iterator[RenderableType]:
    """Every feasible layout of least cost with its springs, and the counts.

    Args:
        equations: "text" or "latex" for the design equations too.
    """
    for one in search.feasible:
        size = f"{len(one.layout)} springs that span {span(one.layout)} joints"
        proof = f"largest Fourier coefficient that varies {one.balance.certificate.max_coefficient:.2g} J"
        yield Text(f"{name(one.layout)}: {size}; exact on {one.balance.mechanism.name} ({proof})", style="bold green")
        yield spring_table(one)
        if equations:
            yield Text(one.equations.latex() if equations == "latex" else str(one.equations))
        for objection in one.objections:
            yield Text(f"  though it {objection}: a criterion of the paper that is not necessary", style="dim")
    for line in count_lines(search):
        yield Text(line)


def spring_table(one: Feasible) -> Table:
    """Stiffness and attachments, as in Lee and Chen's Table 5 but for signs in the place of angles."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    for title in ("  spring", "k [N/m]", "a [mm]", "b [mm]"):
        table.add_column(Text(title), justify="right")
    for label, spring in zip(labels(one.layout), one.found.springs, strict=True):
        a, b = (spring.a / upward(spring.i)).real, spring.b.real
        table.add_row(label, f"{spring.stiffness:.5g}", f"{1e3 * a:.2f}", f"{1e3 * b:.2f}")
    return table


def count_lines(search: LayoutSearch) -> Iterator[str]:
    """How many candidates there were, what excluded them, and what that says of the minimum."""
    pruned = ", ".join(f"{key} {len(layouts)}" for key, layouts in search.pruned.items())
    total = sum(len(layouts) for layouts in search.pruned.values())
    yield (
        f"searched {search.candidates} layouts: {total} pruned by criteria{f' ({pruned})' if pruned else ''}, "
        f"{len(search.proved)} proved infeasible, {len(search.feasible)} feasible, {len(search.open)} open"
    )
    if search.feasible:
        least = f"least {COSTS[search.objective]}: {search.feasible[0].cost:g}"
        yield least if not search.open else f"{least}, unless an open layout has less: {_names(search.open)}"
    elif search.open:
        yield f"no layout was found feasible; open: {_names(search.open)}"
    else:
        yield "no layout is feasible"


def _names(layouts: tuple[tuple[tuple[int, int], ...], ...]) -> str:
    return "  ".join(name(layout) for layout in layouts)
