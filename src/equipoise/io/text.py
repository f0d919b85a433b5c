"""Numbers as the writers of XML put them down: at full precision."""

from __future__ import annotations

from collections.abc import Iterable


def numbers(values: Iterable[float]) -> str:
    """The values with a space between, each the shortest text that reads back as the same number."""
    return " ".join(repr(float(value)).removesuffix(".0") for value in values)
