"""Names that are used once."""

from __future__ import annotations

from collections.abc import Iterable


class Names:
    """The names one kind of element has already used."""

    def __init__(self, used: Iterable[str] = ()) -> None:
        self._used = set(used)

    def new(self, wanted: str) -> str:
        """The wanted name, with a number behind it when it is taken."""
        name, count = wanted, 1
        while name in self._used:
            count += 1
            name = f"{wanted}_{count}"
        self._used.add(name)
        return name
