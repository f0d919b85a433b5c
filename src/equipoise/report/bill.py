"""A bill of materials and a choice from stock, as text for a terminal and as a table for a spreadsheet."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from io import StringIO

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..balance import Balance
from ..hardware.realise.bill import Bill, way_dict
from ..hardware.realise.realisations import FRICTION
from ..hardware.sizing.extension import ExtensionSpring
from ..hardware.sizing.wire import MM
from ..hardware.stock.selection import Selection
from ..model.elements import lines

# what the spreadsheet holds of each chosen spring, in the order of its columns; all in SI units
COLUMNS = (
    "kind", "spring", "count", "wire", "wire_diameter", "coil_diameter", "outer_diameter", "coils", "rate",
    "free_length", "initial_tension", "solid_length", "max_force", "static_margin", "hook_margin",
    "fatigue_margin", "natural_frequency", "mass", "case_behind", "left_over", "friction", "residual_share",
)  # fmt: skip


def bill_lines(bill: Bill) -> Iterator[RenderableType]:
    """The table of springs, for each spring the ways to make it, and what is left when all is built."""
    yield Text(f"{bill.balance.mechanism.name}: bill of materials", style="bold")
    yield _table(bill)
    for number, item in enumerate(bill.items, start=1):
        use = item.use
        lengths = f"{use.min_length / MM:.1f} to {use.max_length / MM:.1f} mm, up to {use.max_force:.4g} N"
        yield Text(f"{number}  {item.spring.name}: {item.spring.stiffness:.5g} N/m, {lengths}", style="bold")
        for way in item.ways:
            if not way.works:
                yield Text(f"   {way.kind:<10} no: {way.reason}")
                continue
            left = f"leaves {_percent(way.share or 0.0)} of the unbalanced torque"
            free = max(getattr(way.stretch, "free_length", 0.0) - item.spring.free_length, 0.0)
            more = f", free length {free / MM:.1f} mm" if free > 0 else ""
            behind = f", case {way.behind / MM:.0f} mm behind A" if way.behind else ""
            count = f"{way.winding.count} x " if way.winding.count > 1 else ""
            mass = f"{count}{1000 * way.winding.spring.mass:.4g} g"
            yield Text(
                f"   {way.kind:<10} {left}{more}, friction {_percent(way.friction)} of the force, {mass}{behind}"
            )
    yield from _built(bill)


def _table(bill: Bill) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("")
    table.add_column("made as")
    for title in ("off", "wire", "d", "De", "coils", "L0", "F0", "Fmax", "static", "loops", "fatigue", "mass"):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_row("", "", "", "", "mm", "mm", "", "mm", "N", "N", "margin", "margin", "margin", "g")
    for number, item in enumerate(bill.items, start=1):
        way = item.chosen
        if way is None:
            table.add_row(str(number), Text("cannot be made", style="yellow"))
            continue
        s, row = way.winding.spring, way_dict(item, way, bill.options.limits)
        table.add_row(
            str(number),
            way.kind,
            str(way.winding.count),
            s.wire.name,
            f"{s.d / MM:.3g}",
            f"{s.outer / MM:.4g}",
            f"{s.n:.4g}",
            f"{s.free_length / MM:.4g}",
            f"{s.initial_tension:.3g}" if isinstance(s, ExtensionSpring) else "-",
            f"{row['max_force']:.4g}",
            f"{row['static_margin']:.2f}",
            "-" if row["hook_margin"] is None else f"{row['hook_margin']:.2f}",
            f"{row['fatigue_margin']:.2f}",
            f"{1000 * s.mass:.4g}",
        )
    return table


def _built(bill: Bill) -> Iterator[Text]:
    if bill.left is None:
        missing = ", ".join(item.spring.name for item in bill.items if not item.chosen)
        yield Text(f"INCOMPLETE: no way to make {missing} within the given limits", style="bold yellow")
        yield from (Text(f"  {text}", style="yellow") for text in bill.warnings)
        return
    yield Text(f"springs: {1000 * bill.mass:.4g} g in all")
    parts = []
    for i, name in enumerate(bill.balance.coordinates):
        residual, friction = bill.left.residual[i], bill.left.friction[i]
        parts.append(f"{name} {residual:.3g} + {friction:.3g} {name.load_unit}")
    yield Text(f"as built, masses included: {_percent(bill.left.share)} of the unbalanced peak", style="bold")
    yield Text(f"  residual + friction of the springs at most: {', '.join(parts)}")
    shares = ", ".join(f"{kind} {_percent(share)}" for kind, share in bill.options.friction.items())
    assumed = "assumed, not measured" if dict(bill.options.friction) == FRICTION else "as given"
    yield Text(f"  friction, share of each spring's force, {assumed}: {shares}")
    yield from (Text(f"  warning: {text}", style="yellow") for text in bill.warnings)


def bill_csv(bill: Bill) -> str:
    """The chosen springs as CSV, in SI units; a spring that cannot be made has only its name and the reason."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["name", *COLUMNS, "reason"])
    for item in bill.items:
        row = way_dict(item, item.ways[0], bill.options.limits) if item.chosen else {}
        values = [row.get(name) for name in COLUMNS]
        writer.writerow([item.spring.name, *values, "" if item.chosen else item.ways[0].reason])
    return text.getvalue()


def choice_lines(choice: Selection, before: Balance, after: Balance) -> Iterator[RenderableType]:
    """Which stock springs were taken, where their attachments moved, and the proof."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("spring")
    table.add_column("part")
    for title in ("rate [N/m]", "was", "Fmax [N]", "allowed", "A moved [mm]", "B moved [mm]", "mass [g]", "price"):
        table.add_column(title, justify="right", no_wrap=True)
    both = (lines(mechanism, "stock") for mechanism in (before.mechanism, choice.mechanism))
    for old, new, stock, use in zip(*both, choice.stock, after.use, strict=True):
        moved = [_distance(getattr(old, p), getattr(new, p)) for p in ("p_a", "p_b")]
        table.add_row(
            Text(new.name),
            Text(stock.part),
            f"{stock.rate:.5g}",
            f"{old.stiffness:.5g}",
            f"{use.max_force:.4g}",
            f"{stock.max_force:.4g}",
            *(f"{value / MM:.1f}" for value in moved),
            f"{1000 * stock.mass:.4g}",
            f"{stock.price:.2f}",
        )
    yield table
    unit = "kg" if choice.goal == "mass" else ""
    proof = "PROVEN the least" if choice.proven else f"not proven, gap {_percent(choice.gap)}"
    bound = f"{choice.goal} {choice.cost:.6g} {unit}".rstrip() + f", no set has less than {choice.bound:.6g}"
    looked = f"{choice.settled} set{'' if choice.settled == 1 else 's'} looked at"
    yield Text(f"{proof}: {bound}; {looked}, {choice.unsettled} unsettled", style="bold")


def _distance(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    return sum((x - y) ** 2 for x, y in zip(a, b, strict=True)) ** 0.5


def _percent(share: float) -> str:
    return "0 %" if share < 1e-10 else f"{100 * share:.3g} %"
