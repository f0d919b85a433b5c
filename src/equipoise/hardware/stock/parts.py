"""Springs that are in stock: a table of one row per spring, as CSV or Parquet.

The columns are `COLUMNS`. A header may state a unit in brackets, ``rate [N/mm]``; without one the column is in SI
units. A vendor's own table is read by saying which of its columns is which, and what is the same for all its springs.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields, replace
from io import StringIO
from math import inf, isfinite
from pathlib import Path
from typing import Any

from ...io.files import write_bytes, write_text
from ...io.tables import csv_rows, heading, parquet_bytes, parquet_columns
from ...model.errors import Fault, InputError, nearest
from ...model.units import SI_UNITS, quantity
from ...model.validate import printable
from ..sizing.wire import WIRES
from .part import Catalogue, Stock

LARGEST = 1e12  # of any number of a part: no spring is so large, stiff or strong
COLUMNS = {
    "part": ("text", "what it is ordered by; must be unique"),
    "kind": ("text", "extension, compression, gas or torsion"),
    "rate": ("stiffness", "R of an extension or compression spring"),
    "max_force": ("force", "F_n, the largest it may bear; of a gas spring the force when it is pushed in"),
    "initial_tension": ("force", "F_0 of an extension spring; 0 when the column is missing"),
    "free_length": ("length", "L_0; of a gas spring the extended length"),
    "outer_diameter": ("length", "D_e"),
    "wire_diameter": ("length", "d"),
    "mass": ("mass", "of one spring"),
    "price": ("number", "of one spring, in any currency; 0 when the column is missing"),
    "max_length": ("length", "the longest that it may be, where that is less than max_force allows"),
    "min_length": ("length", "the shortest that it may be: solid, or pushed in"),
    "wire": ("text", "grade of its wire; EN 10270-1 SH when the column is missing"),
    "force": ("force", "of a gas spring when it is extended"),
    "progression": ("number", "of a gas spring: max_force over force"),
    "torsional_rate": ("torsional stiffness", "of a torsion spring"),
    "max_torque": ("torque", "of a torsion spring"),
}
"""Name of each column: its dimension and meaning."""

KINDS = ("extension", "compression", "gas", "torsion")
NEEDS = {
    "extension": ("rate", "max_force", "free_length", "outer_diameter", "wire_diameter", "mass"),
    "compression": ("rate", "max_force", "free_length", "outer_diameter", "wire_diameter", "mass"),
    "gas": ("force", "free_length", "min_length", "mass"),
    "torsion": ("torsional_rate", "max_torque", "mass"),
}
"""What a list must say of each kind; of a gas spring `max_force` or `progression` besides."""
MAY_BE_NOTHING = ("initial_tension", "price", "min_length")
LONGEST_LIST = 100_000  # springs
POUND = re.compile(r"\blbs?\b")
THOUSANDS = re.compile(r"[+-]?\d{1,3}(,\d{3})+(\.\d+)?")


def read_catalogue(path: str | Path, columns: Mapping[str, str] | None = None) -> Catalogue:
    """A catalogue from a CSV or Parquet file.

    Args:
        columns: for a name of `COLUMNS` the header it has in the file; a unit in brackets after the header, as in
            ``R [N/mm]``, overrides what the file says or leaves open. What is no header is the same for all springs:
            ``kind`` extension, ``mass`` 10 g.

    Raises:
        InputError: the file cannot be read, a column is missing, or values are wrong: all faults at once.
    """
    path = Path(path)
    header, rows = _parquet(path) if path.suffix.lower() == ".parquet" else _csv(path)
    places, constants, faults = _places(header, dict(columns or {}))
    if not rows:
        faults.append(Fault((), "has no springs"))
    found: list[Stock] = []
    if not faults:
        for number, row in enumerate(rows, start=2):
            try:
                found.append(_stock(row, places, constants))
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
    said = [
        f.name for f in fields(Stock) if f.default is MISSING or any(getattr(s, f.name) != f.default for s in catalogue)
    ]
    first = {name: None for kind in dict.fromkeys(one.kind for one in catalogue) for name in NEEDS[kind]}
    table = {_header(name): [getattr(one, name) for one in catalogue] for name in COLUMNS if name in (*said, *first)}
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


Column = tuple[int, str]  # column in the file, and the unit of its numbers


def _places(header: list[str], columns: dict[str, str]) -> tuple[dict[str, Column], dict[str, Any], list[Fault]]:
    """Where each name stands in the file, what is the same for all springs, and what is wrong."""
    exact = {text.strip(): i for i, text in enumerate(header)}
    bare = {heading(text)[0]: i for i, text in reversed(list(enumerate(header)))}
    places: dict[str, Column] = {}
    constants: dict[str, Any] = {}
    faults = [
        Fault((name,), f"no column {nearest(name, COLUMNS)}", tuple(COLUMNS)) for name in columns.keys() - COLUMNS
    ]
    for name, (dimension, _) in COLUMNS.items():
        given = columns.get(name, name)
        wanted, override = heading(given)
        place = exact.get(given.strip(), bare.get(wanted))
        if place is None:
            if name in columns:
                try:
                    constants[name] = _value(name, given)
                except InputError:
                    text = f"the file has no column {nearest(wanted, bare)}, and it is no {dimension} for all springs"
                    faults.append(Fault((name,), text, tuple(bare)))
            continue
        unit = (override if given.strip() not in exact else "") or heading(header[place])[1]
        try:
            if unit and dimension != "text":
                _si(f"1 {unit}", dimension, name)
        except InputError as error:
            faults += error.faults
            continue
        places[name] = place, unit
    known = places.keys() | constants.keys()
    kinds = {str(constants["kind"])} if "kind" in constants else set()
    missing = [name for name in ("part", "kind") if name not in known]
    missing += [name for kind in kinds & NEEDS.keys() for name in NEEDS[kind] if name not in known]
    for name in missing:
        how = f'say which it is, --column {name}=HEADER, or what holds for all, --column "{name}={_example(name)}"'
        faults.append(Fault((name,), f"the file has no column {nearest(name, bare)}; {how}", tuple(bare)))
    return places, constants, faults


def _example(name: str) -> str:
    return {"kind": "extension", "mass": "10 g"}.get(name, f"VALUE {SI_UNITS.get(COLUMNS[name][0], '')}".rstrip())


def _stock(row: list[Any], places: Mapping[str, Column], constants: Mapping[str, Any]) -> Stock:
    values: dict[str, Any] = dict(constants)
    for name, (place, unit) in places.items():
        cell = row[place] if place < len(row) else ""
        if cell in ("", None) and name not in ("part", "kind"):
            continue  # another kind's, or missing: that is told below
        values[name] = _value(name, cell, unit)
    if not values.get("part"):
        raise InputError(Fault(("part",), "is missing"))
    if not printable(values["part"]):
        raise InputError(Fault(("part",), f"has a character that cannot be printed: {values['part']!a}"))
    kind = values["kind"] = re.sub(r"[\s_-]*springs?$", "", values["kind"].lower())
    if kind not in KINDS:
        raise InputError(Fault(("kind",), f"unknown {nearest(values['kind'], KINDS)}", KINDS))
    for name in NEEDS[kind]:
        if name not in values:
            how = "" if name in places else f'; say what holds for all, --column "{name}={_example(name)}"'
            raise InputError(Fault((name,), f"expected a number, found ''{how}"))
    for name in (f.name for f in fields(Stock) if f.name in values and COLUMNS[f.name][0] != "text"):
        least = 0.0 if name in MAY_BE_NOTHING or name not in NEEDS[kind] else 1e-12
        if not values[name] >= least:
            limit = "more than" if least else "at least"
            raise InputError(Fault((name,), f"must be {limit} 0, found {values[name]:g}"))
        if values[name] > LARGEST and values[name] != inf:
            raise InputError(Fault((name,), f"must be at most {LARGEST:g} in SI units, found {values[name]:g}"))
    if values.get("wire") and values["wire"] not in WIRES:
        raise InputError(Fault(("wire",), f"unknown grade {nearest(values['wire'], WIRES)}", tuple(WIRES)))
    if kind == "gas":
        values |= _gas(values)
    elif kind != "torsion" and values.get("initial_tension", 0.0) >= values["max_force"]:
        raise InputError(Fault(("initial_tension",), "must be less than max_force"))
    return Stock(**values)


def _gas(values: Mapping[str, Any]) -> dict[str, float]:
    """What a gas spring's columns say together."""
    first, most, times = values["force"], values.get("max_force", 0.0), values.get("progression", 0.0)
    if not most and not times:
        raise InputError(Fault(("progression",), "a gas spring needs max_force or progression"))
    most = most or first * times
    if most < first or values["min_length"] >= values["free_length"]:
        raise InputError(Fault(("force",), "a gas spring pushes no less and is shorter when it is pushed in"))
    rate = (most - first) / (values["free_length"] - values["min_length"])
    return {"max_force": most, "progression": most / first, "rate": rate}


def _value(name: str, cell: Any, unit: str = "") -> Any:
    """A cell in SI units, or its text."""
    dimension = COLUMNS[name][0]
    if dimension == "text":
        return str(cell).strip()
    text = cell if isinstance(cell, (int, float)) else _point(str(cell))
    try:
        value = float(text)
    except (TypeError, ValueError):
        value = None
    if value is not None and not isfinite(value):
        raise InputError(Fault((name,), f"expected a finite number, found '{cell}'"))
    if value is not None:
        return value * (_si(f"1 {unit}", dimension, name) if unit else 1.0)
    try:  # with a unit of its own
        return _si(str(text), dimension, name)
    except InputError:
        raise InputError(Fault((name,), f"expected a number, found '{cell}'")) from None


def _si(text: str, dimension: str, name: str) -> float:
    """A quantity; the pound of a force is a force."""
    return quantity(POUND.sub("lbf", text) if dimension in ("force", "stiffness", "torque") else text, dimension, name)


def _point(text: str) -> str:
    """A number with a decimal comma as one with a point; commas between thousands are left out."""
    text = text.strip()
    number = text.split(" ")[0]
    if THOUSANDS.fullmatch(number) and "." in number:
        return text.replace(",", "")
    if "," in number and "." in number:
        return text.replace(".", "").replace(",", ".", 1)
    return text.replace(",", ".", 1) if number.count(",") == 1 else text
