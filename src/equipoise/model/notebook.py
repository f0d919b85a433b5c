"""Values that show themselves, printed and in notebooks, as `report` says, which the core never imports."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Drawer = Callable[[Any], str]

_DRAWERS: dict[type, dict[str, Drawer]] = {}
_SUPPLIERS: list[Callable[[], object]] = []


def register(kind: type, **drawers: Drawer) -> None:
    """Say how values of a class are drawn: as `text`, `html` or `svg`."""
    _DRAWERS[kind] = drawers


def supplied_by(load: Callable[[], object]) -> None:
    """Have `load` called, which registers classes, when the first value is to be shown and not before."""
    _SUPPLIERS.append(load)


class Shown:
    """A value that prints as the command line shows it, and that a notebook draws, where its class is registered."""

    def __str__(self) -> str:
        return _drawn("text", self) or repr(self)

    def _repr_html_(self) -> str | None:
        return _drawn("html", self)

    def _repr_svg_(self) -> str | None:
        return _drawn("svg", self)


def _drawn(how: str, value: Any) -> str | None:
    while _SUPPLIERS:
        _SUPPLIERS.pop()()
    draw = _DRAWERS.get(type(value), {}).get(how)
    return None if draw is None else draw(value)
