"""What every command does with files and the terminal: results on standard output, messages on standard error."""

from __future__ import annotations

import json
import os
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..model.errors import EquipoiseWarning, visible
from .app import reading

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism
    from ..model.progress import Progress


def load(file: Path, *, weightless: bool = False) -> Mechanism:
    """The mechanism of a command's file; what looks wrong in it is said, and bad input with ``--strict``.

    Args:
        weightless: whether a mechanism will do in which nothing that moves has a mass.

    Raises:
        InputError: as `io.load`; something looks wrong and may not; nothing that moves has a mass.
    """
    from ..io import load
    from ..model import slips
    from ..model.errors import Fault, InputError

    with shown_warnings() as said:
        mechanism = load(file, base=reading["base"])
    if slips.weightless(mechanism) and not weightless:
        raise InputError(Fault((), "nothing that moves has a mass: there is nothing to balance", file=str(file)))
    if said and reading["strict"]:
        raise InputError(Fault((), f"{len(said)} warning{'s' * (len(said) > 1)}, and --strict", file=str(file)))
    return mechanism


def slip(messages: list[str]) -> None:
    """Say what looks like a slip on the command line.

    Raises:
        InputError: something does, and ``--strict`` is given.
    """
    from ..model.errors import InputError

    for message in messages:
        say(f"warning: {message}")
    if messages and reading["strict"]:
        raise InputError("a warning, and --strict")


def typed(context: typer.Context, option: str) -> bool:
    """Whether the option stands on the command line."""
    source = context.get_parameter_source(option)
    return source is not None and source.name == "COMMANDLINE"


@contextmanager
def shown_warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Our warnings as lines on standard error, when the block ends; gives the list that they are in then."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", EquipoiseWarning)
        try:
            yield caught
        finally:
            for warning in caught:
                say(f"warning: {warning.message}")


@contextmanager
def progress_bar(start: str) -> Iterator[Progress]:
    """A progress bar on standard error, when that is a terminal, for work of more than a second."""
    from ..report.text import console

    screen = console(stderr=True)
    if not screen.is_terminal:
        yield lambda what, share: None
        return
    from rich import progress  # slow to import, for nothing where nobody looks

    columns = (progress.TextColumn("{task.description}"), progress.BarColumn(), progress.TimeElapsedColumn())
    with progress.Progress(*columns, console=screen, transient=True) as bar:
        task = bar.add_task(start, total=1.0)
        yield lambda what, share: bar.update(task, description=what, completed=share, total=1.0 if share else None)


@contextmanager
def reports(bar: Progress, seconds: float) -> Iterator[Progress]:
    """A progress bar that is also told in lines on standard error, every so many seconds, when that is no terminal."""
    if sys.stderr.isatty():
        yield bar
        return
    last = time.monotonic()

    def tell(what: str, share: float) -> None:
        nonlocal last
        if time.monotonic() - last >= seconds:
            last = time.monotonic()
            say(what)

    yield tell


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
