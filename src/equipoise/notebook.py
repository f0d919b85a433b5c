"""Values that show themselves in notebooks.

What they show is drawn by `report`, a leaf that the core must not import. So it is found by name, and only when a
notebook asks.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any


class Shown:
    """A value whose class `report.notebook` knows how to draw."""

    def _repr_html_(self) -> str:
        return _drawn("html", self)

    def _repr_svg_(self) -> str:
        return _drawn("svg", self)


def _drawn(how: str, value: Any) -> str:
    return getattr(import_module("equipoise.report.notebook"), how)(value)
