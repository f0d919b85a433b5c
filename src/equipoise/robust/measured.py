"""Measured torques: a CSV file with a column for each joint, and ``torque:JOINT`` or ``current:JOINT`` beside them."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np

from ..io.tables import csv_rows, heading
from ..kinematics import Tree
from ..kinematics.sampling import inside
from ..model.arrays import Array, Integers, frozen
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from ..model.units import to_si

MOST = 50_000  # rows
LOADS = ("torque", "current")


@frozen
class Measured:
    """What was measured.

    Attributes:
        q: (N, n) configurations [rad or m].
        joints: (m,) numbers of the coordinates whose load was measured.
        load: (N, m) what their motors held [N m or N].
    """

    q: Array
    joints: Integers
    load: Array


def read(path: str | os.PathLike[str], mechanism: Mechanism, constants: Mapping[str, float] | None = None) -> Measured:
    """Read a table of measurements.

    A head may have its unit in brackets, ``elbow [deg]``; without one it is in SI units. A joint without a column rests
    at zero, or where its loops are assembled.

    Args:
        constants: joint -> [N m/A or N/A] for a column ``current:JOINT``.

    Raises:
        InputError: the file cannot be read, a column that is nothing, no column of loads, or a bad number.
    """
    tree, name, known = Tree.of(mechanism), os.fspath(path), dict(constants or {})
    (at, head), *body = csv_rows(path, MOST)

    def fault(line: int, message: str, choices: tuple[str, ...] = ()) -> InputError:
        return InputError(Fault((), message, choices, file=name, line=line))

    valid = (*tree.coordinates, *(f"torque:{c}" for c in tree.coordinates))
    columns: list[tuple[str, int, float]] = []
    for cell in head:
        title, unit = heading(cell)
        what, colon, joint = title.partition(":")
        what, joint = (what.strip(), joint.strip()) if colon and what.strip() in LOADS else ("", title)
        if joint not in tree.coordinates:
            raise fault(at, f"no column {nearest(title, valid)}", valid)
        j = tree.coordinates.index(joint)
        coordinate = tree.coordinates[j]
        dimension = {"": coordinate.dimension, "torque": coordinate.load}.get(what, "")
        factor = known.get(joint, 0.0)
        if what == "current" and not factor:
            raise fault(at, f"column '{title}' needs its torque constant: --constant '{joint}=0.05 N m/A'")
        try:
            if what == "current":
                factor *= {"": 1.0, "A": 1.0, "mA": 1e-3}[unit]
            else:
                factor = to_si(f"1 {unit}", dimension) if unit else 1.0
        except (ValueError, KeyError):
            raise fault(
                at, f"column '{title}': '{unit}' is no unit of {dimension or 'current, which is A or mA'}"
            ) from None
        columns.append(("load" if what else "", j, factor))
    if len({column[:2] for column in columns}) < len(columns):
        raise fault(at, "a column is there twice, or a joint has both a torque and a current")
    if not any(what for what, _, _ in columns):
        raise fault(at, "no column of loads: expected torque:JOINT or current:JOINT", valid)
    values = np.zeros((len(body), len(columns)))
    for i, (line, row) in enumerate(body):
        try:
            values[i] = [float(cell) for cell in row]
        except ValueError:
            raise fault(line, f"expected {len(columns)} numbers, found '{','.join(row)}'") from None
        if not np.isfinite(values[i]).all():
            raise fault(line, "must be finite")
    values *= [factor for _, _, factor in columns]
    q = np.repeat(tree.rest[None], len(body), axis=0)
    for (what, j, _), column in zip(columns, values.T, strict=True):
        if not what:
            q[:, j] = column
    outside = np.flatnonzero(~inside(tree, q, 1e-2))
    if len(outside):
        raise fault(body[outside[0]][0], "is a pose outside the joint ranges; is the unit right? [deg] after the name")
    loads = [(j, column) for (what, j, _), column in zip(columns, values.T, strict=True) if what]
    return Measured(q, np.array([j for j, _ in loads], int), np.stack([column for _, column in loads], axis=1))
