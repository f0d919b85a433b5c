"""Schema 1 of the mechanism file, as pydantic models: keys, dimensions and defaults. Values come out in SI units.

What one item alone can tell is checked here; what needs the whole mechanism is checked by `Mechanism` itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationError, ValidationInfo, field_validator

from ..model.errors import COUNTED, Fault, InputError, Path, nearest
from ..model.mechanism import SHAPES, SINGLE, ShapeKind
from .attachment_items import AttachmentItem
from .fields import (
    Angle,
    Angles,
    Direction,
    Gravity,
    Inertias,
    Item,
    Length,
    Mass,
    Number,
    Point,
    Text,
    Type,
    held,
    limits,
    number_of,
    one_of,
    show,
    whole,
)  # fmt: skip
from .goal_items import GoalItem, model_at
from .spring_items import of_kind, part_model

SCHEMA = 1


def _schema(value: object) -> int:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and value == SCHEMA:
        return SCHEMA
    raise InputError(f"this version reads schema {SCHEMA}, found {show(value)}")


class BodyItem(Item):
    noun = "a body"
    name: Text
    mass: Mass = 0.0
    com: Point = (0.0, 0.0, 0.0)
    inertia: Inertias | None = None


class JointItem(Item):
    noun = "a joint"
    name: Text
    type: Type
    parent: Text
    child: Text
    xyz: Point = (0.0, 0.0, 0.0)
    rpy: Angles = (0.0, 0.0, 0.0)
    axis: Direction | None = Field(default=None, validate_default=True)
    range: Any = None
    follows: Text | None = None
    damping: Any = 0.0
    friction: Any = 0.0
    effort: Any = None
    torque_constant: Any = None
    resistance: Annotated[float, number_of("resistance")] | None = None

    @field_validator("axis")
    @classmethod
    def _axis(cls, value: object, info: ValidationInfo) -> object:
        joint_type = info.data.get("type")
        if value is None and joint_type in SINGLE:
            raise InputError(f"missing: a {joint_type} joint needs it")
        return (1.0, 0.0, 0.0) if value is None else value

    _range = field_validator("range", mode="before")(limits)
    _held = field_validator("damping", "friction", "effort", "torque_constant", mode="before")(held)


class CouplingItem(Item):
    noun = "a coupling"
    joint: Text
    terms: dict[str, Number]
    offset: Any = 0.0  # an angle or a length: its joint tells


class LoopItem(Item):
    noun = "a loop"
    body_a: Text
    p_a: Point
    body_b: Text
    p_b: Point
    axis_a: Direction | None = None
    axis_b: Direction | None = None


class MassItem(Item):
    noun = "a mass"
    name: Text
    body: Text
    mass: Mass
    position: Point = (0.0, 0.0, 0.0)


class CapsuleItem(Item):
    noun = "a capsule"
    name: Text
    body: Text
    p_a: Point
    p_b: Point
    radius: Length


class ShapeItem(Item):
    noun = "a shape"
    name: Text
    body: Text
    kind: Annotated[ShapeKind, one_of("kind of shape", SHAPES)]
    size: Point = (0.0, 0.0, 0.0)
    xyz: Point = (0.0, 0.0, 0.0)
    rpy: Angles = (0.0, 0.0, 0.0)
    file: Text = ""
    scale: Direction = (1.0, 1.0, 1.0)


class WorkspaceItem(Item):
    noun = "a workspace"
    samples: Annotated[int, BeforeValidator(whole)] = 4096


class DhRow(Item):
    noun = "a dh row"
    name: Text | None = None
    type: Annotated[Literal["revolute", "prismatic"], one_of("joint type for a dh row", SINGLE)] = "revolute"
    a: Length
    alpha: Angle
    d: Length
    theta: Angle
    range: Any = None

    _range = field_validator("range", mode="before")(limits)


class DhTable(Item):
    noun = "a dh table"
    convention: Annotated[Literal["standard", "modified"], one_of("convention", ("standard", "modified"))]
    rows: list[DhRow]


class MechanismFile(Item):
    noun = "a mechanism file"
    schema_: Annotated[int, BeforeValidator(_schema), Field(alias="schema")]
    name: Text
    gravity: Gravity = (0.0, 0.0, -9.81)
    model: Text | None = None
    bodies: list[BodyItem] = Field(default_factory=list)
    joints: list[JointItem] = Field(default_factory=list)
    dh: DhTable | None = None
    couplings: list[CouplingItem] = Field(default_factory=list)
    loops: list[LoopItem] = Field(default_factory=list)
    independent: list[Text] = Field(default_factory=list)
    assembly: dict[str, Any] = Field(default_factory=dict)  # angles or lengths: their joints tell
    springs: list[Annotated[Any, BeforeValidator(of_kind)]] = Field(default_factory=list)
    masses: list[MassItem] = Field(default_factory=list)
    attachments: list[AttachmentItem] = Field(default_factory=list)
    capsules: list[CapsuleItem] = Field(default_factory=list)
    shapes: list[ShapeItem] = Field(default_factory=list)
    workspace: WorkspaceItem = WorkspaceItem()
    goal: GoalItem = GoalItem()
    provenance: dict[str, Any] = Field(default_factory=dict)


_ITEMS: dict[str, type[Item]] = {
    "bodies": BodyItem,
    "joints": JointItem,
    "couplings": CouplingItem,
    "loops": LoopItem,
    "masses": MassItem,
    "attachments": AttachmentItem,
    "capsules": CapsuleItem,
    "shapes": ShapeItem,
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
        return None, list(islice(_faults(error, data), COUNTED))


def defaults(path: Path, data: object) -> dict[str, Any]:
    """Key -> default, of a mapping at a path of a file; None where there is none."""
    fields = _model(path, data).model_fields
    return {
        field.alias or name: None if field.is_required() else _as_data(field.get_default())
        for name, field in fields.items()
    }


def _as_data(value: Any) -> Any:
    """A default as a file would have it."""
    return {} if isinstance(value, Item) else list(value) if isinstance(value, tuple) else value


def _faults(error: ValidationError, data: object) -> Iterator[tuple[Fault, bool]]:
    details = error.errors(include_url=False)
    missing = {detail["loc"] for detail in details if detail["type"] == "missing"}
    meant: set[Path] = set()  # missing only because its key is misspelt: one fault, not two
    for detail in details:
        if detail["type"] == "extra_forbidden":
            above, key = detail["loc"][:-1], detail["loc"][-1]
            keys = _keys(_model(above, data))
            message = f"unknown key {nearest(key, keys)}"
            meant |= {(*above, name) for name in keys if message.endswith(f"mean '{name}'?")} & missing
            yield Fault(detail["loc"], message, keys), True
    for detail in details:
        if detail["type"] != "extra_forbidden" and detail["loc"] not in meant:
            yield _plain(detail, data), False


def _plain(detail: Any, data: Any) -> Fault:
    """One pydantic error in plain words."""
    path, kind, context = detail["loc"], detail["type"], detail.get("ctx", {})
    if path == ("schema",) and kind == "missing":
        return Fault(path, f"missing: the file starts with 'schema: {SCHEMA}'")
    if kind == "missing":
        return Fault(path, f"missing: {_model(path[:-1], data).noun} needs it")
    if kind == "value_error":
        (fault,) = context["error"].faults
        return replace(fault, path=(*path, *fault.path))
    if kind == "list_type":
        return Fault(path, f"expected a list, found {show(detail['input'])}")
    if kind == "dict_type":
        return Fault(path, f"expected a mapping, found {show(detail['input'])}")
    model = _model(path, data)
    return Fault(path, f"expected a mapping, found {show(detail['input'])}", _keys(model))


def _model(path: Path, data: Any) -> type[Item]:
    if not path:
        return MechanismFile
    section, *inside = path
    if section == "springs" and inside:
        number, *keys = inside
        return part_model(data["springs"][number], keys[0] if keys else "")
    if section == "goal":
        return model_at(tuple(inside))
    return DhRow if path[:2] == ("dh", "rows") else _ITEMS[str(path[0])]


def _keys(model: type[Item]) -> tuple[str, ...]:
    return tuple(field.alias or name for name, field in model.model_fields.items())
