"""`equipoise tolerance`: what manufacturing scatter does."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..model.units import share
from . import terminal
from .app import File, Json, app


@app.command()
def tolerance(
    file: File,
    stiffness: Annotated[str, typer.Option(help="of each spring, a share")] = "5%",
    attachment: Annotated[str, typer.Option(help="of each coordinate of a spring's ends, a length")] = "0.5mm",
    mass: Annotated[str, typer.Option(help="of each mass, a share")] = "1%",
    length: Annotated[str, typer.Option(help="of each coordinate of joints and mass centres, a length")] = "0.5mm",
    uniform: Annotated[bool, typer.Option("--uniform", help="these are +- limits, not standard deviations")] = False,
    friction: Annotated[
        list[str] | None,
        typer.Option(metavar="[JOINT=]TORQUE", help="what joints hold, such as '2 N m'; may be repeated"),
    ] = None,
    required: Annotated[str | None, typer.Option("--yield", help="the share of builds that friction must hold")] = None,
    builds: Annotated[int, typer.Option(min=2, help="how many to draw")] = 100_000,
    poses: Annotated[int, typer.Option(min=1, help="random poses that each is judged on")] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="of builds and poses")] = 0,
    plot: Annotated[Path | None, typer.Option(help="write a histogram: .svg, .png or .pdf")] = None,
    json: Json = False,
) -> None:
    """What manufacturing scatter does: peak residual, torque margin, yield, and which parameter matters most.

    Exit code 1 when fewer builds than [bold]--yield[/bold] hold.

    Example: [bold]equipoise tolerance balanced.yaml --friction '5 N m' --yield 97% --plot builds.svg[/bold]
    """
    from ..model.errors import InputError
    from ..report.builds import save_builds
    from ..report.figure import check_drawable
    from ..robust import Scatter
    from ..robust import tolerance as run
    from . import options

    shape = "uniform" if uniform else "normal"
    scatter = Scatter(
        share(stiffness, "--stiffness"),
        options.length(attachment, "--attachment"),
        share(mass, "--mass"),
        options.length(length, "--length"),
        shape,
    )
    least = None if required is None else share(required, "--yield")
    if least is not None and (not friction or not 0 < least <= 1):
        raise InputError("--yield: needs --friction, and a share of more than 0 and at most 100 %")
    mechanism = terminal.load(file)
    held = options.friction(friction or [], mechanism)
    if plot:
        check_drawable(plot)
    with terminal.progress_bar("building") as report:
        found = run(
            mechanism, scatter, builds=builds, poses=poses, friction=held or None, seed=seed, progress=report
        )  # fmt: skip
        if plot:
            save_builds(found, plot)
    if json:
        terminal.print_json(found.to_dict())
    else:
        from ..report.robust import tolerance_lines

        terminal.show(tolerance_lines(found))
    if plot:
        terminal.say(f"wrote {plot}")
    raise typer.Exit(1 if least is not None and (found.yield_ or 0.0) < least else 0)
