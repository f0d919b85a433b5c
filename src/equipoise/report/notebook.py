"""Designs and verdicts as a notebook shows them: the verdict, the schematic, springs and torques. Needs no extra."""

from __future__ import annotations

from functools import singledispatch
from html import escape
from zlib import crc32

from ..balance import Balance
from ..synthesis import Design
from .page import design as sections
from .page.html import block
from .page.pictures import scheme
from .schematic import schematic
from .text import percent, verdict


@singledispatch
def html(value: object) -> str:
    """The value as a piece of HTML."""
    raise TypeError(f"{type(value).__name__} does not show itself")


@html.register
def _(value: Balance) -> str:
    key = f"scheme-{crc32(repr(value.mechanism).encode()):08x}"  # a notebook shows many
    tables = sections.springs_tables(value)
    tables += [sections.torque_table(value)] if value.coordinates else []
    parts = [
        f"<p><strong>{escape(value.mechanism.name)}</strong>: {escape(verdict(value).plain)}</p>",
        f'<div style="max-width: 36em">{scheme(value, key).svg}</div>',
        *(block(table) for table in tables),
    ]
    return f"<div>{''.join(parts)}</div>"


@html.register
def _(value: Design) -> str:
    gap = "no bound is known" if value.certified_gap is None else f"within {percent(value.certified_gap)} of the best"
    return (
        f"<p>method {escape(value.method)}, objective {escape(value.objective)} torque: {gap}</p>{html(value.balance)}"
    )


def svg(value: Balance | Design) -> str:
    """The schematic of the value's mechanism."""
    return schematic(value.mechanism).svg()
