"""The application that the commands register with, and the arguments that most of them have."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

from .._version import __version__

File = Annotated[Path, typer.Argument(help="mechanism file: .yaml, .urdf, .mjcf or .xml", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="print one JSON object on standard output")]
READING: dict[str, Any] = {
    "strict": Annotated[bool, typer.Option("--strict", help="what looks like a slip in the file is bad input")],
    "base": Annotated[
        str | None,
        typer.Option(metavar="fixed|free", help="hold a model's floating base where it is drawn, or let it go"),
    ],
}
"""Options of every command that reads a mechanism file: `reading` has what was given to the one that runs."""
reading: dict[str, Any] = {"strict": False, "base": None}


class _App(typer.Typer):
    def command(self, *args: Any, **kwargs: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
        register = super().command(*args, **kwargs)

        def add(function: Callable[..., None]) -> Callable[..., None]:
            signature = inspect.signature(function, eval_str=True)
            if "file" not in signature.parameters:
                return register(function)

            @wraps(function)
            def run(*given: Any, **options: Any) -> None:
                reading.update({key: options.pop(key) for key in READING})
                function(*given, **options)

            more = [
                inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=READING[key])
                for key, default in reading.items()
            ]
            run.__signature__ = signature.replace(parameters=[*signature.parameters.values(), *more])  # type: ignore[attr-defined]
            run.__annotations__ = {p.name: p.annotation for p in run.__signature__.parameters.values()}  # type: ignore[attr-defined]
            register(run)
            return function

        return add


app = _App(
    name="equipoise",
    help="Design the springs that make a robot weightless, and prove it.",
    no_args_is_help=True,
    add_completion=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


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
