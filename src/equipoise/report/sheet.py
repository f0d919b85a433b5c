"""The dimensioned sheet of a bill of materials: a view and the data of every spring that is chosen."""

from __future__ import annotations

from collections.abc import Iterator

from .._version import __version__
from ..hardware.realise.bill import Bill, BillItem
from ..hardware.realise.realisations import Realisation
from ..hardware.sizing.compression import CompressionSpring
from ..hardware.sizing.wire import MM, MPA
from .drawing import LARGE, NORMAL, SMALL, THICK, Drawing
from .spring_view import draw_spring

WIDTH, PANEL, HEAD, EDGE = 297.0, 78.0, 22.0, 8.0  # [mm]
DATA = 188.0  # [mm] from the left


def sheet(bill: Bill) -> Drawing:
    """The sheet; springs that cannot be made are named with the reason."""
    drawing = Drawing(WIDTH, HEAD + PANEL * len(bill.items) + EDGE)
    top = drawing.height - EDGE
    frame = ((EDGE, EDGE), (WIDTH - EDGE, EDGE), (WIDTH - EDGE, top), (EDGE, top), (EDGE, EDGE))
    drawing.line(*frame, width=THICK)
    drawing.label((EDGE + 4, top - 7), f"{bill.balance.mechanism.name}: springs", LARGE, bold=True)
    right = f"equipoise {__version__}, dimensions in mm"
    drawing.label((WIDTH - EDGE - 4, top - 6), right, SMALL, "end")
    for number, item in enumerate(bill.items):
        y = top - (HEAD - EDGE) - PANEL * number
        drawing.line((EDGE, y), (WIDTH - EDGE, y))
        way = item.chosen
        count = way.winding.count if way else 0
        name = f"{number + 1}  {item.spring.name}" + (f"  ({count} off, side by side)" if count > 1 else "")
        drawing.label((EDGE + 4, y - 6), name, NORMAL + 0.5, bold=True)
        if way is None:
            for line, text in enumerate(_wrapped(f"cannot be made: {item.ways[0].reason}", 95)):
                drawing.label((EDGE + 4, y - 14 - 4.5 * line), text)
            continue
        s = way.winding.spring
        scale = draw_spring(drawing, s, (EDGE + 14, y - 38))
        drawing.label(
            (EDGE + 4, y - PANEL + 4), f"scale {scale}; wire d = {s.d / MM:.3g}, {s.n:.4g} active coils", SMALL
        )
        for line, (what, value) in enumerate(_data(bill, item, way)):
            drawing.label((DATA, y - 6 - 4.3 * line), what, NORMAL)
            drawing.label((WIDTH - EDGE - 4, y - 6 - 4.3 * line), value, NORMAL, "end")
    return drawing


def _data(bill: Bill, item: BillItem, way: Realisation) -> Iterator[tuple[str, str]]:
    s, limits = way.winding.spring, bill.options.limits
    least, most = item.forces(way)
    yield "realisation", way.kind
    yield "wire", f"{s.wire.standard} {s.wire.name}, Rm {s.strength / MPA:.0f} MPa"
    yield "d, D, De", f"{s.d / MM:.3g}, {s.D / MM:.4g}, {s.outer / MM:.4g} mm"
    yield "rate", f"{s.rate / 1000:.4g} N/mm"
    if isinstance(s, CompressionSpring):
        yield "active coils, all coils", f"{s.n:.4g}, {s.n + 2:.4g} (closed, ground)"
        yield "solid length", f"{s.solid_length / MM:.4g} mm"
    else:
        yield "coils", f"{s.n:.4g}"
        yield "initial tension", f"{s.initial_tension:.4g} N"
    short, long = sorted((float(s.length(least)), float(s.length(most))))
    yield "length in use", f"{short / MM:.4g} to {long / MM:.4g} mm"
    yield "force in use", f"{least:.4g} to {most:.4g} N"
    yield (
        "stress, permissible",
        f"{s.stress(most) / MPA:.0f}, {s.stress(most) * s.static_margin(most, limits) / MPA:.0f} MPa",
    )
    yield "static margin", f"{s.static_margin(most, limits):.2f}"
    if not isinstance(s, CompressionSpring):
        yield "margin of the loops", f"{s.hook_margin(most, limits):.2f}"
    yield "fatigue margin (Goodman)", f"{s.fatigue_margin(least, most, limits):.2f}"
    yield "natural frequency", f"{s.frequency:.3g} Hz"
    yield "mass", f"{1000 * s.mass:.4g} g each"
    if way.behind is not None:
        yield "case reaches behind A", f"{way.behind / MM:.4g} mm"


def _wrapped(text: str, width: int) -> list[str]:
    from textwrap import wrap

    return wrap(text, width)[:8]
