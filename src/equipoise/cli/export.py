"""`equipoise export`: a mechanism in another format."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError
from . import terminal
from .app import File, app

if TYPE_CHECKING:
    from ..mechanism import Mechanism


@app.command()
def export(
    file: File,
    to: Annotated[str, typer.Option("--to", help="yaml, urdf or mjcf", show_default=False)],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="default: standard output")] = None,
) -> None:
    """Write a mechanism in another format; springs become spatial tendons in MJCF and are left out of URDF.

    Example: [bold]equipoise export ur5-balanced.yaml --to mjcf -o ur5.xml[/bold]
    """
    from importlib import import_module

    from ..errors import Fault, nearest
    from ..io import WRITERS
    from ..io.files import write_text

    if to not in WRITERS:
        raise InputError(Fault(("--to",), f"unknown format {nearest(to, WRITERS)}", tuple(WRITERS)))
    with terminal.shown_warnings():
        mechanism = terminal.load(file)
        write = import_module(f"equipoise.io.{to}").to_text
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
    pose = dict(zip(tree.open.coordinates, tree.branch.assembled.tolist(), strict=True))
    return replace(mechanism, independent=tree.coordinates), pose
