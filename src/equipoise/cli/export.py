"""`equipoise export`: a mechanism in another format."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..model.errors import InputError
from . import terminal
from .app import File, app

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism

DRAWINGS = {"svg": "equipoise.report.schematic", "dxf": "equipoise.report.attachments"}


@app.command()
def export(
    file: File,
    to: Annotated[str, typer.Option("--to", help="yaml, urdf, mjcf, svg or dxf", show_default=False)],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="default: standard output")] = None,
) -> None:
    """Write a mechanism in another format, or as a drawing.

    Springs become spatial tendons in MJCF and are left out of URDF. SVG is a schematic with the letters a, b and k;
    DXF has the attachment points in mm and needs the extra: pip install 'equipoise\\[cad]'.

    Example: [bold]equipoise export ur5-balanced.yaml --to mjcf -o ur5.xml[/bold]
    Example: [bold]equipoise export ur5-balanced.yaml --to svg -o ur5.svg[/bold]
    """
    from importlib import import_module

    from ..io import WRITERS
    from ..io.files import check_writable, write_text
    from ..model.errors import Fault, nearest

    modules = {name: f"equipoise.io.{name}" for name in WRITERS} | DRAWINGS
    if to not in modules:
        raise InputError(Fault(("--to",), f"unknown format {nearest(to, modules)}", tuple(modules)))
    if output is not None:
        check_writable(output)
    with terminal.shown_warnings():
        mechanism = terminal.load(file, weightless=True)
        write = import_module(modules[to]).to_text
        text = write(*assembled(mechanism)) if to == "mjcf" else write(mechanism)
    if output is None:
        typer.echo(text, nl=False)
    else:
        write_text(output, text)
        terminal.say(f"wrote {output}")


def assembled(mechanism: Mechanism) -> tuple[Mechanism, dict[str, float] | None]:
    """With the coordinates that steer its loops, and a pose in which they close."""
    from ..kinematics import Tree
    from ..kinematics.linkage import Linkage

    tree = Tree.of(mechanism)
    if not isinstance(tree, Linkage):
        return mechanism, None
    pose: dict[str, float] = dict(zip(tree.open.coordinates, tree.branch.assembled.tolist(), strict=True))
    return replace(mechanism, independent=tree.coordinates), pose
