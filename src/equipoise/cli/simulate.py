"""`equipoise simulate`: verification in MuJoCo."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..model.errors import Fault, InputError
from ..model.units import quantity
from . import terminal
from .app import File, Json, app

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism
    from . import motions


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
    friction: Annotated[
        bool, typer.Option("--friction", help="with the joints' friction and damping (default: released without)")
    ] = False,
    move: Annotated[
        list[str] | None,
        typer.Option(metavar="JOINT:START:END:FROM:TO", help="drive it instead: cubics in time; may be repeated"),
    ] = None,
    motion: Annotated[
        str | None,
        typer.Option(
            metavar="PAPER|FILE.csv",
            help="drive it through lin2010's, lee2014's, lenzo2017's or cho2012's motion, or a table with the column "
            "'time' and one for each coordinate that moves, such as 'elbow [deg]'",
        ),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="of torque, power and energy in a motion: .svg, .png or .pdf")
    ] = None,
    json: Json = False,
) -> None:
    """Does it stay where you leave it, in an independent engine? Exit code 1 when it moves.

    Needs MuJoCo: pip install 'equipoise\\[sim]'.

    Example: [bold]equipoise simulate ur5-balanced.yaml --seconds 10[/bold]
    Example: [bold]equipoise simulate arm.yaml --move "joint 1:0:2:0:60 deg"[/bold]
    Example: [bold]equipoise simulate lin2010_balanced.yaml --radius 50mm --motion lin2010 --plot motion.svg[/bold]
    """
    from . import options

    size = None if radius is None else options.positive_length(radius, "--radius")
    mechanism = terminal.load(file)
    if move or motion is not None:
        from ..kinematics import Tree
        from . import motions

        if move and motion is not None:
            raise InputError(Fault(("--motion",), "is instead of --move: give one of them"))
        tree = Tree.of(mechanism)
        driven = motions.of_moves(move or [], tree) if motion is None else motions.named(motion, tree)
        _drive(mechanism, driven, size, plot, json)
        return
    if plot is not None:
        raise InputError(Fault(("--plot",), "is of a motion: give it with --move or --motion"))
    from ..report.simulation import release_lines
    from ..simulate import release

    limit = quantity(tolerance, "angle", "--tolerance")
    with terminal.progress_bar("simulating") as report:
        found = release(
            mechanism, seconds=seconds, poses=poses, seed=seed, tolerance=limit, radius=size, control=control,
            friction=friction, progress=report,
        )  # fmt: skip
    if json:
        terminal.print_json(found.to_dict())
    else:
        terminal.show(release_lines(found))
    raise typer.Exit(0 if found.stays else 1)


def _drive(mechanism: Mechanism, motion: motions.Motion, radius: float | None, plot: Path | None, json: bool) -> None:
    from ..report.simulation import playback_lines
    from ..simulate import play

    played = play(mechanism, *motion, radius)
    if json:
        terminal.print_json(played.to_dict())
    else:
        terminal.show(playback_lines(played))
    if plot is not None:
        from ..report.motion_figure import save_motion

        save_motion(played, plot)
        terminal.say(f"wrote {plot}")
