"""Motions and poses from CSV files: a column for each coordinate, and one of times or shares."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

import numpy as np

from ..model.arrays import Array
from ..model.coordinate import Coordinate
from ..model.errors import Fault, InputError, nearest
from ..model.motion import USABLE, Listed, Motion, unusable
from ..model.units import to_si
from .tables import csv_rows, heading

LONGEST = 50_000  # rows of a table
Path = str | os.PathLike[str]


def read_motion(path: Path, coordinates: Sequence[Coordinate], stops: bool = False, share: float = 1.0) -> Motion:
    """A motion: the column ``time``, and one for each coordinate that does not rest, such as ``elbow [deg]``.

    Raises:
        InputError: the file cannot be read, a column that is no coordinate, a bad number, times that do not increase.
    """
    (at, *lines), names, values = _columns(path, coordinates, {"time": "time"})
    if "time" not in names:
        raise _fault(path, at, f"expected the columns 'time' and coordinates, each once, found {', '.join(names)}")
    time = values[:, names.index("time")]
    if len(time) < (2 if stops else 3) or (np.diff(time) <= 0).any():
        least = "two" if stops else "three"
        raise _fault(path, at, f"a motion has at least {least} times, in increasing order")
    if (odd := unusable(time, values)) is not None:
        raise _fault(path, lines[odd], f"is no motion: {USABLE}")
    moving = [name for name in names if name != "time"]
    own = values[:, [names.index(name) for name in moving]]
    try:
        return Motion(tuple(moving), tuple(time.tolist()), tuple(map(tuple, own.tolist())), stops, share)
    except InputError as error:
        raise _fault(path, at, error.faults[0].message) from None


def read_poses(path: Path, coordinates: Sequence[Coordinate]) -> Listed:
    """Poses: a column for each coordinate that is not at rest, and perhaps ``share``, what each counts.

    Raises:
        InputError: as `read_motion`, or a share that is not more than 0.
    """
    (at, *_), names, values = _columns(path, coordinates, {"share": "number"})
    moving = [name for name in names if name != "share"]
    shares = values[:, names.index("share")] if "share" in names else np.ones(len(values))
    own = values[:, [names.index(name) for name in moving]]
    try:
        return Listed(tuple(moving), tuple(map(tuple, own.tolist())), tuple(shares.tolist()))
    except InputError as error:
        raise _fault(path, at, error.faults[0].message) from None


def _columns(
    path: Path, coordinates: Sequence[Coordinate], beside: Mapping[str, str]
) -> tuple[list[int], list[str], Array]:
    """The lines of the head and of the rows, the names of the columns, and the numbers in SI units (rows, columns)."""
    (at, head), *body = csv_rows(path, LONGEST, ",")
    columns = [heading(cell) for cell in head]
    names, factors = [name for name, _ in columns], []
    dimensions = {**{str(c): c.dimension for c in coordinates}, **beside}
    for name, unit in columns:
        if name not in dimensions:
            choices = (*beside, *coordinates)
            raise _fault(path, at, f"no coordinate {nearest(name, coordinates)}", choices)
        try:
            factors.append(to_si(f"1 {unit}", dimensions[name]) if unit else 1.0)
        except ValueError as error:
            raise _fault(path, at, f"column '{name}': {error}") from None
    if len(set(names)) < len(names):
        found = ", ".join(names)
        raise _fault(path, at, f"expected the columns '{next(iter(beside))}' and coordinates, each once, found {found}")
    values = np.zeros((len(body), len(names)))
    for i, (line, row) in enumerate(body):
        try:
            values[i] = [float(cell) for cell in row]
        except ValueError:
            raise _fault(path, line, f"expected {len(names)} numbers, found '{','.join(row)}'") from None
        if not np.isfinite(values[i]).all():
            raise _fault(path, line, "must be finite")
    return [at, *(line for line, _ in body)], names, values * factors


def _fault(path: Path, line: int, message: str, choices: tuple[str, ...] = ()) -> InputError:
    return InputError(Fault((), message, choices, file=os.fspath(path), line=line))
