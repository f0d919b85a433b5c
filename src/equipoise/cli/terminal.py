"""What every command does with files and the terminal: results on standard output, messages on standard error."""

from __future__ import annotations

import json
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..model.errors import EquipoiseWarning, visible

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism
    from ..model.progress import Progress


def load(file: Path) -> Mechanism:
    from ..io import load

    with shown_warnings():
        return load(file)


def typed(context: typer.Context, option: str) -> bool:
    """Whether the option stands on the command line."""
    source = context.get_parameter_source(option)
    return source is not None and source.name == "COMMANDLINE"


@contextmanager
def shown_warnings() -> Iterator[None]:
    """Our warnings as lines on standard error."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", EquipoiseWarning)
        try:
            yield
        finally:
            for warning in caught:
                say(f"warning: {warning.message}")


@contextmanager
def progress_bar(start: str) -> Iterator[Progress]:
    """A progress bar on standard error, when that is a terminal, for work of more than a second."""
    from rich import progress

    from ..report.text import console

    screen = console(stderr=True)
    columns = (progress.TextColumn("{task.description}"), progress.BarColumn(), progress.TimeElapsedColumn())
    with progress.Progress(*columns, console=screen, transient=True, disable=not screen.is_terminal) as bar:
        task = bar.add_task(start, total=1.0)
        yield lambda what, share: bar.update(task, description=what, completed=share, total=1.0 if share else None)


@contextmanager
def solver_aside() -> Iterator[None]:
    """A solver prints lines of its own to the file number 1, now and then: to standard error with them."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        os.dup2(2, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def show(lines: Iterator[Any]) -> None:
    from ..report.text import console

    screen = console()
    for line in lines:
        screen.print(line)


def print_json(value: Any) -> None:
    typer.echo(json.dumps(value, indent=2, allow_nan=False, ensure_ascii=False))


def say(text: str) -> None:
    typer.echo(visible(text, "\t\n"), err=True)
