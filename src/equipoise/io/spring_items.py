"""The kinds of spring as a mechanism file has them: the keys of each, and the element that they make.

The keys of a law are its fields: see `model.elements.laws`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, fields
from functools import cache
from pathlib import Path as FilePath
from typing import Annotated, Any, ClassVar

from pydantic import ConfigDict, Field, ValidationInfo, create_model, field_validator

from ..model.elements import Element, Guide, JointElement, LineElement, Pulley, Spring, TorsionSpring
from ..model.elements.laws import ON_JOINTS, ON_LINES, Law, Linear, Torsional
from ..model.errors import Fault, InputError
from ..model.units import quantity
from .fields import (
    Angle,
    Direction,
    Item,
    Length,
    Mass,
    Number,
    Point,
    Text,
    TorsionalStiffness,
    number_of,
    one_of,
    rows_of,
)
from .tables import csv_rows, heading

LINE = {"path": "length", "force": "force", "energy": "energy"}
JOINT = {"path": "angle", "force": "torque", "energy": "energy"}
"""What the dimensions of a table's columns are on each path."""
KINDS = tuple(dict.fromkeys((*ON_LINES, Torsional.kind, *ON_JOINTS)))


def of_kind(value: object) -> object:
    """An entry of `springs` as the model of its kind; what is wrong inside keeps its own place."""
    return spring_model(value).model_validate(value)


def spring_model(value: object) -> type[Item]:
    """The model of an entry: its kind says which, and whether it names a joint."""
    if not isinstance(value, dict):
        return line_model(Linear.kind)
    kind = value.get("kind", Linear.kind)
    if not isinstance(kind, str) or kind not in KINDS:
        return OtherSpring
    if kind == Torsional.kind:
        return TorsionItem
    on_joint = kind in ON_JOINTS and (kind not in ON_LINES or "joint" in value or "joints" in value)
    return joint_model(kind) if on_joint else line_model(kind)


Kind = Annotated[str, one_of("kind of spring", KINDS)]


class OtherSpring(Item):
    """Of a kind that does not exist: that is the fault."""

    model_config = ConfigDict(extra="ignore")
    noun = "a spring"
    kind: Kind


class GuideItem(Item):
    noun = "a guide of a cable"
    body: Text
    point: Point
    radius: Length | None = None
    axis: Direction | None = None
    side: Point | None = Field(default=None, validate_default=True)

    @field_validator("side")
    @classmethod
    def _whole(cls, value: object, info: ValidationInfo) -> object:
        given = [info.data.get("radius", 0), info.data.get("axis", 0), value]  # a wrong value has a fault of its own
        if any(one is None for one in given) != all(one is None for one in given):
            raise InputError("a pulley has 'radius', 'axis' and 'side'; a point that the cable runs through has none")
        return value

    def guide(self) -> Guide:
        """The point or pulley."""
        return Guide(self.body, self.point) if self.radius is None else Pulley(**self.values())


class LawItem(Item):
    """What every kind has: a name, numbers of its law, and `element`, which makes it."""

    law: ClassVar[type[Law]]
    name: Text
    kind: Kind = Linear.kind

    def made(self, folder: FilePath, path: dict[str, str]) -> Law:
        """Its law; the file of a table is relative to the folder of the mechanism file.

        Raises:
            InputError: a table's file cannot be read.
        """
        values = {f.name: getattr(self, f.name) for f in fields(self.law)}
        if (file := getattr(self, "file", None)) is not None:
            if values["points"]:
                raise InputError(Fault(("file",), "give 'file' or 'points', and not both"))
            column = next(f.metadata["columns"] for f in fields(self.law) if f.name == "points")
            values["points"] = points(folder / file, [path[name] for name in column])
        return self.law(**values)


class LineItem(LawItem):
    noun = "a spring"
    body_a: Text
    p_a: Point
    body_b: Text
    p_b: Point
    via: list[GuideItem] = Field(default_factory=list)
    mass: Mass = 0.0
    mass_split: Number = 0.5
    diameter: Length = 0.0

    def element(self, folder: FilePath) -> Element:
        own = {key: getattr(self, key) for key in ("name", "body_a", "p_a", "body_b", "p_b")}
        ends = {key: getattr(self, key) for key in ("mass", "mass_split", "diameter")}
        law, via = self.made(folder, LINE), tuple(guide.guide() for guide in self.via)
        if self.kind == Linear.kind and not via:
            return Spring(**own, **law.values(), **ends)
        return LineElement(**own, law=law, via=via, **ends)


class _OnJoints(LawItem):
    joint: Text | None = None
    joints: dict[str, Number] = Field(default={}, validate_default=True)

    @field_validator("joints")
    @classmethod
    def _either(cls, value: dict[str, float], info: ValidationInfo) -> dict[str, float]:
        if ("joint" in info.data and info.data["joint"] is None) == (not value):
            raise InputError("give 'joint', or 'joints' with a ratio each, and not both")
        return value

    @property
    def terms(self) -> tuple[tuple[str, float], ...]:
        return tuple((self.joints or {str(self.joint): 1.0}).items())


class JointItem(_OnJoints):
    noun = "an element on a joint"

    def element(self, folder: FilePath) -> Element:
        return JointElement(self.name, self.terms, self.made(folder, JOINT))


class TorsionItem(_OnJoints):
    noun = "a torsion spring"
    stiffness: TorsionalStiffness
    rest: Angle = 0.0

    def element(self, folder: FilePath) -> Element:
        return TorsionSpring(self.name, self.terms, self.stiffness, self.rest)


@cache
def line_model(kind: str) -> type[Item]:
    """The model of a law along a line."""
    return _model(ON_LINES[kind], LineItem, LINE)


@cache
def joint_model(kind: str) -> type[Item]:
    """The model of a law on a joint."""
    return _model(ON_JOINTS[kind], JointItem, JOINT)


def _model(law: type[Law], base: type[LawItem], path: dict[str, str]) -> type[Item]:
    keys: dict[str, Any] = {}
    for f in fields(law):
        columns = [path[name] for name in f.metadata.get("columns", ())]
        if columns:
            from_file = f.name == "points"
            keys[f.name] = (Annotated[Any, rows_of(*columns)], () if from_file else f.default)
            keys |= {"file": (Text, None)} if from_file else {}
        else:
            default = ... if f.default is MISSING else f.default
            keys[f.name] = (Annotated[float, number_of(f.metadata["dimension"])], default)
    made: Any = create_model(f"{law.__name__}Item", __base__=base, **keys)
    made.law, made.noun = law, LineItem.noun if law is Linear else law.noun
    return made


def points(file: FilePath, dimensions: Sequence[str]) -> tuple[tuple[float, ...], ...]:
    """The rows of a CSV file of two columns; units stand in brackets at the head of a column, or are SI.

    Raises:
        InputError: it cannot be read, or a row has no two numbers; the message gives file and line.
    """
    (line, head), *rows = csv_rows(file, 1000)
    units = [heading(cell)[1] for cell in head]
    found = []
    for line, row in rows:
        try:
            if len(row) != len(dimensions) or len(units) != len(dimensions):
                raise InputError(f"expected {' and '.join(dimensions)}, found {len(row)} columns")
            cells = [f"{cell} {unit}" if unit else cell for cell, unit in zip(row, units, strict=True)]
            found.append(tuple(quantity(cell, name, name) for cell, name in zip(cells, dimensions, strict=True)))
        except InputError as error:
            raise InputError(fault.at(str(file), line) for fault in error.faults) from None
    return tuple(found)
