"""What a reader of model files leaves out or takes for granted: one warning for each kind, with names and lines."""

from __future__ import annotations

import warnings
from collections import defaultdict

from ..model.errors import EquipoiseWarning, Fault, InputError

NAMES_SHOWN = 8  # names in one warning; the others are counted


class Notes:
    """Collects them, and the faults beside them, while one file is read.

    Attributes:
        file: its name, for messages.
        faults: why it cannot be read at all.
    """

    def __init__(self, file: str) -> None:
        self.file = file
        self.faults: list[Fault] = []
        self._found: dict[str, list[str]] = defaultdict(list)

    def note(self, what: str, message: str, line: int | None = None) -> None:
        """`what`, such as "joint 'elbow'", is read otherwise than it stands there: `message` says how."""
        self._found[message].append(what if line is None else f"{what} (line {line})")

    def refuse(self, what: str, message: str, line: int | None = None) -> None:
        """`what` cannot be read: `message` goes on with why, and what to do."""
        self.faults.append(Fault((), f"{what} {message}", file=self.file, line=line))

    def close(self) -> None:
        """Raise an error with the faults, or give the warnings.

        Raises:
            InputError: there are faults.
        """
        if self.faults:
            raise InputError(self.faults)
        for message, names in self._found.items():
            more = f" and {len(names) - NAMES_SHOWN} more" if len(names) > NAMES_SHOWN else ""
            listed = ", ".join(names[:NAMES_SHOWN])
            warnings.warn(str(Fault((listed + more,), message, file=self.file)), EquipoiseWarning, stacklevel=4)
