"""`equipoise compare`: every method and span side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..model.errors import InputError
from . import terminal
from .app import File, Json, app


@app.command()
def compare(
    file: File,
    spans: Annotated[str, typer.Option(metavar="A,B,...", help="of the convex program")] = "1,2,3",
    seconds: Annotated[float, typer.Option(help="that each row may take")] = 30.0,
    plot: Annotated[Path | None, typer.Option(help="write a picture: .svg, .png or .pdf")] = None,
    json: Json = False,
) -> None:
    """Every method and span in one table: springs, what is left, the bound, forces, energy, mass, can it be made?

    Rows appear as they get ready. Exit code 1 when none gives springs.

    Example: [bold]equipoise compare arm.yaml --plot methods.svg[/bold]
    """
    from ..report.compare import HEAD, row_line, save_comparison
    from ..report.figure import check_drawable
    from ..study.compare import Comparison, plan, worked_out

    try:
        wanted = tuple(int(span) for span in spans.split(","))
    except ValueError:
        wanted = ()
    if not wanted or min(wanted) < 1:
        raise InputError(f"--spans: must be whole numbers from 1 on, such as 1,2,3, found '{spans}'")
    if plot:
        check_drawable(plot)
    mechanism = terminal.load(file)
    rows, done = plan(mechanism, wanted), {}
    if not json:
        typer.echo(HEAD)
    with terminal.progress_bar("comparing") as report:
        for row in worked_out(mechanism, rows, seconds):
            done[row.name] = row
            if not json:
                terminal.show(iter([row_line(row)]))
            report(row.name, len(done) / len(rows))
    found = Comparison(mechanism, tuple(done[row.name] for row in rows))
    if plot:
        save_comparison(found, plot)
    if json:
        terminal.print_json(found.to_dict())
    if plot:
        terminal.say(f"wrote {plot}")
    raise typer.Exit(0 if any(row.springs for row in found.rows) else 1)
