"""One error family: all that this package raises is an `EquipoiseError` whose message says what to change."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import isfinite

Path = tuple[str | int, ...]  # where in a file: ("joints", 2, "parent")
SHOWN = 20  # faults of one input; the others are counted
COUNTED = 200  # faults of one input that are looked for: each is compared with all names
LONGEST = 500  # characters of one message and of one list of choices
COMPARED = 200  # names that a misspelt one is compared with, those of its own length first


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
        text = ": ".join(visible(shortened(part)) for part in (place, self.field, self.message) if part)
        if self.choices:
            text += f" (valid: {visible(shortened(', '.join(self.choices)))})"
        if self.source is not None:
            text += f"\n    {self.line} | {visible(self.source.rstrip())}"
        return text

    def at(self, file: str, line: int | None = None, column: int | None = None, source: str | None = None) -> Fault:
        """The same fault with its place in a file."""
        return replace(self, file=file, line=line, column=column, source=source)


class InputError(EquipoiseError, ValueError):
    """A file, an option, an array or a mechanism that cannot be used. `faults` lists everything that is wrong with it.

    It is a `ValueError` too, which is what Python calls a bad argument.
    """

    def __init__(self, faults: Iterable[Fault] | Fault | str) -> None:
        if isinstance(faults, str):
            faults = Fault((), faults)
        self.faults: tuple[Fault, ...] = (faults,) if isinstance(faults, Fault) else tuple(faults)
        lines = [str(fault) for fault in self.faults[:SHOWN]]
        if len(self.faults) > SHOWN:
            least = "at least " if len(self.faults) >= COUNTED else ""
            lines.append(f"and {least}{len(self.faults) - SHOWN} more")
        super().__init__("\n".join(lines))


class UnsupportedError(EquipoiseError):
    """The input is valid, but this operation does not cover it."""


class NoFourierForm(UnsupportedError):
    """The energy has no finite Fourier form, or one that is too long; the message says which."""


class InfeasibleError(EquipoiseError):
    """What was asked for does not exist; the message says why."""

    exit_code = 1


def visible(text: str, kept: str = "\t") -> str:
    """The text with what a terminal would obey, or nobody would see, written out: ``\\x1b``; what is `kept` stays."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in kept else c.encode("unicode_escape").decode() for c in text)


def shortened(text: str, most: int = LONGEST) -> str:
    """The text, cut where it is longer than `most` characters."""
    return text if len(text) <= most else text[: most - 3] + "..."


def nearest(found: object, choices: Iterable[str]) -> str:
    """`'sholder'; did you mean 'shoulder'?` when one of the choices is close, else just the quoted text."""
    text = shortened(str(found), 100)
    near = sorted(choices, key=lambda choice: abs(len(choice) - len(text)))[:COMPARED]  # comparing is slow
    close = difflib.get_close_matches(text, near, n=1)
    return f"'{text}'; did you mean '{close[0]}'?" if close else f"'{text}'"


def shorten(names: Sequence[str], most: int = 12) -> tuple[str, ...]:
    """The first names and how many more there are."""
    return tuple(names) if len(names) <= most else (*names[:most], f"... {len(names) - most} more")


def finite(path: Path, values: Iterable[float] | float) -> Iterator[Fault]:
    """A fault where a number, or one of several, is infinite or no number."""
    values = (values,) if isinstance(values, (int, float)) else values
    if not all(isfinite(value) for value in values):
        yield Fault(path, "must be finite")


INSTEAD = {
    "mass": "; where something lifts, as buoyancy does, give the mass less what is lifted",
}
"""Of a field, what a negative value is meant to say, and how to say it."""


def at_least(path: Path, value: float, low: float, unit: str) -> Iterator[Fault]:
    """A fault where a number is below `low`, infinite or no number."""
    if not (isfinite(value) and value >= low):
        yield Fault(path, f"must be at least {low:g} {unit}, found {value:g}{INSTEAD.get(str(path[-1]), '')}")


def positive(path: Path, value: float, unit: str) -> Iterator[Fault]:
    """A fault where a number is not above zero, infinite or no number."""
    if not (isfinite(value) and value > 0):
        yield Fault(path, f"must be more than 0 {unit}, found {value:g}")


def known(path: Path, name: str | None, what: str, choices: Sequence[str]) -> Iterator[Fault]:
    """A fault where a name is none of the choices; `what` says of what, "body"."""
    if name is not None and name not in choices:
        yield Fault(path, f"there is no {what} {nearest(name, choices)}", shorten(choices))
