"""`equipoise clearance`: do the springs have room?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import terminal
from .app import File, Json, app


@app.command()
def clearance(
    file: File,
    least: Annotated[str, typer.Option(help="good when every distance is at least this")] = "0 mm",
    samples: Annotated[int | None, typer.Option(min=1, help="random poses (default: the file's workspace)")] = None,
    motion: Annotated[
        Path | None, typer.Option(help="judge over the ranges of this motion: CSV, a column 'time' and coordinates")
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="draw the closest pose: .svg, .png or .pdf")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random poses")] = 0,
    json: Json = False,
) -> None:
    """Do springs, cables and weights have room? Smallest distances to links and to each other, slack poses.

    Links are as large as the file's capsules and shapes say, or the geometry of its URDF or MJCF. Exit code 1 when a
    distance is below [bold]--least[/bold], or when nothing says how large the links are: then they are not judged.

    Example: [bold]equipoise clearance balanced.yaml --least 5mm[/bold]
    """
    from ..clearance import clearance as judge
    from . import options

    limit = options.length(least, "--least")
    if plot:
        from ..report.figure import check_drawable

        check_drawable(plot)
    mechanism = terminal.load(file)
    if motion is not None:
        from ..clearance import within
        from ..io.motion_table import read_motion

        mechanism = within(mechanism, [read_motion(motion, mechanism.coordinates)])
    with terminal.progress_bar("measuring") as report:
        report("measuring distances", 0.0)
        found = judge(mechanism, samples=samples, seed=seed)
        if plot and found.gaps:
            from ..report.worst_pose import save_worst_pose

            report("drawing", 0.0)
            save_worst_pose(mechanism, found, plot)
    if plot:
        terminal.say(f"wrote {plot}" if found.gaps else f"wrote no {plot}: there is nothing to come close to")
    if json:
        terminal.print_json(found.to_dict(limit))
    else:
        from ..report.clearance import clearance_lines

        terminal.show(clearance_lines(mechanism, found, limit))
    raise typer.Exit(0 if found.clear(limit) else 1)
