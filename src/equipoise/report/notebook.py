"""How results show themselves: printed as on the command line; in a notebook with schematic and tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from html import escape
from io import StringIO
from typing import Any
from zlib import crc32

from rich.console import Console, RenderableType

from ..balance import Balance
from ..hardware import Bill
from ..model.notebook import register
from ..proof.certificate import Certified
from ..reproduce import Reproduction
from ..robust import Adjustment, Identified, Sweep, Tolerance
from ..simulate import Playback, Release
from ..study.compare import Comparison
from ..synthesis import Design
from ..synthesis.planar.layouts import LayoutSearch
from . import bill, certificate, compare, identify, layouts, published, robust, simulation, text
from .numbers import percent
from .page import design as sections
from .page.html import block
from .page.pictures import scheme
from .schematic import schematic
from .verdict import verdict

COLUMNS = 120  # of a result that is printed


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


def printed(lines: Callable[[Any], Iterable[RenderableType]]) -> Callable[[Any], str]:
    """What the command line prints of a value, without colours."""

    def draw(value: Any) -> str:
        page = Console(file=StringIO(), width=COLUMNS, highlight=False, color_system=None)
        for line in lines(value):
            page.print(line, markup=False)
        return "\n".join(line.rstrip() for line in page.file.getvalue().rstrip().splitlines())  # type: ignore[attr-defined]

    return draw


register(Balance, text=printed(text.balance_lines), html=balance_html, svg=svg)
register(Design, text=printed(text.design_lines), html=design_html, svg=svg)
register(Adjustment, text=printed(robust.adjustment_lines))
register(Bill, text=printed(bill.bill_lines))
register(Certified, text=printed(certificate.certificate_lines))
register(Identified, text=printed(identify.identify_lines))
register(Comparison, text=printed(compare.comparison_lines))
register(LayoutSearch, text=printed(layouts.layout_lines))
register(Playback, text=printed(simulation.playback_lines))
register(Release, text=printed(simulation.release_lines))
register(Reproduction, text=printed(published.reproduction_lines))
register(Sweep, text=printed(lambda found: [robust.sweep_table(found)]))
register(Tolerance, text=printed(robust.tolerance_lines))
