"""Lists as vendors write them: their own heads and units, decimal commas, and nothing about the kind."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from io import StringIO
from pathlib import Path

from ...io.files import write_text
from ...model.units import quantity
from .part import Stock
from .parts import COLUMNS

INCH = {
    "part": ("Part number", ""),
    "rate": ("Spring rate", "lbf/in"),
    "max_force": ("Max. load", "lbf"),
    "initial_tension": ("Initial tension", "lbf"),
    "free_length": ("Free length", "in"),
    "outer_diameter": ("Outside diameter", "in"),
    "wire_diameter": ("Wire diameter", "in"),
    "mass": ("Weight", "oz"),
    "price": ("Price each", ""),
}
METRIC = {
    "part": ("Art.-Nr.", ""),
    "rate": ("R", "N/mm"),
    "max_force": ("Fn", "N"),
    "initial_tension": ("F0", "N"),
    "free_length": ("L0", "mm"),
    "outer_diameter": ("De", "mm"),
    "wire_diameter": ("d", "mm"),
    "mass": ("Gewicht", "g"),
    "price": ("Preis", ""),
}
FORMS = {"inch": (INCH, ",", "."), "metric": (METRIC, ";", ",")}
"""Heads and units, what separates cells, and the decimal sign."""


def write_as(catalogue: Iterable[Stock], path: Path, form: str) -> None:
    """Write a list in one of `FORMS`."""
    heads, separator, point = FORMS[form]
    text = StringIO()
    writer = csv.writer(text, delimiter=separator, lineterminator="\n")
    writer.writerow([_head(name, form) for name in heads])
    factor = {name: quantity(f"1 {unit}", COLUMNS[name][0], name) if unit else 1.0 for name, (_, unit) in heads.items()}
    for one in catalogue:
        cells = [getattr(one, name) for name in heads]
        rounded = [c if isinstance(c, str) else f"{c / factor[n]:.6g}" for c, n in zip(cells, heads, strict=True)]
        writer.writerow([rounded[0], *(cell.replace(".", point) for cell in rounded[1:])])
    write_text(path, text.getvalue())


def read_with(form: str) -> str:
    """The options that read such a list."""
    heads = FORMS[form][0]
    return " ".join([*(f'--column "{name}={heads[name][0]}"' for name in heads), "--column kind=extension"])


def _head(name: str, form: str) -> str:
    head, unit = FORMS[form][0][name]
    unit = unit.replace("lbf", "lb")
    return f"{head} [{unit}]" if unit else head
