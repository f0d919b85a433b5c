"""A choice of parts as text for a terminal: what to order, how it is built in, how hard it works, and what is left."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, inf

from rich.console import RenderableType
from rich.text import Text

from ..hardware.choose.chosen import Chosen
from ..hardware.sizing.limits import Limits
from ..hardware.sizing.wire import MM
from ..hardware.stock.part import Stock, endurance
from ..model.elements import Element
from ..model.elements.laws import Extension
from .numbers import percent
from .verdict import verdict


def chosen_lines(found: Chosen) -> Iterator[RenderableType]:
    """The parts, each whole on lines of its own, and how good they are."""
    yield Text(f"{found.mechanism.name}: {len(found.parts)} of {found.offered:,} parts that fit", style="bold")
    springs = found.mechanism.springs[-len(found.parts) :]
    used = found.balance.use[-len(found.parts) :]
    for spring, use, part in zip(springs, used, found.parts, strict=True):
        if part.kind == "torsion":
            yield from _coil(spring, use.path, use.force, part)
            continue
        own = spring.law
        cable = own.cable if isinstance(own, Extension) else 0.0
        low, high = (length - cable for length in use.path)
        yield Text(f"{spring.name}: part {part.part}, {part.kind}, built in: {spring.realisation}", style="bold")
        yield Text(
            f"  {part.rate:.5g} N/m, L0 {part.free_length / MM:.4g} mm, F0 {part.initial_tension:.3g} N, "
            f"De {part.outer_diameter / MM:.4g} mm, d {part.wire_diameter / MM:.3g} mm, {1000 * part.mass:.4g} g, "
            f"price {part.price:.2f}"
        )
        for body, p in spring.ends:
            yield Text(f"  on {body} at ({', '.join(f'{1e3 * x:.1f}' for x in p)}) mm")
        yield Text(f"  in use {low / MM:.1f} to {high / MM:.1f} mm, {margins(spring, part, use.force, found.limits)}")
        yield from (Text(f"  behind {line}") for line in guides(spring))
    yield verdict(found.balance)
    if found.ideal is not None:
        yield Text(
            f"these parts leave {percent(found.left)} of the peak, springs of zero free length on the same pairs and "
            f"regions {percent(found.ideal)}: reality costs {percent(max(0.0, found.left - found.ideal))}"
        )
    yield Text(_proof(found), style="bold")


def _coil(spring: Element, path: tuple[float, float], force: tuple[float, float], part: Stock) -> Iterator[Text]:
    """A torsion spring on its joint."""
    most = max(map(abs, force))
    wound = sorted(degrees(abs(angle - spring.rest)) for angle in path)
    yield Text(f"{spring.name}: part {part.part}, torsion, on {spring.where}", style="bold")
    yield Text(f"  {part.torsional_rate:.5g} N m/rad, {1000 * part.mass:.4g} g, price {part.price:.2f}")
    yield Text(
        f"  relaxed at {degrees(spring.rest):.4g} deg, wound up by {wound[0]:.1f} to {wound[1]:.1f} deg, "
        f"{min(map(abs, force)):.4g} to {most:.4g} N m of {part.max_torque:.4g} N m: static margin "
        f"{part.max_torque / most:.2f}, fatigue not judged"
    )


def _proof(found: Chosen) -> str:
    looked = f"{found.polished:,} times a part was moved into place, the first answer after {found.first:.1f} s"
    if found.left <= 1e-9:
        return f"PROVEN the best: nothing is left; {looked}"
    end = "every part that fits was tried" if found.complete else "the time was up"
    return f"gap {percent(found.gap)} of the peak: no springs can leave less than nothing; {end}, {looked}"


def guides(spring: Element) -> Iterator[str]:
    """The eyelet or pulley that its cable leaves over."""
    for guide in getattr(spring, "via", ()):
        what = f"pulley of {1e3 * guide.radius:g} mm radius" if hasattr(guide, "radius") else "eyelet"
        yield f"{what} on {guide.body} at ({', '.join(f'{1e3 * x:.1f}' for x in guide.point)}) mm"


def margins(spring: Element, part: Stock, force: tuple[float, float], limits: Limits) -> str:
    """Its forces in use, and the margins that they leave."""
    least, most = sorted(map(abs, force))
    text = f"{least:.4g} to {most:.4g} N"
    if part.kind == "gas":
        return text
    text += f" of {part.max_force:.4g} N: static margin {part.max_force / most:.2f}"
    top, bottom = endurance(part, limits)
    lasting = top * most - bottom * least
    fatigue = limits.fatigue / lasting if top else inf
    return text + (f", fatigue margin {fatigue:.2f} at {limits.cycles:g} cycles" if top else ", fatigue not judged")
