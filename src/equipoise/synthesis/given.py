"""Options that may differ from link to link: one value for all, or a value for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite, sqrt
from typing import Any

import numpy as np

from ..model.arrays import Array
from ..model.errors import Fault, InputError, nearest
from ..model.units import Amount

Value = Amount | Sequence[Amount]
Given = Value | Mapping[str, Value] | None
"""One value for all links, or link -> value with the value for all others under "*"."""


def numbers(option: str, given: Given, names: Sequence[str], positive: bool | None) -> dict[str, float]:
    """The number for each link that has one, see `number`."""
    return {name: number(option, value, positive) for name, value in _each(option, given, names).items()}


def number(option: str, value: Any, positive: bool | None) -> float:
    """The value, when it is a finite number more than 0, at least 0, or with None of either sign but not 0.

    Raises:
        InputError: it is not.
    """
    limit = {True: "number of more than 0", False: "number of at least 0", None: "number other than 0"}[positive]
    allowed = isinstance(value, (int, float)) and isfinite(value)
    allowed = allowed and {True: value > 0, False: value >= 0, None: value != 0}[positive]
    if not allowed:
        raise InputError(Fault((option,), f"must be a finite {limit}, found {value}"))
    return float(value)


def vectors(option: str, given: Given, names: Sequence[str]) -> dict[str, Array]:
    """The point (3,) [m] for each link that has one."""
    found = {}
    for name, value in _each(option, given, names).items():
        if isinstance(value, (int, float)) or len(value) != 3 or not np.isfinite(point := np.array(value, float)).all():
            raise InputError(Fault((option, name), f"must be three lengths x,y,z [m] in its frame, found {value}"))
        found[name] = point
    return found


def spring_sizes(
    strength: Mapping[str, float], default: Mapping[str, float], stiffness: Given, **lengths: Given
) -> dict[str, tuple[float, float, float]]:
    """Stiffness and the two lengths of each link's spring, whose product is its strength.

    Args:
        strength: of each link [N m].
        default: what a length is where nothing asks for another [m].
        stiffness, lengths: at most two of the three, the third follows; all three where they fit.

    Raises:
        InputError: all three are given and do not fit; the message says which stiffness does.
    """
    (first, second) = lengths
    given = {
        name: numbers(name, value, list(strength), positive=True)
        for name, value in (("stiffness", stiffness), *lengths.items())
    }
    sizes = {}
    for link, moment in strength.items():
        K, a, b = (found.get(link) for found in given.values())
        if K is not None and a is not None and b is not None:
            if abs(K * a * b - moment) > 1e-9 * moment:
                problem = f"with {first} and {second} it is given already: {moment / (a * b):.6g} N/m"
                problem += f", as the product of the three must be {moment:.6g} N m, found {K * a * b:.6g} N m"
                raise InputError(Fault(("stiffness", link), problem))
        elif K is None:
            a, b = default[link] if a is None else a, default[link] if b is None else b
            K = moment / (a * b)
        elif a is None:
            b = sqrt(moment / K) if b is None else b
            a = moment / (K * b)
        else:
            b = moment / (K * a)
        sizes[link] = K, a, b
    return sizes


def _each(option: str, given: Given, names: Sequence[str]) -> dict[str, Value]:
    """The value for each link that has one.

    Raises:
        InputError: one is given for no link that takes it.
    """
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        return dict.fromkeys(names, given)
    for name in given:
        if name != "*" and name not in names:
            raise InputError(Fault((option,), f"no link that takes it {nearest(name, names)}", tuple(names)))
    return {name: given.get(name, given.get("*")) for name in names if name in given or "*" in given}  # type: ignore[misc]
