"""The values of a mechanism file: text, numbers with units, vectors. What is wrong is said in the words of the file."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationInfo

from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import JOINT_TYPES, MOVING, SINGLE, JointType
from ..model.units import SI_UNITS, quantity, to_si


class Item(BaseModel):
    """A mapping of the file. `noun` is what a message calls it."""

    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True)
    noun: ClassVar[str]

    def values(self) -> dict[str, Any]:
        """The fields by name, as the dataclass of the same kind takes them."""
        return {name: getattr(self, name) for name in type(self).model_fields}


DIMENSION_OF = {"revolute": "angle", "prismatic": "length"}
"""What the coordinate of a joint measures."""


def show(value: object) -> str:
    """A found value in the words of the file: a list is a list, nothing is nothing."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a mapping"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _text(value: object) -> str:
    if isinstance(value, str):
        return value
    quotes = f"; put it in quotes: '{show(value)}'" if isinstance(value, (bool, int, float)) else ""
    raise InputError(f"expected text, found {show(value)}{quotes}")


def whole(value: object) -> int:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and float(value).is_integer():
        return int(value)
    raise InputError(f"expected a whole number, found {show(value)}")


def one_of(what: str, choices: tuple[str, ...]) -> Any:
    def check(value: object) -> object:
        if isinstance(value, str) and value in choices:
            return value
        found = nearest(value, choices) if isinstance(value, str) else show(value)
        raise InputError(Fault((), f"no {what} {found}", choices))

    return BeforeValidator(check)


def number_of(dimension: str) -> Any:
    """What makes a value a number of a dimension in SI."""
    return BeforeValidator(partial(to_si, dimension=dimension))


def _list_of(count: int, dimension: str) -> Any:
    def check(value: object) -> object:
        if isinstance(value, list) and len(value) == count:
            return value
        found = f"{len(value)}: {show(value)}" if isinstance(value, list) else show(value)
        unit = f" [{SI_UNITS[dimension]}]" if SI_UNITS[dimension] else ""
        raise InputError(f"expected a list of {count} numbers{unit}, found {found}")

    return BeforeValidator(check)


def rows_of(*dimensions: str) -> Any:
    """What makes a list numbers of one dimension, or rows of numbers of several."""

    def check(value: object) -> object:
        if not isinstance(value, list):
            raise InputError(f"expected a list, found {show(value)}")
        found: list[Any] = []
        for i, row in enumerate(value):
            cells = [row] if len(dimensions) == 1 else row
            if not isinstance(cells, list) or len(cells) != len(dimensions):
                raise InputError(Fault((i,), f"expected a list of {' and '.join(dimensions)}, found {show(row)}"))
            numbers = tuple(quantity(cell, name, i) for cell, name in zip(cells, dimensions, strict=True))
            found.append(numbers[0] if len(dimensions) == 1 else numbers)
        return tuple(found)

    return BeforeValidator(check)


Text = Annotated[str, BeforeValidator(_text)]
Number = Annotated[float, number_of("number")]
Length = Annotated[float, number_of("length")]
Angle = Annotated[float, number_of("angle")]
Mass = Annotated[float, number_of("mass")]
Stiffness = Annotated[float, number_of("stiffness")]
TorsionalStiffness = Annotated[float, number_of("torsional stiffness")]
Acceleration = Annotated[float, number_of("acceleration")]
Inertia = Annotated[float, number_of("inertia")]
Direction = Annotated[tuple[Number, Number, Number], _list_of(3, "number")]
Point = Annotated[tuple[Length, Length, Length], _list_of(3, "length")]
Angles = Annotated[tuple[Angle, Angle, Angle], _list_of(3, "angle")]
Gravity = Annotated[tuple[Acceleration, Acceleration, Acceleration], _list_of(3, "acceleration")]
Inertias = Annotated[tuple[Inertia, Inertia, Inertia, Inertia, Inertia, Inertia], _list_of(6, "inertia")]
Type = Annotated[JointType, one_of("joint type", JOINT_TYPES)]


def point_or_name(value: object) -> object:
    """A list of 3 lengths [m], or a name."""
    if isinstance(value, str):
        return value
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"expected a list of 3 numbers [m] or the name of a joint, found {show(value)}")
    return tuple(quantity(length, "length", i) for i, length in enumerate(value))


def limits(value: object, info: ValidationInfo) -> tuple[float, float] | None:
    """A range: angles of a revolute joint, lengths of a prismatic one."""
    joint_type = info.data.get("type")
    if value is None or joint_type is None:  # a bad type has a fault of its own
        return None
    if joint_type not in SINGLE:
        raise InputError(f"a {joint_type} joint has no range; only {' and '.join(SINGLE)} have")
    dimension = DIMENSION_OF[joint_type]
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"expected a list of 2 numbers [{SI_UNITS[dimension]}], lower first, found {show(value)}")
    found = []
    for i, limit in enumerate(value):
        found.append(quantity(limit, dimension, i))
    return found[0], found[1]


HELD = {
    "damping": ("rotational damping", "damping"),
    "friction": ("torque", "force"),
    "effort": ("torque", "force"),
    "torque_constant": ("torque per current", "force per current"),
}
"""What a field of a joint measures: of its turning, and of its sliding."""


def held(value: object, info: ValidationInfo) -> float | None:
    """Damping, friction or what a motor can do at a joint: of its turning or of its sliding."""
    joint_type, name = info.data.get("type"), str(info.field_name)
    if joint_type is None or value is None:
        return None
    if joint_type not in MOVING:
        raise InputError(f"a {joint_type} joint has no {name}; only {', '.join(MOVING)} joints have")
    return to_si(value, HELD[name][joint_type == "prismatic"])
