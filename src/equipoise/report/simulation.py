"""What a simulation found, as text for a terminal and as a figure."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ..simulate import Playback, Release
from ..simulate.release import SOFT

AGREE = 1e-6  # of the largest torque: two programs that say the same


def release_lines(found: Release) -> Iterator[RenderableType]:
    """Whether it stays, whether the control moved, what holds it, and what the run rests on."""
    runs = f"{len(found.poses)} random poses, {found.seconds:g} s each, let go at rest"
    if found.stays:
        yield Text(f"STAYS: no joint of {found.mechanism.name} drifts by more than {_turn(found.design.largest)} "
                   f"({runs})", style="bold green")  # fmt: skip
    else:
        pose, joint = found.worst
        at = ", ".join(
            f"{name} {_turn(x)}" for name, x in zip(found.coordinates, found.poses[pose].tolist(), strict=True)
        )
        yield Text(f"MOVES: '{joint}' drifts by {_turn(found.design.largest)}, more than {_turn(found.tolerance)} "
                   f"({runs})", style="bold yellow")  # fmt: skip
        yield Text(f"worst pose: {at}")
    if found.control is None:
        yield Text("no control run: nothing shows that the run would have seen a fault", style="yellow")
    else:
        what = f"control, '{found.soft}' {100 * SOFT:g} % soft: drifts by {_turn(found.control.largest)}"
        least = _turn(float(found.control.moved.max(axis=1).min()))
        fair = "" if found.meaningful else "; TOO LITTLE: staying proves nothing here, try more --seconds"
        yield Text(f"{what} at most and {least} at least, depending on the pose{fair}")
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("joint", no_wrap=True)
    for title in ("held without springs", "with springs", "unit"):
        table.add_column(title, justify="right", no_wrap=True)
    bare, held = (np.abs(x).max(axis=0) for x in (found.unbalanced, found.design.holding))
    for name, a, b in zip(found.coordinates, bare, held, strict=True):
        table.add_row(Text(name), f"{a:.4g}", f"{b:.2g}", name.load_unit)
    yield table
    yield Text(
        f"energy drift {found.design.energy.max():.2g} J, constraint error {found.design.constraint_error:.2g} m"
    )
    yield Text(f"engine: {found.settings}", style="dim")


def playback_lines(found: Playback) -> Iterator[RenderableType]:
    """Peak torque and work of every actuator with the springs and without."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("joint", no_wrap=True)
    for title in ("peak without springs", "with springs", "unit", "work without springs", "with springs", "unit"):
        table.add_column(title, justify="right", no_wrap=True)
    (peak, bare_peak), (work, bare_work) = found.peak, found.work
    for name, a, b, c, d in zip(found.coordinates, bare_peak, peak, bare_work, work, strict=True):
        table.add_row(Text(name), f"{a:.4g}", f"{b:.4g}", name.load_unit, f"{c:.4g}", f"{d:.4g}", "J")
    yield table
    if found.apart is not None:
        yield Text(f"MuJoCo's inverse dynamics and the torques predicted here differ by at most {found.apart:.1e} of "
                   "the largest", style="bold green" if found.apart < AGREE else "bold red")  # fmt: skip
    whole = found.gravity + found.springs
    yield Text(f"over the motion gravity's energy varies by {np.ptp(found.gravity):.5g} J, that of gravity and springs "
               f"by {np.ptp(whole):.2g} J; work is the integral of |torque x rate|")  # fmt: skip


def _turn(x: float) -> str:
    """An angle or, of slides, a length: both in one number."""
    return f"{np.degrees(x):.3g} deg" if abs(x) >= 1e-4 else f"{x:.2g} rad"
