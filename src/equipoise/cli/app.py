"""The application that the commands register with, and the arguments that most of them have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .._version import __version__

app = typer.Typer(
    name="equipoise",
    help="Design the springs that make a robot weightless, and prove it.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

File = Annotated[Path, typer.Argument(help="mechanism file: .yaml or .urdf", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="print one JSON object on standard output")]


def _version(value: bool) -> None:
    if value:
        typer.echo(f"equipoise {__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="print the version")
    ] = False,
) -> None: ...
