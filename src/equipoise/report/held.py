"""The springs of a mechanism that are real already, as text for a terminal and as a table for a spreadsheet."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from io import StringIO

from rich.text import Text

from ..hardware.realise.held import Held, Kit
from .verdict import verdict

COLUMNS = (
    "name",
    "kind",
    "part",
    "realisation",
    "order",
    "least",
    "most",
    "unit",
    "static",
    "fatigue",
    "notes",
    "faults",
)


def kit_lines(kit: Kit) -> Iterator[Text]:
    """What to order or wind for each spring, its margins, what else there is to know, and what is left."""
    limits = kit.options.limits
    yield Text(f"{kit.balance.mechanism.name}: bill of materials", style="bold")
    for item in kit.items:
        built = f", built in: {item.realisation}" if item.realisation else ""
        yield Text(f"{item.name}: {item.order or item.kind}{built}", style="bold")
        yield Text(f"  {item.kind}, {margins(item)}")
        yield from (Text(f"  {note}") for note in item.notes)
    yield verdict(kit.balance)
    asked = f"asked for: a static margin of {limits.safety:g}"
    yield Text(
        asked + (f", a fatigue margin of {limits.fatigue:g} at {limits.cycles:g} cycles" if limits.fatigue else "")
    )
    yield from (Text(f"  warning: {text}", style="yellow") for text in kit.warnings)


def margins(item: Held) -> str:
    """Forces in use and what they leave in reserve."""
    text = f"{item.force[0]:.4g} to {item.force[1]:.4g} {item.unit}"
    for name, value in (("static", item.static), ("fatigue", item.fatigue)):
        text += f", {name} margin {'not judged' if value is None else f'{value:.2f}'}"
    return text


def kit_csv(kit: Kit) -> str:
    """One row for each spring."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for item in kit.items:
        row = {**vars(item), "least": item.force[0], "most": item.force[1]}
        row |= {"notes": "; ".join(item.notes), "faults": "; ".join(item.faults)}
        writer.writerow([row[name] for name in COLUMNS])
    return text.getvalue()
