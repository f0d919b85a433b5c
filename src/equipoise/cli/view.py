"""`equipoise view`: look at a mechanism and change its springs in the browser."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from . import terminal
from .app import File, app


@app.command()
def view(
    file: File,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="what the button saves to (default: NAME-edited.yaml here)")
    ] = None,
    host: Annotated[
        str, typer.Option(help="address to listen on; any but this machine's own is warned of")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="the next free one is taken where it is in use")] = 8080,
    open_: Annotated[bool, typer.Option("--open/--no-open", help="open the page in the browser")] = True,
) -> None:
    """Interactive 3D in the browser: move it, change springs, design again, save. Stop it with Ctrl-C.

    Example: [bold]equipoise view ur5-balanced.yaml -o mine.yaml[/bold]
    """
    from ..viewer.server import Viewer

    mechanism = terminal.load(file, weightless=True)
    with terminal.shown_warnings():
        viewer = Viewer(mechanism, output or Path(f"{file.stem}-edited.yaml"), host=host, port=port, source=file)
    typer.echo(f"{mechanism.name} is at {viewer.url} - stop with Ctrl-C")
    if open_:
        import webbrowser

        webbrowser.open(viewer.url)
    try:
        while True:
            time.sleep(3600)
    finally:
        viewer.close()
