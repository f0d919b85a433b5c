"""The section for whoever builds it: what holds what, how strongly, what to order, what to heed, where to drill."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

from ..._version import __version__
from ...balance import Balance
from ...energy.spring_use import SpringUse
from ...hardware import Bill
from ...hardware.realise.held import Kit
from ...model.elements import Element
from ...model.mechanism import Mechanism
from ..body_sheet import body_drawings
from ..order import Line, order
from ..schematic import symbols
from ..text import reached
from .content import Block, Items, Number, Paragraph, Picture, Section, Table
from .pictures import inline

TITLE = "For the workshop"


def workshop_section(balance: Balance, made: Bill | Kit | str | None, date: str) -> Section:
    """One page in plain words; `made` are the springs to wind, as far as they are known."""
    m = balance.mechanism
    by = f"{m.name}: made with equipoise {__version__}{f' on {date}' * bool(date)}."
    if not m.springs and not m.masses:
        return Section(TITLE, (Paragraph(by), Paragraph("There is nothing to build: no springs and no weights.")))
    lines = order(balance, made if isinstance(made, Bill) else None)
    blocks: list[Block] = [Paragraph(by), Items(tuple(_held(balance)))]
    blocks += [Paragraph(text) for text in _forces(balance)]
    warnings = tuple(_warnings(balance, made))
    if warnings:
        blocks += [Paragraph("Heed this before it is built:", strong=True), Items(warnings)]
    blocks.append(_order(lines))
    more = (
        "'equipoise export --to order' writes this list as CSV, '--to sheet' and '--to sheet-dxf' the drawings below."
    )
    blocks.append(Paragraph(more))
    return Section(TITLE, (*blocks, *_drawings(m)))


def _drawings(mechanism: Mechanism) -> Iterator[Picture]:
    """Of each body, where to drill."""
    for i, (body, drawing) in enumerate(body_drawings(mechanism).items()):
        title = f"Attachment points on {body}"
        said = f"{title}: two views with the distance of each from the body's origin in mm, and a table of them"
        yield Picture(inline(drawing.svg(), f"drill-{i}", title, said), f"{title}, in mm from its origin", said)


def _held(balance: Balance) -> Iterator[str]:
    """What each spring and weight is fixed to, how long it gets and how strongly it acts."""
    m = balance.mechanism
    names = {letter: symbols(m, letter) for letter in "abk"}
    for i, (spring, use) in enumerate(zip(m.springs, balance.use, strict=True)):
        yield f"{names['k'][i]}, {spring.name}: {_where(spring, names['a'][i], names['b'][i])}; {_used(spring, use)}"
    for i, mass in enumerate(m.masses, start=1):
        yield f"m{i}, {mass.name}: {mass.mass:.4g} kg on {mass.body} at {_place(mass.position)}."


def _where(spring: Element, a: str, b: str) -> str:
    if not spring.ends:
        return f"{spring.noun} {spring.between}"
    (body_a, p_a), (body_b, p_b) = spring.ends
    through = f", through {len(spring.places) - 2} guides" if len(spring.places) > 2 else ""
    return f"{spring.noun} from {a} on {body_a} at {_place(p_a)} to {b} on {body_b} at {_place(p_b)}{through}"


def _used(spring: Element, use: SpringUse) -> str:
    factor, unit = (1e3, "mm") if spring.path_unit == "m" else (degrees(1), "deg")
    low, high = (f"{factor * value:.1f}" for value in use.path)
    size = f"{low} to {high} {unit}" + " long" * (unit == "mm")
    least, most = use.force
    if least >= 0 or most <= 0:
        does, least, most = ("pulls", least, most) if least >= 0 else ("pushes", -most, -least)
        return f"{size}, {does} with {least:.4g} to {most:.4g} {spring.force_unit}."
    return f"{size}, acts with {least:.4g} to {most:.4g} {spring.force_unit}."


def _forces(balance: Balance) -> Iterator[str]:
    """The strongest of each unit: what hooks, axles and bearings have to bear."""
    for unit in ("N", "N m"):
        every = [(max(map(abs, use.force)), spring.name)
                 for spring, use in zip(balance.mechanism.springs, balance.use, strict=True)
                 if spring.force_unit == unit]  # fmt: skip
        if every:
            most, name = max(every)
            what = "force" if unit == "N" else "torque"
            bears = "its hooks and axles have" if unit == "N" else "what it is fixed to has"
            yield f"The largest {what} of a spring is {most:.4g} {unit}, of {name}: {bears} to bear it."


def _warnings(balance: Balance, made: Bill | Kit | str | None) -> Iterator[str]:
    if isinstance(made, Bill):
        yield from made.warnings
    elif isinstance(made, str):
        yield f"No springs to wind were worked out: {made}"
    for spring, use in zip(balance.mechanism.springs, balance.use, strict=True):
        for one in use.reached:
            if one.state.limit:
                yield f"{spring.name}: {reached(one, spring.path_unit)}"


def _order(lines: list[Line]) -> Table:
    known = any(line.price is not None for line in lines)
    rows = []
    for line in lines:
        mass = "" if line.mass is None else Number(line.mass, f"{1e3 * line.mass:.4g}")
        price = "" if line.price is None else Number(line.price, f"{line.price:.2f}")
        row = (str(line.position), line.use, line.item, str(line.quantity), line.part or "–", line.data, mass, price)
        rows.append(row if known else row[:-1])
    head = ("pos.", "for", "item", "quantity", "part", "data", "mass each [g]", "price each")
    return Table.of("Order list", head if known else head[:-1], rows)


def _place(p: tuple[float, float, float]) -> str:
    return "(" + ", ".join(f"{round(1e3 * value, 2) + 0.0:g}" for value in p) + ") mm"
