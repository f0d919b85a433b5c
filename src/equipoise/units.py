"""Quantities with units in, SI inside.

A bare number is taken in the SI unit of its dimension; text such as ``20 kN/m`` or ``35 deg`` is converted.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Any

SI_UNITS = {
    "length": "m",
    "angle": "rad",
    "mass": "kg",
    "stiffness": "N/m",
    "acceleration": "m/s^2",
    "inertia": "kg m^2",
    "torque": "N m",
    "time": "s",
    "force": "N",
    "rotational damping": "N m s/rad",
    "damping": "N s/m",
    "stress": "Pa",
    "number": "",
}
"""The dimensions a field can have, and the unit a bare number of it is in."""

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*([^\d\s+-][^+-]*|)\s*")
_UNIT = re.compile(r"(?:[A-Za-zµ°%]+(?:\^[1-4]|\*\*[1-4])?|[*/ ().·²³])+")


@cache
def _registry() -> Any:
    import pint  # 0.8 s to import: only files that use units pay for it

    return pint.UnitRegistry(cache_folder=None)


def to_si(value: object, dimension: str) -> float:
    """Convert a number or a text with a unit to SI.

    Args:
        value: a number in the SI unit of `dimension`, or text such as ``"850 g"``.
        dimension: a key of `SI_UNITS`.

    Returns:
        The value in the SI unit.

    Raises:
        ValueError: it is not a finite number, or its unit has another dimension; the message says what is expected.
    """
    unit = SI_UNITS[dimension]
    expected = f"expected a number [{unit}] or text with a unit of {dimension}" if unit else "expected a number"
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise ValueError(f"{expected}, found {_show(value)}")
    if isinstance(value, str):
        number = _parse(value, unit, expected)
    else:
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{expected}, found {_show(value)}, which is not finite")
    return number


def _parse(text: str, unit: str, expected: str) -> float:
    match = _QUANTITY.fullmatch(text)
    if match is None or not (match[2] == "" or _UNIT.fullmatch(match[2])):
        raise ValueError(f"{expected}, found {_show(text)}")
    number, found = float(match[1]), match[2].strip()
    if not found:
        return number
    if not unit:
        raise ValueError(f"{expected} without a unit, found {_show(text)}")
    try:
        # parse_units takes names, products and powers only: nothing in a file is evaluated
        return float(_registry().Quantity(number, _registry().parse_units(found.replace("·", "*"))).m_as(_pint(unit)))
    except Exception as error:  # pint has no common base class for unknown and mismatched units
        raise ValueError(f"{expected} ({unit}), found {_show(text)}") from error


def _pint(unit: str) -> str:
    return unit.replace(" ", "*")


def _show(value: object) -> str:
    text = "nothing" if value is None else str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def to_share(value: object) -> float:
    """A number, or text such as ``"5 %"`` or ``"0.05"``, as a share.

    Raises:
        ValueError: it is neither.
    """
    if isinstance(value, str):
        return float(value.removesuffix("%")) / (100 if value.endswith("%") else 1)
    return to_si(value, "number")
