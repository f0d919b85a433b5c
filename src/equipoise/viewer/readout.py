"""What the viewer says: the verdict, the pose's energies, torques as bars and the last motion as curves, as HTML."""

from __future__ import annotations

from html import escape

import numpy as np

from ..model.coordinate import load_unit
from ..report import style, svg
from ..report.verdict import verdict
from .model import Model

BARS_SHOWN = 12  # coordinates with bars
FONT = "font:13px/1.4 system-ui,sans-serif;padding:0 .8em"
TITLE = "font-weight:600;margin:.3em 0 .1em"


def status(model: Model) -> str:
    """The residual over the poses, and the verdict when there is one."""
    residual, balance = model.residual(), model.judged
    nothing = residual.share < 1e-9
    tone = style.AFTER if nothing else style.SPRINGS[0] if residual.share > 0.5 else "#8a5a00"
    share = "0 %" if nothing else f"{100 * residual.share:.3g} %"
    unit = load_unit(model.tree.coordinates)
    lines = [
        f'<div style="font-size:22px;font-weight:700;color:{tone}" data-residual="{residual.rms:.9g}"'
        f' data-unbalanced="{residual.unbalanced:.9g}">{share} of the torque is left</div>',
        f"<div>residual {_number(residual.rms)} of {_number(residual.unbalanced)} {unit} rms, {_count(model)}</div>",
    ]
    if balance is not None:
        lines.append(f'<div data-verdict="{"exact" if balance.exact else "not exact"}">{escape(str(verdict(balance)))}')
        lines.append("</div>")
    elif model.edited:
        lines.append("<div>changed by hand, not yet judged</div>")
    return f'<div style="{FONT}" role="status">{"".join(lines)}</div>'


def torques(model: Model) -> str:
    """Holding torque of every coordinate in this pose, without and with springs."""
    names = model.tree.coordinates
    before, after = model.state.gravity_torque[0], model.state.torque[0]
    order = np.sort(np.argsort(-np.abs(before), kind="stable")[:BARS_SHOWN])
    words = [names[j].load_unit for j in order]
    title = "Holding torque in this pose"
    floor = 1e-9 * max(1.0, float(np.abs(before).max(initial=0)))
    picture = svg.bars([names[j] for j in order], before[order], after[order], words, title, floor)
    key = f'<span style="color:{style.BEFORE}">■</span> without <span style="color:{style.AFTER}">■</span> with springs'
    return f'<div style="{FONT}" data-plot="torque"><div style="{TITLE}">{title} {key}</div>{picture}</div>'


def energies(model: Model) -> str:
    """Energies along the last motion, and their values now."""
    trail = np.array(model.trail)
    series = {"gravity": trail[:, 0], "springs": trail[:, 1], "total": trail[:, 2]}
    picture = svg.curves(np.arange(len(trail), dtype=float), series, "pose of the last motion", "energy [J]", "Energy")
    now = ", ".join(f"{name} {values[-1]:.4g} J" for name, values in series.items())
    return f'<div style="{FONT}" data-plot="energy"><div style="{TITLE}">Energy: {now}</div>{picture}</div>'


def _count(model: Model) -> str:
    count = sum(model.on)
    return f"{count} spring{'' if count == 1 else 's'} on" if count else "no spring is on"


def _number(value: float) -> str:
    return "0" if value < 1e-9 else f"{value:.4g}"
