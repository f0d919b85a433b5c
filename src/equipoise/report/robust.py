"""What scatter does to a design, as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf

import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..model.arrays import vec3
from ..model.elements.along_line import millimetres
from ..robust import Adjustment, Sweep, Tolerance
from ..robust.arcs import Locked
from ..robust.moves import Way
from .numbers import pose
from .style import number

SMALL = 0.01  # of the largest: joints with less are not listed
LISTED = 8  # parameters that are named


def tolerance_lines(found: Tolerance) -> Iterator[RenderableType]:
    """Yield, peaks and margins per coordinate, and what matters most."""
    builds, s = len(found.peak), found.scatter
    yield Text(f"{found.mechanism.name}: {builds:,} builds, each at {found.poses:,} poses", style="bold")
    what = "limits (+-)" if s.shape == "uniform" else "standard deviations"
    yield Text(
        f"{s.shape} scatter, {what}: stiffness {100 * s.stiffness:.3g} %, attachments {1e3 * s.attachment:.3g} mm, "
        f"masses {100 * s.mass:.3g} %, lengths {1e3 * s.length:.3g} mm"
    )
    if found.friction:
        late = [
            f"{name} needs {number(float(most))} and has {number(found.friction[name])} {name.load_unit}"
            for name, most in zip(found.coordinates, found.nominal, strict=True)
            if name in found.friction and most > found.friction[name]
        ]
        answer = (
            "AS DRAWN: friction holds every pose"
            if not late
            else f"AS DRAWN: friction is too little: {'; '.join(late)}"
        )
        yield Text(answer, style="bold" if not late else "bold yellow")
    if found.yield_ is not None:
        style = "bold green" if found.yield_ >= 0.95 else "bold yellow"
        yield Text(f"YIELD: {100 * found.yield_:.4g} % of builds hold every pose within friction", style=style)
    yield _table(found)
    yield Text(f"spread of the torque over the poses: {found.agreement:.4g} of first-order propagation", style="dim")
    kinds = ", ".join(f"{kind} {100 * share:.3g} %" for kind, share in found.by_kind.items())
    yield Text(f"what causes the mean square torque (first-order Sobol indices): {kinds}")
    for parameter, share in found.ranked[:LISTED]:
        yield Text(f"  {100 * share:5.1f} %  {parameter.name}")


def sweep_table(found: Sweep) -> Table:
    """Peak residual torque of every coordinate at every payload."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("payload", justify="right")
    first = found.balances[0]
    for coordinate in first.coordinates:
        table.add_column(Text(f"{coordinate} [{coordinate.load_unit}]"), justify="right")
    for mass, balance in zip(found.payloads, found.balances, strict=True):
        floor = 1e-10 * float(balance.unbalanced.max.max(initial=0))
        table.add_row(f"{mass:.4g} kg", *(number(float(v) if v > floor else 0.0) for v in balance.residual.max))
    return table


def adjustment_lines(found: Adjustment) -> Iterator[RenderableType]:
    """What to move, what each move alone would leave, and the best fixed design."""
    best, (low, high) = found.best, found.payload.span
    answer = (
        "EXACT at both ends" if found.exact else "KEEPS THE BALANCE" if found.keeps else "DOES NOT KEEP THE BALANCE"
    )
    style = "bold green" if found.exact or found.keeps else "bold yellow"
    share = 0.0 if best.share < 1e-9 else best.share
    yield Text(f"{answer}: {100 * share:.3g} % of what the payload does is left", style=style)
    yield Text(f"from {low:.4g} kg to {high:.4g} kg on {found.payload.link}, move:")
    yield _moves([best])
    if found.reach is not None:
        yield Text(
            f"no sliding end does it: springs between these bodies, no further out, leave at least {found.reach:.4g} "
            f"N m rms at {high:.4g} kg, whatever their stiffness",
        )
    if found.travel < inf:
        yield Text(f"no end moved by more than {1e3 * found.travel:.4g} mm", style="dim")
    if found.locked is not None:
        yield from _without_energy(found, found.locked)
    yield Text("the largest residual [N m, slides N] over random poses, as the design is -> so adjusted")
    yield _steps(found)
    good = [way for way in found.ways if way.share < found.unmoved * (1 - 1e-3)]
    yield Text("each on its own, as far as it does any good:" if good else "no end does any good on its own")
    if good:
        yield _moves(good)
    yield Text("fixed, set for the middle: the largest residual, and the least that any fixed springs leave")
    table = Table(box=None, pad_edge=False, header_style="dim")
    for title in ("joint", "fixed", "least", "unit"):
        table.add_column(title, justify="left" if title == "joint" else "right", no_wrap=True)
    balance = found.ends[0]
    floor = 1e-10 * float(found.ends[1].unbalanced.max.max(initial=0))
    for coordinate, left, least in zip(balance.coordinates, found.left, found.bound, strict=True):
        cells = (number(float(value) if value > floor else 0.0) for value in (left, least))
        table.add_row(Text(coordinate), *cells, coordinate.load_unit)
    yield table


def _without_energy(found: Adjustment, locked: Locked) -> Iterator[Text]:
    """Where to lock the joints, and how the ends slide then."""
    yield Text(f"without energy: lock it at {pose(found.ends[0].coordinates, locked.configuration)} and slide")
    for arc in locked.arcs:
        yield Text(
            f"  {arc.what} of {arc.spring} on {arc.body}, along an arc of radius {1e3 * arc.radius:.1f} mm about "
            f"{millimetres(vec3(arc.centre))} mm: the spring keeps its length"
        )


def _steps(found: Adjustment) -> Table:
    """What is left at each joint at payloads of the range."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    coordinates = found.ends[0].coordinates
    most = max(float(one.unmoved.max(initial=0.0)) for one in found.steps)
    floor = 1e-9 * most
    some = [j for j in range(len(coordinates)) if max(one.unmoved[j] for one in found.steps) > SMALL * most]
    table.add_column("payload", justify="right")
    for j in some:
        table.add_column(Text(coordinates[j]), justify="right")
    table.add_column("exact")
    for one in found.steps:
        cells = (
            " -> ".join(number(float(t[j]) if t[j] > floor else 0.0) for t in (one.unmoved, one.moved)) for j in some
        )
        table.add_row(f"{one.payload:.4g} kg", *cells, "proved" if one.exact else "")
    return table


def _moves(ways: Iterable[Way]) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    titles = ("spring", "what", "from [mm]", "to [mm]", "travel [mm]", "left [%]", "energy [J]")
    for title in titles:
        table.add_column(Text(title), justify="left" if title in titles[:2] else "right")
    for way in ways:
        for i, move in enumerate(way.moves):
            places = [", ".join(f"{round(1e3 * value, 1) + 0.0:.1f}" for value in p) for p in (move.low, move.high)]
            share = 0.0 if way.share < 1e-9 else way.share
            whole = (f"{100 * share:.3g}", f"{way.work[0]:.3g} to {way.work[1]:.3g}") if i == 0 else ("", "")
            table.add_row(Text(move.spring), move.what, *places, f"{1e3 * move.travel:.1f}", *whole)
    return table


def _table(found: Tolerance) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("joint", no_wrap=True)
    for title in ("peak as drawn", "mean", "spread", "95 % below", "99 % below", "friction", "margin 5 %", "unit"):
        table.add_column(title, justify="right", no_wrap=True)
    p95, p99 = np.percentile(found.peak, (95, 99), axis=0)
    order = list(found.friction)
    for j, name in enumerate(found.coordinates):
        peak = found.peak[:, j]
        drawn = found.nominal[j] if found.nominal[j] > 1e-9 * p95.max(initial=0) else 0.0
        held = ["-", "-"]
        if name in found.friction:
            least = float(np.percentile(found.margin[:, order.index(name)], 5))
            held = [number(found.friction[name]), f"{'-' if least < 0 else ''}{number(abs(least))}"]
        cells = [number(float(v)) for v in (drawn, peak.mean(), peak.std(), p95[j], p99[j])]
        table.add_row(Text(name), *cells, *held, name.load_unit)
    return table
