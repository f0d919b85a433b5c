"""One picture of a design: the mechanism with its springs in two poses, and what the springs leave of the torque."""

from __future__ import annotations

import io
import os
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..balance import Balance, check
from ..energy.evaluate import Potential
from ..io import Source, loaded
from ..io.files import check_writable, write_bytes
from ..kinematics import Tree
from ..model.arrays import Array
from ..model.coordinate import load_unit
from ..model.errors import Fault, InputError
from ..model.mechanism import Mechanism
from . import arm, loads, style
from .poses import choose
from .skeleton import Skeleton

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# without what changes from one run or machine to the next
METADATA: dict[str, dict[str, None]] = {
    ".svg": {"Date": None, "Creator": None},
    ".png": {"Software": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
SIZE, DPI = (14.0, 7.0), 150  # [in], 2100 x 1050 pixels
LISTED = 8  # lines in the legend


def save_figure(
    mechanism: Source, path: str | os.PathLike[str], *, balance: Balance | None = None, title: str | None = None
) -> None:
    """Draw the mechanism with its springs in two poses, beside the holding torque with and without them.

    The same input gives the same bytes. The file is written whole or not at all.

    Args:
        mechanism: or the path of its file.
        path: ends in .svg, .png or .pdf.
        balance: the verdict on `mechanism`, computed when it is not given.
        title: in place of the mechanism's name.

    Raises:
        InputError: another suffix, the folder is missing or cannot be written to, or loops that cannot be closed.
    """
    mechanism = loaded(mechanism)
    judged = check(mechanism) if balance is None else balance

    render(path, SIZE, lambda figure: _draw(figure, mechanism, judged, title))


def plot(mechanism: Source, *, balance: Balance | None = None, title: str | None = None) -> Figure:
    """The picture that `save_figure` writes, as a matplotlib figure.

    Raises:
        InputError: matplotlib is not installed, or loops that cannot be closed.
    """
    check_installed()
    import matplotlib.style

    mechanism = loaded(mechanism)
    judged = check(mechanism) if balance is None else balance
    with matplotlib.style.context(["default", style.RC]):
        return _filled(SIZE, lambda figure: _draw(figure, mechanism, judged, title))


def check_drawable(path: str | os.PathLike[str]) -> None:
    """Whether `save_figure` could write there, asked before long work.

    Raises:
        InputError: as `save_figure` does; also when matplotlib is not installed.
    """
    if Path(path).suffix.lower() not in METADATA:
        found = f"a figure cannot be written as '{Path(path).suffix}'"
        raise InputError(Fault((), found, tuple(METADATA), file=os.fspath(path)))
    check_installed()
    check_writable(path)


def check_installed() -> None:
    """Whether figures can be drawn at all.

    Raises:
        InputError: matplotlib is not installed.
    """
    if find_spec("matplotlib") is None:
        raise InputError("figures need matplotlib: pip install 'equipoise[report]'")


def render(path: str | os.PathLike[str], size: tuple[float, float], draw: Callable[[Any], None]) -> None:
    """Write a figure of `size` [in] that `draw` fills: the same bytes for the same input, whole or not at all.

    Raises:
        InputError: as `check_drawable`.
    """
    check_drawable(path)
    write_bytes(path, picture(Path(path).suffix.lower(), size, draw))


def picture(suffix: str, size: tuple[float, float], draw: Callable[[Any], None]) -> bytes:
    """The same as the content of a file with the suffix .svg, .png or .pdf."""
    import matplotlib.style

    buffer = io.BytesIO()
    with matplotlib.style.context(["default", style.RC]), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph")  # a name in a script that the font lacks is no error
        _filled(size, draw).savefig(buffer, format=suffix[1:], dpi=DPI, metadata=METADATA[suffix])
    return buffer.getvalue()


def _filled(size: tuple[float, float], draw: Callable[[Any], None]) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, dpi=DPI, facecolor="white")
    draw(figure)
    return figure


def _draw(figure: Any, mechanism: Mechanism, balance: Balance, title: str | None) -> None:
    _heading(figure, mechanism, balance, title)
    _poses(figure, mechanism, balance)
    _legend(figure, mechanism)
    _torque(figure, balance)


def _heading(figure: Any, mechanism: Mechanism, balance: Balance, title: str | None) -> None:
    count = len(mechanism.springs)
    name = style.clean(mechanism.name if title is None else title, 46)
    springs = "no springs" if not count else "1 spring" if count == 1 else f"{count} springs"
    verdict, small = _verdict(balance)
    colour = style.FAINT if not count else style.AFTER if loads.below(balance) else style.SPRINGS[0]
    look = {"weight": "bold", "parse_math": False}
    figure.text(0.025, 0.93, f"{name}  ·  {springs}", color=style.INK, fontsize=20 if len(name) < 32 else 14, **look)
    figure.text(0.975, 0.93, verdict, color=colour, ha="right", fontsize=20, **look)
    figure.text(0.975, 0.885, small, fontsize=12, color=style.FAINT, ha="right")


def _verdict(balance: Balance) -> tuple[str, str]:
    unit = load_unit(balance.coordinates)
    poses, limit = f"{balance.certificate.samples} random poses", loads.below(balance)
    if not balance.coordinates:
        return "nothing moves", ""
    if not balance.mechanism.springs:
        return "gravity alone", f"over {poses}"
    if balance.exact:
        return "EXACT", f"proved for every pose; below {style.power(limit or 0.0)} {unit} over {poses}"
    if limit is not None:
        return f"residual below {style.power(limit)} {unit}", f"over {poses}"
    if not np.isfinite(balance.relative):
        return "residual torque where gravity had none", f"over {poses}"
    return f"residual {style.number(100 * balance.relative)} % of unbalanced", f"largest torque over {poses}"


def _poses(figure: Any, mechanism: Mechanism, balance: Balance) -> None:
    skeleton = Skeleton.of(mechanism)
    view, q = choose(mechanism, skeleton)
    poses = Tree.of(mechanism).poses(q)
    state = Potential(mechanism)(q)
    width, height = 0.29, 0.585
    limits = arm.window(skeleton, poses, view, width * SIZE[0] / (height * SIZE[1]))
    for i in range(2):
        axes = figure.add_axes((0.012 + i * 0.298, 0.3, width, height))
        axes.set(xlim=limits[0], ylim=limits[1], aspect="equal")
        axes.set_axis_off()
        arm.draw(axes, skeleton, poses, i, view)
        text = holding(mechanism, balance, state.gravity_torque[i], state.torque[i])
        axes.text(0.5, -0.005, text, transform=axes.transAxes, ha="center", va="top", color=style.INK, parse_math=False)


def holding(mechanism: Mechanism, balance: Balance, before: Array, after: Array) -> str:
    """The largest holding torque in a pose, without and with springs."""
    if not len(before):
        return ""
    kind = next((c for c in balance.coordinates if c.turns), balance.coordinates[0])
    own = np.array([c.turns == kind.turns for c in balance.coordinates])
    largest = [float(np.abs(torque[own]).max()) for torque in (before, after)]
    text = f"largest holding {kind.load} {style.number(largest[0])}"
    if mechanism.springs:
        limit = loads.below(balance)
        text += f" → {style.number(largest[1]) if limit is None else 0}"
    return f"{text} {kind.load_unit}"


def _legend(figure: Any, mechanism: Mechanism) -> None:
    springs = mechanism.springs
    if not springs:
        return
    axes = figure.add_axes((0.025, 0.03, 0.57, 0.2))
    lines = max(5, min(len(springs), LISTED))
    axes.set(xlim=(0, 100), ylim=(lines, 0))
    axes.set_axis_off()
    size = 12 if lines == 5 else 10
    named = springs if len(springs) <= LISTED else springs[: LISTED - 1]
    for i, spring in enumerate(named):
        y = i + 0.5
        path = arm.coiled(np.array([[0.0, y], [9.0, y]]), 0.26, 0.0, spring.law.look)
        axes.plot(*path.T, color=style.spring_colour(i), linewidth=2.0, solid_joinstyle="round")
        value, unit = spring.strength
        stiffness = f"{f'{value:#.4g}'.rstrip('.')} {unit}"
        where = " – ".join(style.clean(part, 26) for part in spring.where.split(" – "))
        look = {"va": "center", "fontsize": size, "parse_math": False}
        axes.text(11, y, style.clean(spring.name, 22), color=style.INK, **look)
        axes.text(44, y, stiffness, ha="right", color=style.INK, **look)
        axes.text(47, y, where, color=style.FAINT, **look)
    if len(named) < len(springs):
        text = f"and {len(springs) - len(named)} more springs"
        axes.text(11, lines - 0.5, text, va="center", fontsize=size, color=style.FAINT)


def _torque(figure: Any, balance: Balance) -> None:
    groups = loads.shown(balance)
    if not groups:
        return
    names = balance.coordinates
    rows = np.concatenate(list(groups.values()))
    longest = max(4, *(len(style.clean(names[row], loads.NAME)) for row in rows))
    left, right, bottom, top, gap = 0.625 + 0.0068 * longest, 0.97, 0.185, 0.79, 0.13
    loads.key(figure, balance, 0.625, 0.845)
    row = min((top - bottom - gap * (len(groups) - 1)) / len(rows), 0.17)
    for kind, group in groups.items():
        axes = figure.add_axes((left, top - row * len(group), right - left, row * len(group)))
        loads.draw(axes, balance, kind, group)
        top -= row * len(group) + gap
    text = f"solid: rms; pale and number: largest, over {balance.certificate.samples} random poses"
    if len(rows) == loads.BARS_SHOWN < len(names):
        text += f"\nthe {loads.BARS_SHOWN} of {len(names)} coordinates with the largest unbalanced torque"
    elif len(rows) < len(names):
        text += "\nwithout load: " + style.clean(", ".join(name for i, name in enumerate(names) if i not in rows), 50)
    figure.text(0.625, top + gap - 0.11, text, va="top", fontsize=11, color=style.FAINT, parse_math=False)
