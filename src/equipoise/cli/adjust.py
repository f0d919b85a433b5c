"""`equipoise adjust`: what to move when the payload changes."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import Annotated

import typer

from ..model.units import share
from . import terminal
from .app import File, Json, app


@app.command()
def adjust(
    file: File,
    payload: Annotated[str, typer.Option(metavar="LOW,HIGH", help="the range", show_default=False)],
    payload_on: Annotated[str, typer.Option(metavar="BODY", help="the body that carries it", show_default=False)],
    payload_at: Annotated[str, typer.Option(metavar="X,Y,Z", help="where, in that body's frame")] = "0,0,0",
    tolerance: Annotated[
        str, typer.Option(help="balance is kept when less than this of what the payload does is left, a share")
    ] = "1e-9",
    travel: Annotated[str | None, typer.Option(metavar="LENGTH", help="no end moves further")] = None,
    payloads: Annotated[int, typer.Option(min=2, help="for how many payloads of the range the table is")] = 5,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="write the best fixed design: .yaml")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random poses")] = 0,
    json: Json = False,
) -> None:
    """What to move when the payload changes: attachment or preload, how far, the energy it takes.

    With what is left at each joint for payloads of the range, and a pose in which it takes no energy, if there is one.
    And the best fixed springs for the whole range, beside the least that any fixed springs leave.

    Exit code 1 when no adjustment of up to three springs keeps the balance.

    Example: [bold]equipoise adjust balanced.yaml --payload 0,2kg --payload-on wrist --payload-at 0,0,50mm[/bold]
    """
    from ..io import check_savable, save
    from ..robust import adjust as run
    from . import options

    limit = share(tolerance, "--tolerance")
    far = inf if travel is None else options.positive_length(travel, "--travel")
    mechanism = terminal.load(file)
    carried = options.payload(mechanism, payload, payload_on, payload_at)
    if output:
        check_savable(output)
    with terminal.progress_bar("trying what to move") as report:
        found = run(mechanism, carried, tolerance=limit, travel=far, payloads=payloads, seed=seed, progress=report)
        if output:
            save(found.fixed, output)
    if json:
        terminal.print_json(found.to_dict())
    else:
        from ..report.robust import adjustment_lines

        terminal.show(adjustment_lines(found))
    if output:
        terminal.say(f"wrote {output}")
    raise typer.Exit(0 if found.keeps else 1)
