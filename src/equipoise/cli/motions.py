"""Motions asked for on the command line: moves of single joints, a paper's motion, or a table in a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..model.arrays import Array
from ..model.errors import Fault, InputError, nearest
from ..model.units import quantity

if TYPE_CHECKING:
    from ..kinematics import Tree
    from ..kinematics.motion import CubicMove

FRAMES = 401  # of moves

Motion = tuple[Array, Array]
"""(T,) times [s] and (T, n) independent coordinates [rad or m]."""


def of_moves(texts: Sequence[str], tree: Tree) -> Motion:
    """From ``JOINT:START:END:FROM:TO``, each a cubic from rest to rest between two times."""
    from ..kinematics.motion import follow

    moves = sorted((_move(text, tree) for text in texts), key=lambda one: one.start)
    time = np.linspace(min(one.start for one in moves), max(one.end for one in moves), FRAMES)
    return time, _placed(tree, [one.coordinate for one in moves], follow(tree.coordinates, moves, time))


def named(text: str, tree: Tree) -> Motion:
    """A paper's own motion, or a CSV file: the column ``time``, and one for each coordinate that does not rest.

    Raises:
        InputError: no such paper, the file cannot be read, a bad number, or a column that is no coordinate.
    """
    from ..reproduce import MOTIONS, motion

    if text in MOTIONS:
        _, time, coordinates, q = motion(text)
        missing = [name for name in coordinates if name not in tree.coordinates]
        if missing:
            message = f"the arm of {text} has '{missing[0]}', '{tree.mechanism.name}' has no such coordinate"
            raise InputError(Fault(("--motion",), message, tree.coordinates))
        full = np.zeros((len(time), tree.n))
        full[:, [tree.coordinates.index(name) for name in coordinates]] = q
        return time, _placed(tree, coordinates, full)
    if Path(text).suffix.lower() != ".csv":
        raise InputError(Fault(("--motion",), f"no motion {nearest(text, MOTIONS)}", (*MOTIONS, "a file .csv")))
    return _table(Path(text), tree)


def _placed(tree: Tree, moving: Sequence[str], q: Array) -> Array:
    """What does not move is at rest, where loops close."""
    return np.where([name in moving for name in tree.coordinates], q, tree.rest)


def _move(text: str, tree: Tree) -> CubicMove:
    from ..kinematics.motion import CubicMove
    from ..model.motion import USABLE, unusable

    parts = text.rsplit(":", 4)
    if len(parts) != 5:
        raise InputError(Fault(("--move",), f"expected JOINT:START:END:FROM:TO, found '{text}'"))
    name = parts[0].strip()
    if name not in tree.coordinates:
        raise InputError(Fault(("--move",), f"no coordinate {nearest(name, tree.coordinates)}", tree.coordinates))
    start, end = (quantity(part, "time", "--move") for part in parts[1:3])
    if end <= start:
        raise InputError(Fault(("--move",), f"must end after it starts, found {start:g} s to {end:g} s"))
    dimension = tree.coordinates[tree.coordinates.index(name)].dimension
    first, last = (quantity(part, dimension, "--move") for part in parts[3:])
    if unusable(np.array([start, end]), np.array([first, last])) is not None:
        raise InputError(Fault(("--move",), f"found '{text}': {USABLE}"))
    return CubicMove(name, start, end, first, last)


def _table(path: Path, tree: Tree) -> Motion:
    from ..io.motion_table import read_motion

    found = read_motion(path, tree.coordinates)
    q = np.zeros((len(found.time), tree.n))
    q[:, [tree.coordinates.index(name) for name in found.coordinates]] = found.values
    return np.array(found.time), _placed(tree, found.coordinates, q)
