"""Names that options give: of joints and coordinates, of bodies and pairs of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..kinematics import Tree
from ..model.coordinate import Coordinate
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from .given import number

Pair = tuple[str, str]


def _coordinates(mechanism: Mechanism, field: str, name: str) -> list[Coordinate]:
    coordinates = Tree.of(mechanism).coordinates
    own = [c for c in coordinates if name in (c, c.rpartition(".")[0])]
    if not own:
        raise InputError(Fault((field,), f"no independent joint {nearest(name, coordinates)}", coordinates))
    return own


def counted(mechanism: Mechanism, joints: Iterable[str]) -> tuple[str, ...]:
    found = tuple(dict.fromkeys(c for name in joints for c in _coordinates(mechanism, "joints", name)))
    if not found:
        raise InputError(Fault(("joints",), "no joint is named", Tree.of(mechanism).coordinates))
    return found


def weight_of_each(mechanism: Mechanism, given: Mapping[str, float]) -> dict[str, float]:
    return {
        coordinate: number("weights", value, positive=False)
        for name, value in given.items()
        for coordinate in _coordinates(mechanism, "weights", name)
    }


def distinct(pairs: Iterable[Pair]) -> tuple[Pair, ...]:
    """Each pair once, whichever end is named first."""
    return tuple({frozenset(pair): pair for pair in reversed(list(pairs))}.values())[::-1]


def known(mechanism: Mechanism, field: str, names: Iterable[str]) -> Pair:
    names = tuple(names)
    for name in names:
        if name not in mechanism.body_names:
            choices = mechanism.body_names
            raise InputError(Fault((field,), f"there is no body {nearest(name, choices)}", choices))
    if field == "pairs" and len(set(names)) != 2:
        raise InputError(Fault((field,), f"a spring needs two different bodies, found {':'.join(names)}"))
    return names  # type: ignore[return-value]
