"""The command line. Results go to standard output, messages to standard error.

Exit codes: 0 good, 1 the answer is "no" (not balanced, infeasible), 2 bad input. One file for each command; `terminal`
holds what they share, `options` reads the values that are typed.
"""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper

import typer

from ..errors import EquipoiseError
from . import (  # each registers its commands, in this order of the help
    adjust,
    check,
    clearance,
    demo,
    design,
    export,
    hardware,
    layouts,
    report,
    reproduce,
    simulate,
    tolerance,
    view,
)
from .app import app

__all__ = [
    "adjust",
    "app",
    "check",
    "clearance",
    "demo",
    "design",
    "export",
    "hardware",
    "layouts",
    "main",
    "report",
    "reproduce",
    "simulate",
    "tolerance",
    "view",
]


def main() -> None:
    """The entry point: errors become one message and an exit code, never a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that lacks a letter is no reason to fail
    try:
        app()
    except KeyboardInterrupt:
        typer.echo("interrupted", err=True)
        sys.exit(130)
    except EquipoiseError as error:
        typer.echo(f"error: {error}", err=True)
        sys.exit(error.exit_code)
    except BrokenPipeError:  # the reader of our output has closed it, `| head` for example
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except OSError as error:
        typer.echo(f"error: {(error.strerror or str(error)).lower()}", err=True)
        sys.exit(2)
    except Exception as error:
        if os.environ.get("EQUIPOISE_DEBUG"):
            raise
        text = f"internal error: {type(error).__name__}: {error}\nPlease report it; EQUIPOISE_DEBUG=1 shows where."
        typer.echo(text, err=True)
        sys.exit(2)
