"""Schema 1 of the mechanism file, as pydantic models: keys, dimensions and defaults. Values come out in SI units.

What one item alone can tell is checked here; what needs the whole mechanism is checked by `Mechanism` itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from ..errors import Fault, Path, nearest
from ..mechanism import JOINT_TYPES, SINGLE, JointType
from ..units import SI_UNITS, to_si

SCHEMA = 1
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
    raise ValueError(f"expected text, found {show(value)}{quotes}")


def _whole(value: object) -> int:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and float(value).is_integer():
        return int(value)
    raise ValueError(f"expected a whole number, found {show(value)}")


def _schema(value: object) -> int:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and value == SCHEMA:
        return SCHEMA
    raise ValueError(f"this version reads schema {SCHEMA}, found {show(value)}")


def _one_of(what: str, choices: tuple[str, ...]) -> Any:
    def check(value: object) -> object:
        if isinstance(value, str) and value in choices:
            return value
        found = nearest(value, choices) if isinstance(value, str) else show(value)
        raise PydanticCustomError("choice", "unknown", {"message": f"no {what} {found}", "choices": choices})

    return BeforeValidator(check)


def _number(dimension: str) -> Any:
    return BeforeValidator(partial(to_si, dimension=dimension))


def _list_of(count: int, dimension: str) -> Any:
    def check(value: object) -> object:
        if isinstance(value, list) and len(value) == count:
            return value
        found = f"{len(value)}: {show(value)}" if isinstance(value, list) else show(value)
        unit = f" [{SI_UNITS[dimension]}]" if SI_UNITS[dimension] else ""
        raise ValueError(f"expected a list of {count} numbers{unit}, found {found}")

    return BeforeValidator(check)


Text = Annotated[str, BeforeValidator(_text)]
Number = Annotated[float, _number("number")]
Length = Annotated[float, _number("length")]
Angle = Annotated[float, _number("angle")]
Mass = Annotated[float, _number("mass")]
Stiffness = Annotated[float, _number("stiffness")]
Acceleration = Annotated[float, _number("acceleration")]
Inertia = Annotated[float, _number("inertia")]
Direction = Annotated[tuple[Number, Number, Number], _list_of(3, "number")]
Point = Annotated[tuple[Length, Length, Length], _list_of(3, "length")]
Angles = Annotated[tuple[Angle, Angle, Angle], _list_of(3, "angle")]
Gravity = Annotated[tuple[Acceleration, Acceleration, Acceleration], _list_of(3, "acceleration")]
Inertias = Annotated[tuple[Inertia, Inertia, Inertia, Inertia, Inertia, Inertia], _list_of(6, "inertia")]
Type = Annotated[JointType, _one_of("joint type", JOINT_TYPES)]


def _limits(value: object, info: ValidationInfo) -> tuple[float, float] | None:
    """A range: angles of a revolute joint, lengths of a prismatic one."""
    joint_type = info.data.get("type")
    if value is None or joint_type is None:  # a bad type has a fault of its own
        return None
    if joint_type not in SINGLE:
        raise ValueError(f"a {joint_type} joint has no range; only {' and '.join(SINGLE)} have")
    dimension = DIMENSION_OF[joint_type]
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"expected a list of 2 numbers [{SI_UNITS[dimension]}], lower first, found {show(value)}")
    limits = []
    for i, limit in enumerate(value):
        try:
            limits.append(to_si(limit, dimension))
        except ValueError as error:
            raise PydanticCustomError("element", "bad", {"message": str(error), "index": i}) from error
    return limits[0], limits[1]


class Item(BaseModel):
    """A mapping of the file. `kind` is what a message calls it."""

    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True)
    kind: ClassVar[str]

    def values(self) -> dict[str, Any]:
        """The fields by name, as the dataclass of the same kind takes them."""
        return {name: getattr(self, name) for name in type(self).model_fields}


class BodyItem(Item):
    kind = "a body"
    name: Text
    mass: Mass = 0.0
    com: Point = (0.0, 0.0, 0.0)
    inertia: Inertias | None = None


class JointItem(Item):
    kind = "a joint"
    name: Text
    type: Type
    parent: Text
    child: Text
    xyz: Point = (0.0, 0.0, 0.0)
    rpy: Angles = (0.0, 0.0, 0.0)
    axis: Direction | None = Field(default=None, validate_default=True)
    range: Any = None
    follows: Text | None = None

    @field_validator("axis")
    @classmethod
    def _axis(cls, value: object, info: ValidationInfo) -> object:
        joint_type = info.data.get("type")
        if value is None and joint_type in SINGLE:
            raise ValueError(f"missing: a {joint_type} joint needs it")
        return (1.0, 0.0, 0.0) if value is None else value

    _range = field_validator("range", mode="before")(_limits)


class CouplingItem(Item):
    kind = "a coupling"
    joint: Text
    terms: dict[str, Number]
    offset: Any = 0.0  # an angle or a length: its joint tells


class LoopItem(Item):
    kind = "a loop"
    body_a: Text
    p_a: Point
    body_b: Text
    p_b: Point
    axis_a: Direction | None = None
    axis_b: Direction | None = None


class SpringItem(Item):
    kind = "a spring"
    name: Text
    body_a: Text
    p_a: Point
    body_b: Text
    p_b: Point
    stiffness: Stiffness
    free_length: Length = 0.0
    mass: Mass = 0.0
    mass_split: Number = 0.5
    diameter: Length = 0.0


class MassItem(Item):
    kind = "a mass"
    name: Text
    body: Text
    mass: Mass
    position: Point = (0.0, 0.0, 0.0)


class CapsuleItem(Item):
    kind = "a capsule"
    name: Text
    body: Text
    p_a: Point
    p_b: Point
    radius: Length


class WorkspaceItem(Item):
    kind = "a workspace"
    samples: Annotated[int, BeforeValidator(_whole)] = 4096


class DhRow(Item):
    kind = "a dh row"
    name: Text | None = None
    type: Annotated[Literal["revolute", "prismatic"], _one_of("joint type for a dh row", SINGLE)] = "revolute"
    a: Length
    alpha: Angle
    d: Length
    theta: Angle
    range: Any = None

    _range = field_validator("range", mode="before")(_limits)


class DhTable(Item):
    kind = "a dh table"
    convention: Annotated[Literal["standard", "modified"], _one_of("convention", ("standard", "modified"))]
    rows: list[DhRow]


class MechanismFile(Item):
    kind = "a mechanism file"
    schema_: Annotated[int, BeforeValidator(_schema), Field(alias="schema")]
    name: Text
    gravity: Gravity = (0.0, 0.0, -9.81)
    model: Text | None = None
    bodies: list[BodyItem] = []
    joints: list[JointItem] = []
    dh: DhTable | None = None
    couplings: list[CouplingItem] = []
    loops: list[LoopItem] = []
    independent: list[Text] = []
    assembly: dict[str, Any] = {}  # angles or lengths: their joints tell
    springs: list[SpringItem] = []
    masses: list[MassItem] = []
    capsules: list[CapsuleItem] = []
    workspace: WorkspaceItem = WorkspaceItem()
    provenance: dict[str, Any] = {}


_ITEMS: dict[str, type[Item]] = {
    "bodies": BodyItem,
    "joints": JointItem,
    "couplings": CouplingItem,
    "loops": LoopItem,
    "springs": SpringItem,
    "masses": MassItem,
    "capsules": CapsuleItem,
    "workspace": WorkspaceItem,
    "dh": DhTable,
}


def validate(data: object) -> tuple[MechanismFile | None, list[tuple[Fault, bool]]]:
    """The file's content as a model, or what is wrong with it.

    Returns:
        The model, or None and the faults, each with whether it is about the key (an unknown one) and not its value.
    """
    try:
        return MechanismFile.model_validate(data), []
    except ValidationError as error:
        return None, list(_faults(error))


def _faults(error: ValidationError) -> Iterator[tuple[Fault, bool]]:
    details = error.errors(include_url=False)
    missing = {detail["loc"] for detail in details if detail["type"] == "missing"}
    meant: set[Path] = set()  # missing only because its key is misspelt: one fault, not two
    for detail in details:
        if detail["type"] == "extra_forbidden":
            above, key = detail["loc"][:-1], detail["loc"][-1]
            keys = _keys(_model(above))
            message = f"unknown key {nearest(key, keys)}"
            meant |= {(*above, name) for name in keys if message.endswith(f"mean '{name}'?")} & missing
            yield Fault(detail["loc"], message, keys), True
    for detail in details:
        if detail["type"] != "extra_forbidden" and detail["loc"] not in meant:
            yield _plain(detail), False


def _plain(detail: Any) -> Fault:
    """One pydantic error in plain words."""
    path, kind, context = detail["loc"], detail["type"], detail.get("ctx", {})
    if path == ("schema",) and kind == "missing":
        return Fault(path, f"missing: the file starts with 'schema: {SCHEMA}'")
    if kind == "missing":
        return Fault(path, f"missing: {_model(path[:-1]).kind} needs it")
    if kind == "value_error":
        return Fault(path, str(context["error"]))
    if kind == "choice":
        return Fault(path, context["message"], context["choices"])
    if kind == "element":
        return Fault((*path, context["index"]), context["message"])
    if kind == "list_type":
        return Fault(path, f"expected a list, found {show(detail['input'])}")
    if kind == "dict_type":
        return Fault(path, f"expected a mapping, found {show(detail['input'])}")
    model = _model(path)
    return Fault(path, f"expected a mapping, found {show(detail['input'])}", _keys(model))


def _model(path: Path) -> type[Item]:
    if not path:
        return MechanismFile
    return DhRow if path[:2] == ("dh", "rows") else _ITEMS[str(path[0])]


def _keys(model: type[Item]) -> tuple[str, ...]:
    return tuple(field.alias or name for name, field in model.model_fields.items())
