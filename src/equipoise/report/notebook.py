"""Designs and verdicts as a notebook shows them: the verdict, the schematic, springs and torques. Needs no extra."""

from __future__ import annotations

from html import escape
from zlib import crc32

from ..balance import Balance
from ..model.notebook import register
from ..synthesis import Design
from .numbers import percent
from .page import design as sections
from .page.html import block
from .page.pictures import scheme
from .schematic import schematic
from .verdict import verdict


def balance_html(value: Balance) -> str:
    """The verdict, the picture and the tables."""
    key = f"scheme-{crc32(repr(value.mechanism).encode()):08x}"  # a notebook shows many
    tables = sections.springs_tables(value)
    tables += [sections.torque_table(value)] if value.coordinates else []
    parts = [
        f"<p><strong>{escape(value.mechanism.name)}</strong>: {escape(verdict(value).plain)}</p>",
        f'<div style="max-width: 36em">{scheme(value, key).svg}</div>',
        *(block(table) for table in tables),
    ]
    return f"<div>{''.join(parts)}</div>"


def design_html(value: Design) -> str:
    """How far from the best it is, and its balance."""
    gap = "no bound is known" if value.certified_gap is None else f"within {percent(value.certified_gap)} of the best"
    return (
        f"<p>method {escape(value.method)}, objective {escape(value.objective)} torque: {gap}</p>"
        f"{balance_html(value.balance)}"
    )


def svg(value: Balance | Design) -> str:
    """The schematic of the value's mechanism."""
    return schematic(value.mechanism).svg()


register(Balance, html=balance_html, svg=svg)
register(Design, html=design_html, svg=svg)
