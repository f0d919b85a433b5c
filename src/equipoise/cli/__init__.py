"""The command line. Results go to standard output, messages to standard error.

Exit codes: 0 good, 1 the answer is "no" (not balanced, infeasible), 2 bad input. One file for each command; `terminal`
holds what they share, `options` reads the values that are typed.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from io import TextIOWrapper
from typing import NoReturn

from ..model.errors import EquipoiseError, shortened
from . import (
    adjust,
    calibrate,
    certify,
    check,
    clearance,
    compare,
    demo,
    design,
    export,
    hardware,
    identify,
    layouts,
    report,
    reproduce,
    simulate,
    stock,
    study,
    terminal,
    tolerance,
    view,
)
from .app import app

__all__ = [
    "adjust",
    "app",
    "calibrate",
    "certify",
    "check",
    "clearance",
    "compare",
    "demo",
    "design",
    "export",
    "hardware",
    "identify",
    "layouts",
    "main",
    "report",
    "reproduce",
    "simulate",
    "stock",
    "study",
    "tolerance",
    "view",
]

ENDS = {128 + signal.SIGINT: "interrupted", 128 + signal.SIGTERM: "terminated"}
"""Exit codes of a command that is told to stop, and the last lines; what is being written is cleared up on the way."""


def main() -> None:
    """The entry point: errors become one message and an exit code, never a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that lacks a letter is no reason to fail
    before = signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
    try:
        _run()
    except KeyboardInterrupt:
        _end("interrupted", 128 + signal.SIGINT)
    except EquipoiseError as error:
        _end(f"error: {error}", error.exit_code)
    except BrokenPipeError:  # the reader of our output has closed it, `| head` for example
        _end("", 0)
    except OSError as error:
        _end(f"error: {(error.strerror or str(error)).lower()}", 2)
    except MemoryError:
        _end("error: there is not enough memory for that", 2)
    except Exception as error:
        if os.environ.get("EQUIPOISE_DEBUG"):
            raise
        text = f"internal error: {type(error).__name__}: {shortened(str(error))}"
        _end(f"{text}\nPlease report it; EQUIPOISE_DEBUG=1 shows where.", 2)
    finally:
        signal.signal(signal.SIGTERM, before)


def _run() -> None:
    """Run the command, and say what typer itself would end without a word."""
    try:
        app()
    except SystemExit as stop:
        if isinstance(stop.__context__, BrokenPipeError):
            _end("", 0)
        if isinstance(stop.code, int) and stop.code in ENDS:
            _end(ENDS[stop.code], stop.code)
        if sys.stdout is not None:
            sys.stdout.flush()  # here a full disk is still an error that can be said
        raise


def _end(text: str, code: int) -> NoReturn:
    """Write the last line and go."""
    with suppress(OSError):  # nobody listens any more
        if text:
            terminal.say(text)
    if sys.stdout is not None:
        try:
            sys.stdout.flush()
        except OSError:  # what it has not taken by now, it will not take
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)
