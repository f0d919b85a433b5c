"""`equipoise export`: a mechanism in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..model.errors import Fault, InputError, nearest
from . import terminal
from .app import File, app


@app.command()
def export(
    file: File,
    to: Annotated[
        str, typer.Option("--to", help="yaml, urdf, mjcf, svg, dxf, sheet, sheet-dxf or order", show_default=False)
    ],
    cam: Annotated[str | None, typer.Option("--cam", help="svg or dxf: the profile of this cam, to cut")] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="default: standard output")] = None,
) -> None:
    """Write a mechanism in another format, or as a drawing.

    Springs become spatial tendons in MJCF and are left out of URDF. SVG is a schematic with the letters a, b and k;
    DXF has the attachment points in mm and needs the extra: pip install 'equipoise\\[cad]'. For a workshop, sheet (SVG)
    and sheet-dxf draw every body's attachment points with dimensions, order lists what to order as CSV.

    Example: [bold]equipoise export ur5-balanced.yaml --to mjcf -o ur5.xml[/bold]
    Example: [bold]equipoise export ur5-balanced.yaml --to svg -o ur5.svg[/bold]
    Example: [bold]equipoise export lamp.yaml --to dxf --cam "elbow cam" -o cam.dxf[/bold]
    """
    from ..io.files import check_writable, write_text
    from ..report.export import FORMATS
    from ..report.export import export as written

    if to not in FORMATS:
        raise InputError(Fault(("--to",), f"unknown format {nearest(to, FORMATS)}", tuple(FORMATS)))
    if output is not None:
        check_writable(output)
    with terminal.shown_warnings():
        text = written(terminal.load(file, weightless=True), to, cam=cam)
    if output is None:
        typer.echo(text, nl=False)
    else:
        write_text(output, text)
        terminal.say(f"wrote {output}")
