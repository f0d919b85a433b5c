"""`equipoise demo`: the main job, start to finish."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import terminal
from .app import app


@app.command()
def demo(
    folder: Annotated[Path, typer.Option("-o", "--output", help="folder for the design and its figure")] = Path(
        "equipoise-demo"
    ),
) -> None:
    """The main job on a real robot, start to finish: a UR5 made weightless by three springs.

    Example: [bold]equipoise demo -o my-demo[/bold]
    """
    from ..demo import run

    with terminal.shown_warnings(), terminal.progress_bar("demo") as report:
        lines = run(folder, report)
    terminal.show(iter(lines))
