"""One error family. Every error a user can cause is an `EquipoiseError` with a message that says what to change."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, replace

Path = tuple[str | int, ...]  # where in a file: ("joints", 2, "parent")


class EquipoiseWarning(UserWarning):
    """Something in the input looks wrong but can be worked with."""


class SlipWarning(EquipoiseWarning):
    """Something in a valid mechanism looks like a slip: see `slips`."""


class EquipoiseError(Exception):
    """Base class. `exit_code` is what the command line returns: 2 bad input, 1 the answer is "no"."""

    exit_code = 2


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong in an input: which field, what was found, what is allowed.

    The reader of a file fills in `file`, `line`, `column` and `source` (the text of that line).
    """

    path: Path
    message: str
    choices: tuple[str, ...] = ()
    file: str | None = None
    line: int | None = None
    column: int | None = None
    source: str | None = None

    @property
    def field(self) -> str:
        """The path as a person writes it: ``joints[2].parent``."""
        return "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in self.path).lstrip(".")

    def __str__(self) -> str:
        place = ":".join(str(p) for p in (self.file, self.line, self.column) if p is not None)
        text = ": ".join(part for part in (place, self.field, self.message) if part)
        if self.choices:
            text += f" (valid: {', '.join(self.choices)})"
        if self.source is not None:
            text += f"\n    {self.line} | {self.source.rstrip()}"
        return text

    def at(self, file: str, line: int | None = None, column: int | None = None, source: str | None = None) -> Fault:
        """The same fault with its place in a file."""
        return replace(self, file=file, line=line, column=column, source=source)


class InputError(EquipoiseError):
    """A file, an option or a mechanism that cannot be used. `faults` lists everything that is wrong with it."""

    def __init__(self, faults: Iterable[Fault] | Fault | str) -> None:
        if isinstance(faults, str):
            faults = Fault((), faults)
        self.faults: tuple[Fault, ...] = (faults,) if isinstance(faults, Fault) else tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


class UnsupportedError(EquipoiseError):
    """The input is valid, but this operation does not cover it."""


class InfeasibleError(EquipoiseError):
    """What was asked for does not exist; the message says why."""

    exit_code = 1


def nearest(found: object, choices: Iterable[str]) -> str:
    """`'sholder'; did you mean 'shoulder'?` when one of the choices is close, else just the quoted text."""
    close = difflib.get_close_matches(str(found), list(choices), n=1)
    return f"'{found}'; did you mean '{close[0]}'?" if close else f"'{found}'"
