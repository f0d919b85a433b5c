"""`equipoise clearance`: do the springs have room?"""

from __future__ import annotations

from typing import Annotated

import typer

from . import terminal
from .app import File, Json, app


@app.command()
def clearance(
    file: File,
    least: Annotated[str, typer.Option(help="good when every distance is at least this")] = "0 mm",
    samples: Annotated[int | None, typer.Option(min=1, help="random poses (default: the file's workspace)")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random poses")] = 0,
    json: Json = False,
) -> None:
    """Do the springs have room? Smallest distances to links (the file's capsules) and to each other, slack poses.

    Exit code 1 when a distance is below [bold]--least[/bold].

    Example: [bold]equipoise clearance balanced.yaml --least 5mm[/bold]
    """
    from ..clearance import clearance as judge
    from . import options

    limit = options.length(least, "--least")
    mechanism = terminal.load(file)
    with terminal.progress_bar("measuring") as report:
        report("measuring distances", 0.0)
        found = judge(mechanism, samples=samples, seed=seed)
    if json:
        terminal.print_json(found.to_dict())
    else:
        from ..report.clearance import clearance_lines

        terminal.show(clearance_lines(mechanism, found, limit))
    raise typer.Exit(0 if found.least >= limit else 1)
