"""The order list: every spring, weight and the parts it is installed with, one line each, also as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from io import StringIO
from math import degrees, isfinite

from ..balance import Balance
from ..energy.spring_use import SpringUse
from ..hardware.realise.bill import Bill, BillItem, bill
from ..hardware.realise.realisations import Realisation
from ..hardware.sizing.extension import ExtensionSpring
from ..hardware.sizing.wire import MM
from ..io import Source, loaded
from ..model.elements import Element
from ..model.errors import EquipoiseError

INSTALLED = {"pulley": "pulley and cable", "eyelet": "eyelet and cable", "rod": "guide rod"}
"""Kind of realisation -> what it takes beside the spring."""


@dataclass(frozen=True)
class Line:
    """A line of the list.

    Attributes:
        use: what it is for: the spring's or weight's name.
        part: its number in a list of parts; empty where it is made to the data.
        mass: of one [kg].  price: of one, in the currency of the list of parts; None where it is not known.
    """

    position: int
    use: str
    item: str
    quantity: int
    part: str
    data: str
    mass: float | None
    price: float | None


def order(balance: Balance, made: Bill | None) -> list[Line]:
    """The lines for a judged mechanism; `made` says what springs are wound, where that is known."""
    items = {item.spring.name: item for item in made.items} if made is not None else {}
    found: list[Line] = []
    for spring, use in zip(balance.mechanism.springs, balance.use, strict=True):
        for line in _spring(spring, use, items.get(spring.name)):
            found.append(Line(len(found) + 1, spring.name, *line))
    for mass in balance.mechanism.masses:
        found.append(Line(len(found) + 1, mass.name, "weight", 1, "", f"{mass.mass:.4g} kg", mass.mass, None))
    return found


Rest = tuple[str, int, str, str, float | None, float | None]


def _spring(spring: Element, use: SpringUse, item: BillItem | None) -> Iterator[Rest]:
    part, price = getattr(spring, "part", "") or "", getattr(spring, "price", None)
    way = item.chosen if item is not None else None
    if part or way is None:
        noun = spring.noun.split(" ", 1)[1]
        unit = ("mm", 1e3) if spring.path_unit == "m" else ("deg", degrees(1))
        low, high = (f"{unit[1] * value:.4g}" for value in use.path)
        strength, of = spring.strength
        free = "" if spring.free is None else f", relaxed at {unit[1] * spring.free:.4g} {unit[0]}"
        data = f"{strength:.5g} {of}{free}; used from {low} to {high} {unit[0]}, "
        data += f"up to {max(map(abs, use.force)):.4g} {spring.force_unit}"
        if item is not None and way is None and not part:
            data += f"; {item.hopeless}"
        mass = getattr(spring, "mass", 0.0) or None
        yield noun, 1, part, data, mass, price
        return
    yield _wound(way)
    if way.kind in INSTALLED:
        yield INSTALLED[way.kind], 1, "", f"for {max(map(abs, use.force)):.4g} N", None, None


def _wound(way: Realisation) -> Rest:
    s = way.winding.spring
    extension = isinstance(s, ExtensionSpring)
    data = f"{s.wire.standard} {s.wire.name}, d {s.d / MM:.3g} mm, De {s.outer / MM:.4g} mm, {s.n:.4g} active coils, "
    data += f"L0 {s.free_length / MM:.4g} mm, R {s.rate / 1000:.4g} N/mm"
    if isinstance(s, ExtensionSpring):
        data += f", F0 {s.initial_tension:.3g} N"
    noun = f"{'extension' if extension else 'compression'} spring, wound to data ({way.kind})"
    return noun, way.winding.count, "", data, s.mass, None


def order_csv(lines: list[Line]) -> str:
    """The list as CSV, in SI units; what is not known is empty."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [field.name for field in fields(Line)]
    writer.writerow([{"use": "for", "mass": "mass_each [kg]", "price": "price_each"}.get(name, name) for name in names])
    for line in lines:
        row = asdict(line)
        writer.writerow(["" if row[name] is None else _value(row[name]) for name in names])
    return text.getvalue()


def _value(value: str | float) -> str:
    if isinstance(value, str):  # what a spreadsheet would work out as a formula is text
        return f"'{value}" if value.startswith(("=", "+", "-", "@")) else value
    return f"{value:.6g}" if isfinite(value) else ""


def to_text(mechanism: Source) -> str:
    """The order list of a mechanism as CSV: springs to wind, where `hardware` serves them all."""
    from ..balance import check

    balance = check(loaded(mechanism))
    return order_csv(order(balance, wound(balance)))


def wound(balance: Balance) -> Bill | None:
    """The springs to wind, None where the mechanism does not allow that."""
    try:
        return bill(balance)
    except EquipoiseError:
        return None
