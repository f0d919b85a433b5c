"""`equipoise simulate`: verification in MuJoCo."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import Fault, InputError
from . import terminal
from .app import File, Json, app

if TYPE_CHECKING:
    from ..kinematics.motion import Move
    from ..mechanism import Mechanism

FRAMES = 401  # of a motion


@app.command()
def simulate(
    file: File,
    seconds: Annotated[float, typer.Option(help="of every run")] = 10.0,
    poses: Annotated[int, typer.Option(min=1, help="random ones inside the limits, let go at rest")] = 10,
    seed: Annotated[int, typer.Option(min=0, help="of the random poses")] = 0,
    tolerance: Annotated[
        str, typer.Option(help="drift that counts as staying [rad; m of slides], or 0.01deg")
    ] = "1e-4",
    radius: Annotated[
        str | None, typer.Option(help="of uniform spheres for bodies without an inertia (without it: an error)")
    ] = None,
    control: Annotated[bool, typer.Option(help="the same again with one spring 1 % soft: that must move")] = True,
    move: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT:START:END:FROM:TO", help="drive it instead: cubics in time; may be repeated"),
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="of the energies of a motion: .svg, .png or .pdf")] = None,
    json: Json = False,
) -> None:
    """Does it stay where you leave it, in an independent engine? Exit code 1 when it moves.

    Needs MuJoCo: pip install 'equipoise\\[sim]'.

    Example: [bold]equipoise simulate ur5-balanced.yaml --seconds 10[/bold]
    Example: [bold]equipoise simulate arm.yaml --move "joint 1:0:2:0:60 deg"[/bold]
    """
    from . import options

    size = None if radius is None else options.positive_length(radius, "--radius")
    mechanism = terminal.load(file)
    if move:
        _drive(mechanism, move, size, plot, json)
        return
    if plot is not None:
        raise InputError(Fault(("--plot",), "is of a motion: give it with --move"))
    from ..report.simulation import release_lines
    from ..simulate import release

    limit = options.quantity(tolerance, "angle", "--tolerance")
    with terminal.progress_bar("simulating") as report:
        found = release(
            mechanism, seconds=seconds, poses=poses, seed=seed, tolerance=limit, radius=size, control=control,
            progress=report,
        )  # fmt: skip
    if json:
        terminal.print_json(found.to_dict())
    else:
        terminal.show(release_lines(found))
    raise typer.Exit(0 if found.stays else 1)


def _drive(mechanism: Mechanism, moves: list[str], radius: float | None, plot: Path | None, json: bool) -> None:
    import numpy as np

    from ..kinematics import Tree
    from ..kinematics.motion import follow
    from ..report.simulation import playback_lines, playback_plot
    from ..simulate import play

    tree = Tree.of(mechanism)
    turns = dict(zip(tree.coordinates, tree.turns.tolist(), strict=True))
    found = sorted((_move(text, turns) for text in moves), key=lambda one: one.start)
    time = np.linspace(min(one.start for one in found), max(one.end for one in found), FRAMES)
    played = play(mechanism, time, follow(tree.coordinates, found, time), radius)
    if json:
        terminal.print_json(played.to_dict())
    else:
        terminal.show(playback_lines(played))
    if plot is not None:
        from ..report.plots import save_plot

        save_plot(playback_plot(played), plot)
        terminal.say(f"wrote {plot}")


def _move(text: str, turns: dict[str, bool]) -> Move:
    """``JOINT:START:END:FROM:TO``, a joint's cubic between two times."""
    from ..errors import nearest
    from ..kinematics.motion import Move
    from . import options

    parts = text.rsplit(":", 4)
    if len(parts) != 5:
        raise InputError(Fault(("--move",), f"expected JOINT:START:END:FROM:TO, found '{text}'"))
    name = parts[0].strip()
    if name not in turns:
        raise InputError(Fault(("--move",), f"no coordinate {nearest(name, turns)}", tuple(turns)))
    start, end = (options.quantity(part, "time", "--move") for part in parts[1:3])
    if end <= start:
        raise InputError(Fault(("--move",), f"must end after it starts, found {start:g} s to {end:g} s"))
    first, last = (options.quantity(part, "angle" if turns[name] else "length", "--move") for part in parts[3:])
    return Move(name, start, end, first, last)
