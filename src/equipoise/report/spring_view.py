"""The side view of a helical spring with its dimensions, shortened in the middle where it is long."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np

from ..hardware.sizing.compression import CompressionSpring
from ..hardware.sizing.extension import LOOP, ExtensionSpring
from ..hardware.sizing.wire import MM
from ..model.arrays import Array
from .drawing import HIDDEN, THICK, THIN, Drawing, Line, Pair

Turns = Callable[[Any], Any]  # turns of the wire -> mm along the axis
LONG, HIGH = 128.0, 30.0  # [mm] on the sheet
ENDS = 5  # coils that are drawn at each end of one that is shortened
COILS_DRAWN = 40  # coils that are drawn one by one
SCALES = (10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05)
STEEL = "#3A4756"
AXIS = (6.0, 1.2, 0.6, 1.2)


def draw_spring(drawing: Drawing, spring: ExtensionSpring | CompressionSpring, at: Pair) -> str:
    """Draw a spring with its left end at `at` and its axis to the right; returns the scale as text."""
    extension = isinstance(spring, ExtensionSpring)
    whole = spring.free_length / MM
    ends = 2 * spring.hook / MM if isinstance(spring, ExtensionSpring) else 0.0
    coils = spring.n if extension else spring.n + 2
    drawn = float(coils)
    scale = next((s for s in SCALES if s * whole <= LONG and s * spring.outer / MM <= HIGH), 0.0)
    if coils > COILS_DRAWN or scale < 0.5:
        # shortened: a view of both ends
        drawn = min(float(coils), 2.0 * ENDS)
        pitch = _pitch(spring)
        short = ends + (drawn + 4) * pitch / MM
        fits = [s for s in SCALES if s * short <= LONG and s * spring.outer / MM <= HIGH]
        scale = fits[0] if fits else SCALES[-1]
        length = short if drawn < coils else whole
    else:
        length = whole
    _view(drawing, spring, at, scale, length, drawn, drawn < coils)
    ratio = f"{scale:g} : 1" if scale >= 1 else f"1 : {1 / scale:g}"
    return f"{ratio}, shortened" if drawn < coils else ratio


def _pitch(spring: ExtensionSpring | CompressionSpring) -> float:
    """[m] from coil to coil in the middle."""
    if isinstance(spring, ExtensionSpring):
        return spring.d
    return (spring.free_length - 3 * spring.d) / spring.n if spring.n else spring.d


def _view(
    drawing: Drawing,
    spring: ExtensionSpring | CompressionSpring,
    at: Pair,
    scale: float,
    length: float,
    drawn: float,
    shortened: bool,
) -> None:
    x0, y0 = at
    size = scale / MM  # sheet mm per metre
    d, D = spring.d * size, spring.D * size
    hook = spring.hook * size if isinstance(spring, ExtensionSpring) else 0.0
    total = length * scale
    left, right = x0 + hook, x0 + total - hook
    parts = [(left, drawn / 2, 1), (right, drawn / 2, -1)] if shortened else [(left, drawn, 1)]
    backs: list[Line] = []
    fronts: list[Line] = []
    for start, coils, way in parts:
        x = _advance(spring, coils, size, whole=not shortened)
        for n in range(max(1, int(np.ceil(2 * coils - 1e-9)))):
            # one half turn after the other: in front from below to above, then behind
            turns = np.linspace(n / 2, min((n + 1) / 2, coils), 13)
            points = [(start + way * float(x(t)), y0 - D / 2 * float(np.cos(2 * pi * t))) for t in turns]
            front = n % 2 == 0
            (fronts if front else backs).append(Line(tuple(points), max(d, THIN), STEEL if front else HIDDEN))
    drawing.lines += [*backs, *fronts]  # what is in front is drawn last
    if shortened:
        for side in (-1, 1):
            a = left + _advance(spring, drawn / 2, size, whole=False)(drawn / 2)
            b = right - _advance(spring, drawn / 2, size, whole=False)(drawn / 2)
            y = y0 + side * (D + d) / 2
            drawing.line((float(a), y), (float(b), y), pattern=AXIS, colour=HIDDEN)
    if isinstance(spring, ExtensionSpring):
        for end, way in ((left, -1), (right, 1)):
            _loop(drawing, (end, y0), way, hook, D, d, spring)
    drawing.line((x0 - 5, y0), (x0 + total + 5, y0), pattern=AXIS)
    outer = D + d
    drawing.dimension((x0, y0 + outer / 2), (x0 + total, y0 + outer / 2), 9, f"L0 = {_mm(spring.free_length)}")
    if isinstance(spring, ExtensionSpring):
        drawing.dimension((left, y0 - outer / 2), (right, y0 - outer / 2), -7, f"LK = {_mm(spring.body)}")
        drawing.dimension((right, y0 - outer / 2), (x0 + total, y0 - outer / 2), -13, f"LH = {_mm(spring.hook)}")
    middle = right if isinstance(spring, ExtensionSpring) else x0 + total
    edge = x0 + total + 6
    a, b = (middle, y0 - outer / 2), (middle, y0 + outer / 2)
    drawing.dimension(a, b, edge - middle + 4, f"De = {_mm(spring.outer)}")


def _advance(spring: ExtensionSpring | CompressionSpring, coils: float, size: float, *, whole: bool) -> Turns:
    """Turns -> mm along the axis, of the wire's middle."""
    d = spring.d * size
    if isinstance(spring, ExtensionSpring):
        return lambda t: d / 2 + t * d
    pitch = _pitch(spring) * size
    # the first coil is closed, and of a whole spring the last one too
    last = coils - 1 if whole else np.inf
    turns: Array = np.array([0.0, 1.0, min(last, 1e6), 1e6])
    middle = d + (turns[2] - 1) * pitch
    x = np.array([0.0, d, middle, middle + (1e6 - turns[2]) * d])
    return lambda t: d / 2 + np.interp(t, turns, x)


def _loop(drawing: Drawing, end: Pair, way: int, hook: float, D: float, d: float, spring: ExtensionSpring) -> None:
    """A full loop in the plane of the sheet, its inside `hook` mm beyond the body's end."""
    x, y = end
    radius = min(D / 2, hook + d / 2)
    if hook > LOOP * (D - d) * (1 + 1e-6):
        radius = D / 2
    centre = x + way * (hook - (radius - d / 2))
    angles = np.linspace(-0.85 * pi, 0.85 * pi, 49)
    points = [(centre + way * radius * float(np.cos(t)), y + radius * float(np.sin(t))) for t in angles]
    if (points[0][0] - x) * way > 0:
        points = [(x, points[0][1]), *points, (x, points[-1][1])]
    drawing.line(*points, width=max(d, THICK), colour=STEEL)


def _mm(value: float) -> str:
    return f"{value / MM:.4g}"
