"""How long work says how far it is."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, float], None]
"""Called with what is being done, and the share of it that is done: 0 where that is not known, 1 at the end."""


def silent(what: str, share: float) -> None:
    """For those who do not ask."""
