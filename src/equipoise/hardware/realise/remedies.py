"""What would help where no spring can be made: one demand after the other is let go, and what works then is said."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf

from ...balance import Balance
from ..sizing.wire import MM, WIRES
from .realisations import Options, Realisation, rank, realisations

MANY = 4  # times as many springs side by side


def remedies(balance: Balance, i: int, options: Options, kind: str | None) -> tuple[str, ...]:
    """For spring `i` of a judged design, which cannot be made: what alone would make it possible."""
    found = []
    for text, changed in _changes(options):
        way = best(balance, i, changed, kind)
        if way.works:
            found.append(text.format(**_words(way)))
    if not found:
        longest = balance.use[i].max_length / MM
        found.append(
            "attachments that do not come near each other and are farther from the joints, which need less force; now "
            f"they are {balance.use[i].min_length / MM:.1f} to {longest:.1f} mm apart"
        )
    return tuple(found)


def best(balance: Balance, i: int, options: Options, kind: str | None) -> Realisation:
    """The best way to make spring `i`, of a kind where one is asked for."""
    ways = [way for way in realisations(balance, i, options) if kind is None or way.kind == kind]
    return min(ways, key=rank)


def _changes(options: Options) -> Iterator[tuple[str, Options]]:
    room, limits = options.envelope, options.limits
    if room.outer < inf:
        yield "an outer diameter of {outer:.1f} mm (--outer)", replace(options, envelope=replace(room, outer=inf))
    if room.length < inf:
        yield "a greater length in use (--length)", replace(options, envelope=replace(room, length=inf))
    yield "{count} springs side by side (--most {count})", replace(options, most=MANY * options.most)
    if WIRES["DH"] not in options.wires:
        yield "stronger wire (--wire DH)", replace(options, wires=(*options.wires, WIRES["DH"]))
    if limits.fatigue:
        text = f"no margin against fatigue (--fatigue 0): it need not last for {limits.cycles:g} cycles then"
        yield text, replace(options, limits=replace(limits, fatigue=0.0))
    if limits.safety > 1:
        yield "a static margin of 1 (--safety 1)", replace(options, limits=replace(limits, safety=1.0))


def _words(way: Realisation) -> dict[str, float]:
    return {"outer": way.winding.spring.outer / MM, "count": way.winding.count}
