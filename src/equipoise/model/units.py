"""Quantities with units in, SI inside.

A bare number is taken in the SI unit of its dimension; text such as ``20 kN/m`` or ``35 deg`` is converted.
"""

from __future__ import annotations

import math
import re
from functools import cache
from numbers import Real
from typing import Any

from .errors import Fault, InputError

SI_UNITS = {
    "length": "m",
    "angle": "rad",
    "mass": "kg",
    "stiffness": "N/m",
    "torsional stiffness": "N m/rad",
    "acceleration": "m/s^2",
    "inertia": "kg m^2",
    "torque": "N m",
    "time": "s",
    "force": "N",
    "energy": "J",
    "temperature": "K",
    "rotational damping": "N m s/rad",
    "damping": "N s/m",
    "torque per current": "N m/A",
    "force per current": "N/A",
    "resistance": "ohm",
    "stress": "Pa",
    "number": "",
}
"""The dimensions a field can have, and the unit a bare number of it is in."""

USUAL = {
    "length": {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254},
    "angle": {"rad": 1.0, "deg": math.pi / 180},
    "mass": {"kg": 1.0, "g": 0.001},
    "stiffness": {"N/m": 1.0, "N/cm": 100.0, "N/mm": 1000.0, "kN/m": 1000.0},
    "torsional stiffness": {"N m/rad": 1.0, "N*m/rad": 1.0, "N mm/rad": 0.001},
    "acceleration": {"m/s^2": 1.0},
    "torque": {"N m": 1.0, "N*m": 1.0, "N mm": 0.001},
    "time": {"s": 1.0, "ms": 0.001, "min": 60.0},
    "force": {"N": 1.0, "kN": 1000.0},
    "stress": {"Pa": 1.0, "MPa": 1e6},
}
"""What most files are written in: how much of the SI unit one is. For these `pint` need not be started (0.9 s)."""

Amount = float | str
"""A number in the SI unit of what is asked for, or text with a unit, such as ``150 mm``; of a share, such as ``2%``."""

LONGEST = 200  # characters of a text with a unit; none that means something is half as long
# possessive, so that no text is gone through twice: a hostile one would take for ever
_NUMBER = re.compile(r"[-+]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eE][-+]?[0-9]{1,3}+)?+")
_UNIT = re.compile(r"(?:[A-Za-zµ°%]++(?:\^[1-4]|\*\*[1-4])?+|[*/ ().·²³])++")


@cache
def _registry() -> Any:
    import pint  # 0.9 s with its definitions: only files with rarer units pay for it

    return pint.UnitRegistry(cache_folder=None)


def to_si(value: object, dimension: str) -> float:
    """Convert a number or a text with a unit to SI.

    Args:
        value: a number in the SI unit of `dimension`, or text such as ``"850 g"``.
        dimension: a key of `SI_UNITS`.

    Returns:
        The value in the SI unit.

    Raises:
        InputError: it is not a finite number, or its unit has another dimension; the message says what is expected.
    """
    unit = SI_UNITS[dimension]
    expected = f"expected a number [{unit}] or text with a unit of {dimension}" if unit else "expected a number"
    if isinstance(value, bool) or not isinstance(value, (Real, str)):
        raise InputError(f"{expected}, found {_show(value)}")
    if isinstance(value, str):
        number = _parse(value, dimension, expected)
    else:
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{expected}, found {_show(value)}, which is not finite")
    return number


def to_share(value: object) -> float:
    """A number, or text such as ``"5 %"`` or ``"0.05"``, as a share.

    Raises:
        ValueError: it is neither.
    """
    if isinstance(value, str):
        return float(value.removesuffix("%")) / (100 if value.endswith("%") else 1)
    return to_si(value, "number")


def quantity(value: object, dimension: str, *field: str | int) -> float:
    """`to_si` for a field of an input or an argument of a function.

    Raises:
        InputError: as `to_si`, and names the field.
    """
    try:
        return to_si(value, dimension)
    except InputError as error:
        raise InputError(Fault(field, str(error))) from None


def share(value: object, *field: str | int, most: float = 1.0) -> float:
    """A number from 0 to `most`, or text such as ``2%``.

    Raises:
        InputError: it is not; the message names the field.
    """
    try:
        number = to_share(value)
    except ValueError:
        number = math.nan
    if not 0 <= number <= most:
        limit = f" from 0 to {most:g}" if math.isfinite(most) else ""
        raise InputError(Fault(field, f"expected a share{limit} such as 0.02 or 2%, found {_show(value)}"))
    return number


def number(option: str, value: Any, positive: bool | None) -> float:
    """The value, when it is a finite number more than 0, at least 0, or with None of either sign but not 0.

    Raises:
        InputError: it is not.
    """
    limit = {True: "number of more than 0", False: "number of at least 0", None: "number other than 0"}[positive]
    allowed = isinstance(value, (int, float)) and math.isfinite(value)
    allowed = allowed and {True: value > 0, False: value >= 0, None: value != 0}[positive]
    if not allowed:
        raise InputError(Fault((option,), f"must be a finite {limit}, found {value}"))
    return float(value)


def point(value: Any, *field: str | int) -> tuple[float, float, float]:
    """Three finite lengths [m].

    Raises:
        InputError: they are not; the message names the field.
    """
    try:
        x, y, z = (to_si(length, "length") for length in value)
    except (TypeError, ValueError):
        x = y = z = math.nan
    if not all(map(math.isfinite, (x, y, z))):
        raise InputError(Fault(field, f"must be three lengths x,y,z [m] in its frame, found {value}"))
    return x, y, z


class AmountField:
    """A field of a dataclass that is made from an `Amount`, and is the number in SI then.

    Args:
        dimension: a key of `SI_UNITS`, or ``"share"``.
        default: taken as it is; it may be infinite, as an absent limit.
    """

    def __init__(self, dimension: str, default: float) -> None:
        self.dimension, self.default = dimension, default

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, owner: object | None, kind: type | None = None) -> float:
        return self.default if owner is None else owner.__dict__[self.name]

    def __set__(self, owner: object, value: Amount) -> None:
        if value == self.default:
            number = self.default
        elif self.dimension == "share":
            number = share(value, self.name, most=math.inf)
        else:
            number = quantity(value, self.dimension, self.name)
        owner.__dict__[self.name] = number


def _parse(text: str, dimension: str, expected: str) -> float:
    text, unit = text.strip(), SI_UNITS[dimension]
    match = _NUMBER.match(text) if len(text) <= LONGEST else None
    found = text[match.end() :].strip() if match else ""
    if match is None or not (found == "" or _UNIT.fullmatch(found)):
        raise InputError(f"{expected}, found {_show(text)}")
    number = float(match[0])
    if not found:
        return number
    if not unit:
        raise InputError(f"{expected} without a unit, found {_show(text)}")
    if found in USUAL.get(dimension, ()):
        return number * USUAL[dimension][found]
    try:
        # parse_units takes names, products and powers only: nothing in a file is evaluated
        found = "degC" if unit == "K" and found in ("C", "°C") else found  # a coulomb is meant by nobody
        return float(_registry().Quantity(number, _registry().parse_units(found.replace("·", "*"))).m_as(_pint(unit)))
    except Exception as error:  # pint has no common base class for unknown and mismatched units
        raise InputError(f"{expected} ({unit}), found {_show(text)}") from error


def _pint(unit: str) -> str:
    return unit.replace(" ", "*")


def _show(value: object) -> str:
    text = "nothing" if value is None else str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
