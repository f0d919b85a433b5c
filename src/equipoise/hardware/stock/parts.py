"""Springs that are in stock: a table of one row per spring, as CSV or Parquet.

The columns are `COLUMNS`. A header may state a unit in brackets, ``rate [N/mm]``; without one the column is in SI
units. A vendor's own table is read by saying which of its columns is which.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from io import StringIO
from math import isfinite
from pathlib import Path
from typing import Any

from ...io.files import write_bytes, write_text
from ...io.tables import csv_rows, heading, parquet_bytes, parquet_columns
from ...model.errors import Fault, InputError, nearest
from ...model.units import SI_UNITS, quantity
from ...model.validate import printable

COLUMNS = {
    "part": ("text", "what it is ordered by; must be unique"),
    "kind": ("text", "extension or compression"),
    "rate": ("stiffness", "R"),
    "max_force": ("force", "F_n, the largest it may bear"),
    "initial_tension": ("force", "F_0 of an extension spring; 0 when the column is missing"),
    "free_length": ("length", "L_0"),
    "outer_diameter": ("length", "D_e"),
    "wire_diameter": ("length", "d"),
    "mass": ("mass", "of one spring"),
    "price": ("number", "of one spring, in any currency; 0 when the column is missing"),
}
"""Name of each column: its dimension and meaning."""

OPTIONAL = ("initial_tension", "price")
KINDS = ("extension", "compression")
LONGEST_LIST = 100_000  # springs


@dataclass(frozen=True)
class Stock:
    """A spring that is in stock, in SI units; see `COLUMNS`."""

    part: str
    kind: str
    rate: float
    max_force: float
    free_length: float
    outer_diameter: float
    wire_diameter: float
    mass: float
    initial_tension: float = 0.0
    price: float = 0.0

    @property
    def stroke(self) -> float:
        """[m] that it may be stretched or compressed."""
        return (self.max_force - self.initial_tension) / self.rate


Catalogue = tuple[Stock, ...]


def read_catalogue(path: str | Path, columns: Mapping[str, str] | None = None) -> Catalogue:
    """A catalogue from a CSV or Parquet file.

    Args:
        columns: for a name of `COLUMNS` the header it has in the file; a unit in brackets after the header, as in
            ``R [N/mm]``, overrides what the file says or leaves open.

    Raises:
        InputError: the file cannot be read, a column is missing, or values are wrong: all faults at once.
    """
    path = Path(path)
    header, rows = _parquet(path) if path.suffix.lower() == ".parquet" else _csv(path)
    places, faults = _places(header, dict(columns or {}))
    if not rows:
        faults.append(Fault((), "has no springs"))
    found: list[Stock] = []
    if not faults:
        for number, row in enumerate(rows, start=2):
            try:
                found.append(_stock(row, places))
            except InputError as error:
                faults += [replace(fault, line=number) for fault in error.faults]
        seen: set[str] = set()
        for number, one in enumerate(found, start=2):
            if one.part in seen:
                faults.append(Fault(("part",), f"'{one.part}' is there twice", line=number))
            seen.add(one.part)
    if faults:
        raise InputError([fault.at(str(path), fault.line) for fault in faults[:SHOWN]])
    return tuple(found)


SHOWN = 20  # faults of one file


def write_catalogue(catalogue: Iterable[Stock], path: str | Path) -> None:
    """Write a catalogue as CSV or Parquet, by the name's ending, in SI units with the units in the header."""
    path, catalogue = Path(path), tuple(catalogue)
    table = {_header(name): [getattr(one, name) for one in catalogue] for name in COLUMNS}
    if path.suffix.lower() == ".parquet":
        write_bytes(path, parquet_bytes(table))
        return
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table)
    writer.writerows(zip(*table.values(), strict=True))
    write_text(path, text.getvalue())


def _header(name: str) -> str:
    unit = SI_UNITS.get(COLUMNS[name][0], "")
    return f"{name} [{unit}]" if unit else name


def _csv(path: Path) -> tuple[list[str], list[list[Any]]]:
    (_, header), *rows = csv_rows(path, LONGEST_LIST)
    return header, [row for _, row in rows]


def _parquet(path: Path) -> tuple[list[str], list[list[Any]]]:
    columns = parquet_columns(path, LONGEST_LIST)
    return list(columns), [list(row) for row in zip(*columns.values(), strict=True)]


Column = tuple[int, float]  # column in the file, and what its numbers are multiplied by


def _places(header: list[str], columns: dict[str, str]) -> tuple[dict[str, Column], list[Fault]]:
    bare = {heading(text)[0]: (i, heading(text)[1]) for i, text in enumerate(header)}
    places: dict[str, Column] = {}
    faults = [
        Fault((name,), f"no column {nearest(name, COLUMNS)}", tuple(COLUMNS)) for name in columns.keys() - COLUMNS
    ]
    for name, (dimension, _) in COLUMNS.items():
        wanted, override = heading(columns.get(name, name))
        if wanted not in bare:
            if name in OPTIONAL and name not in columns:
                continue
            faults.append(Fault((name,), f"the file has no column {nearest(wanted, bare)}", tuple(bare)))
            continue
        place, unit = bare[wanted]
        unit = override or unit
        try:
            factor = quantity(f"1 {unit}", dimension, name) if unit and dimension != "text" else 1.0
        except InputError as error:
            faults += error.faults
            continue
        places[name] = place, factor
    return places, faults


def _stock(row: list[Any], places: Mapping[str, Column]) -> Stock:
    values: dict[str, Any] = {}
    for name, (place, factor) in places.items():
        cell = row[place] if place < len(row) else ""
        if COLUMNS[name][0] == "text":
            values[name] = str(cell).strip()
        else:
            values[name] = _number(name, cell) * factor
    if not values["part"]:
        raise InputError(Fault(("part",), "is missing"))
    if not printable(values["part"]):
        raise InputError(Fault(("part",), f"has a character that cannot be printed: {values['part']!a}"))
    if values["kind"] not in KINDS:
        raise InputError(Fault(("kind",), f"unknown {nearest(values['kind'], KINDS)}", KINDS))
    for name in (f.name for f in fields(Stock) if f.name in values and f.name not in ("part", "kind")):
        least = 0.0 if name in OPTIONAL else 1e-12
        if not values[name] >= least:
            limit = "at least" if name in OPTIONAL else "more than"
            raise InputError(Fault((name,), f"must be {limit} 0, found {values[name]:g}"))
    if values.get("initial_tension", 0.0) >= values["max_force"]:
        raise InputError(Fault(("initial_tension",), "must be less than max_force"))
    return Stock(**values)


def _number(name: str, cell: Any) -> float:
    try:
        value = float(cell)
    except (TypeError, ValueError):
        raise InputError(Fault((name,), f"expected a number, found '{cell}'")) from None
    if not isfinite(value):
        raise InputError(Fault((name,), f"expected a finite number, found '{cell}'"))
    return value
