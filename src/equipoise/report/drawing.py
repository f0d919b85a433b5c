"""Technical drawings: lines and texts on a sheet, in mm, x to the right and y upwards; written as SVG or DXF."""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Literal
from xml.sax.saxutils import escape

from ..io.files import check_writable, write_text
from ..model.errors import Fault, InputError
from . import style

Anchor = Literal["start", "middle", "end"]
Pair = tuple[float, float]
THIN, THICK = 0.18, 0.35  # [mm] ISO 128
ARROW = 2.2  # [mm]
SMALL, NORMAL, LARGE = 2.5, 3.0, 4.5  # [mm] height of texts
HIDDEN = "#9AA5B1"


@dataclass(frozen=True)
class Line:
    """A line through points; `pattern` are the lengths of its dashes and gaps, `filled` closes and fills it."""

    points: tuple[Pair, ...]
    width: float = THIN
    colour: str = style.INK
    pattern: tuple[float, ...] = ()
    filled: bool = False


@dataclass(frozen=True)
class Label:
    """A text of one line."""

    at: Pair
    text: str
    size: float = NORMAL
    anchor: Anchor = "start"
    upwards: bool = False
    bold: bool = False
    colour: str = style.INK


@dataclass
class Drawing:
    """A sheet of `width` x `height` mm."""

    width: float
    height: float
    lines: list[Line] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)

    def line(
        self, *points: Pair, width: float = THIN, colour: str = style.INK, pattern: tuple[float, ...] = ()
    ) -> None:
        """A line through points."""
        self.lines.append(Line(points, width, colour, pattern))

    def label(self, at: Pair, text: str, size: float = NORMAL, anchor: Anchor = "start", *, bold: bool = False) -> None:
        """A text."""
        self.labels.append(Label(at, text, size, anchor, bold=bold))

    def dimension(self, a: Pair, b: Pair, offset: float, text: str) -> None:
        """A dimension of the horizontal or vertical distance from `a` to `b`, `offset` mm beside them.

        A horizontal one is above for a positive offset, a vertical one to the right.
        """
        across = abs(a[0] - b[0]) >= abs(a[1] - b[1])
        edge = (max if offset > 0 else min)(a[not across or 1] if across else a[0], b[1] if across else b[0])
        base = edge + offset
        ends = [(a[0], base), (b[0], base)] if across else [(base, a[1]), (base, b[1])]
        for point, end in zip((a, b), ends, strict=True):
            beyond = (
                (end[0], end[1] + (1 if offset > 0 else -1)) if across else (end[0] + (1 if offset > 0 else -1), end[1])
            )
            self.line(point, beyond)
        start, stop = sorted(ends)
        size = (stop[0] - start[0]) if across else (stop[1] - start[1])
        inside = size > 3 * ARROW
        reach = 0.0 if inside else 2.5 * ARROW
        step = (1.0, 0.0) if across else (0.0, 1.0)
        first = (start[0] - reach * step[0], start[1] - reach * step[1])
        last = (stop[0] + reach * step[0], stop[1] + reach * step[1])
        self.line(first, last)
        for tip, way in ((start, 1 if inside else -1), (stop, -1 if inside else 1)):
            self._arrow(tip, (way * step[0], way * step[1]))
        wide = inside and size > 0.62 * NORMAL * len(text) + 2
        if across:
            at = ((start[0] + stop[0]) / 2, base + 1.0) if wide else (last[0] + 1, base - NORMAL / 3)
            self.label(at, text, anchor="middle" if wide else "start")
        else:
            middle = (start[1] + stop[1]) / 2
            if wide:
                self.labels.append(Label((base - 1.0, middle), text, NORMAL, "middle", upwards=True))
            else:
                self.label((base + 1.5, middle - NORMAL / 3), text)

    def _arrow(self, tip: Pair, way: Pair) -> None:
        x, y = tip
        back = (x + ARROW * way[0], y + ARROW * way[1])
        side = (ARROW / 6 * way[1], ARROW / 6 * way[0])
        points = (tip, (back[0] + side[0], back[1] + side[1]), (back[0] - side[0], back[1] - side[1]))
        self.lines.append(Line(points, filled=True))

    def svg(self) -> str:
        """The drawing as an SVG file, at full size."""
        size = f'width="{self.width:g}mm" height="{self.height:g}mm" viewBox="0 0 {self.width:g} {self.height:g}"'
        parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size}>',
            f'<rect width="{self.width:g}" height="{self.height:g}" fill="white"/>',
            '<g font-family="DejaVu Sans, sans-serif" stroke-linejoin="round" stroke-linecap="round">',
        ]
        for line in self.lines:
            points = " ".join(f"{x:.3f},{self.height - y:.3f}" for x, y in line.points)
            if line.filled:
                parts.append(f'<polygon points="{points}" fill="{line.colour}"/>')
                continue
            dashes = f' stroke-dasharray="{" ".join(f"{x:g}" for x in line.pattern)}"' if line.pattern else ""
            look = f'fill="none" stroke="{line.colour}" stroke-width="{line.width:.3g}"{dashes}'
            parts.append(f'<polyline points="{points}" {look}/>')
        for one in self.labels:
            x, y = one.at[0], self.height - one.at[1]
            turn = f' transform="rotate(-90 {x:.3f} {y:.3f})"' if one.upwards else ""
            bold = ' font-weight="bold"' if one.bold else ""
            look = f'font-size="{one.size:g}" text-anchor="{one.anchor}" fill="{one.colour}"{bold}{turn}'
            parts.append(f'<text x="{x:.3f}" y="{y:.3f}" {look}>{escape(style.clean(one.text, 200))}</text>')
        return "\n".join([*parts, "</g>", "</svg>"]) + "\n"

    def dxf(self) -> str:
        """The drawing as a DXF file in mm; needs ezdxf."""
        from ezdxf.enums import TextEntityAlignment as Align
        from ezdxf.filemanagement import new
        from ezdxf.units import MM

        document = new("R2010", units=MM)
        document.layers.add("thin", lineweight=18)
        document.layers.add("thick", lineweight=35)
        document.layers.add("text", lineweight=18)
        document.linetypes.add("EQ_DASHDOT", pattern=[8.0, 5.0, -1.2, 0.6, -1.2])
        space = document.modelspace()
        for line in self.lines:
            attributes = {"layer": "thick" if line.width >= THICK else "thin"}
            if line.pattern:
                attributes["linetype"] = "EQ_DASHDOT"
            if line.filled:
                space.add_solid([*line.points, line.points[-1]], dxfattribs=attributes)
            elif len(line.points) > 2:
                space.add_lwpolyline(line.points, dxfattribs=attributes)
            else:
                for a, b in pairwise(line.points):
                    space.add_line(a, b, dxfattribs=attributes)
        aligned = {"start": Align.LEFT, "middle": Align.CENTER, "end": Align.RIGHT}
        for one in self.labels:
            attributes = {"layer": "text", "rotation": 90.0 if one.upwards else 0.0}
            # a DXF height is that of a capital, about 0.72 of a font's size
            text = space.add_text(style.clean(one.text, 200), height=0.72 * one.size, dxfattribs=attributes)
            text.set_placement(one.at, align=aligned[one.anchor])
        stream = io.StringIO()
        document.write(stream)
        return stream.getvalue()


WRITERS: dict[str, Callable[[Drawing], str]] = {".svg": Drawing.svg, ".dxf": Drawing.dxf}


def check_sheet(path: str | os.PathLike[str]) -> None:
    """Whether a drawing could be written there, asked before long work.

    Raises:
        InputError: another suffix than .svg or .dxf, ezdxf is not installed, or the folder cannot be written to.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in WRITERS:
        found = f"a drawing cannot be written as '{suffix}'"
        raise InputError(Fault((), found, tuple(WRITERS), file=os.fspath(path)))
    check_extra(suffix)
    check_writable(path)


def check_extra(suffix: str) -> None:
    """Whether what a kind of drawing needs is installed.

    Raises:
        InputError: it is not.
    """
    if suffix == ".dxf" and find_spec("ezdxf") is None:
        raise InputError("DXF drawings need ezdxf: pip install 'equipoise[cad]'")


def save_drawing(drawing: Drawing, path: str | os.PathLike[str]) -> None:
    """Write a drawing, whole or not at all.

    Raises:
        InputError: as `check_sheet`.
    """
    check_sheet(path)
    write_text(path, WRITERS[Path(path).suffix.lower()](drawing))
