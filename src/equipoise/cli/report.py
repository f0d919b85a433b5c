"""`equipoise report`: all that is known about a design, in one file."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from ..model.errors import Fault, InputError, nearest
from . import terminal
from .app import File, Json, app
from .buildable import Cycles, Fatigue, Safety

NONE = "none"
MARGINS = ("safety", "fatigue", "cycles")


@app.command()
def report(
    context: typer.Context,
    file: File,
    output: Annotated[Path, typer.Option("-o", "--output", help=".html or .pdf", show_default=False)],
    with_: Annotated[
        str, typer.Option("--with", metavar="A,B,...", help="what else to look into, or none")
    ] = "simulation,hardware,tolerance",
    samples: Annotated[int | None, typer.Option(min=1, help="random poses (default: the file's workspace)")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random poses and builds")] = 0,
    radius: Annotated[
        str | None, typer.Option(help="of uniform spheres for bodies without an inertia, to simulate them")
    ] = None,
    safety: Safety = 1.2,
    fatigue: Fatigue = 1.0,
    cycles: Cycles = 1e5,
    date: Annotated[str | None, typer.Option(help="as it is to stand there (default: today)")] = None,
    json: Json = False,
) -> None:
    """One self-contained file: what to build, verdict, pictures, torques, certificate, simulation, hardware, tolerance.

    A page (.html) loads nothing from anywhere; .pdf has the same content. Needs the extra: pip install
    'equipoise\\[report]'.

    Example: [bold]equipoise report ur5-balanced.yaml -o ur5.html[/bold]
    Example: [bold]equipoise report balanced.yaml -o balanced.pdf --with hardware[/bold]
    """
    from ..balance import check
    from ..hardware import Limits
    from ..report.body_sheet import today
    from ..report.page.make import EXTRAS, check_report, make, save_report
    from . import options

    extras = [] if with_ == NONE else options.names(with_) or [""]
    for name in extras:
        if name not in EXTRAS:
            raise InputError(Fault(("--with",), f"no section {nearest(name, EXTRAS)}", (*EXTRAS, NONE)))
    size = None if radius is None else options.positive_length(radius, "--radius")
    check_report(output)  # before the work, not after it
    mechanism = terminal.load(file)
    day = today() if date is None else date
    typed = ["equipoise", "report", file.name, "-o", output.name]  # what gives the same again
    typed += [] if extras == list(EXTRAS) else ["--with", ",".join(extras) or NONE]
    asked = Limits(safety=safety, fatigue=fatigue, cycles=cycles)
    margins = [(f"--{name}", f"{getattr(asked, name):g}") for name in MARGINS if terminal.typed(context, name)]
    for option, value in (
        ("--samples", samples),
        ("--seed", seed or None),
        ("--radius", radius),
        *margins,
        ("--date", day),
    ):
        typed += [] if value is None else [option, str(value)]
    with terminal.progress_bar("judging") as progress:
        progress("judging the balance", 0.0)
        balance = check(mechanism, samples=samples, seed=seed)
        found = make(
            balance, extras=extras, seed=seed, radius=size, limits=asked, date=day, file=file,
            command=shlex.join(typed), progress=progress,
        )  # fmt: skip
        save_report(found, output)
    if json:
        terminal.print_json(found.data)
    else:
        terminal.say(found.verdict)
    terminal.say(f"wrote {output}")
