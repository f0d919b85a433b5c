"""The kinds of spring as a mechanism file has them: the keys of each, and the element that they make.

The keys of a law are its fields: see `model.elements.laws`.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path as FilePath
from typing import Annotated, Any

from pydantic import ConfigDict, Field, ValidationInfo, field_validator

from ..model.elements import Element, Guide, LineElement, Pulley, Spring, TorsionSpring
from ..model.elements.laws import ON_JOINTS, ON_LINES, Cam, Linear, Torsional
from ..model.errors import InputError
from .cam_item import CableItem, CamItem, RollerItem, cam_spring
from .fields import Angle, Direction, Item, Length, Mass, Number, Point, Text, TorsionalStiffness, one_of
from .law_items import JOINT, LINE, JointItem, LawItem, OnJointsItem, law_model

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


def part_model(value: Any, key: object) -> type[Item]:
    """The model of a mapping inside an entry, or of the entry itself where that key holds none."""
    parts: dict[object, type[Item]] = {"via": GuideItem, "cable": CableItem, "roller": RollerItem}
    if key == "spring":
        return cam_spring(value["spring"])
    return parts.get(key) or spring_model(value)


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


class LineItem(LawItem):
    noun = "a spring"
    name: Text
    kind: Kind = Linear.kind
    body_a: Text
    p_a: Point
    body_b: Text
    p_b: Point
    via: list[GuideItem] = Field(default_factory=list)
    mass: Mass = 0.0
    mass_split: Number = 0.5
    diameter: Length = 0.0
    part: Text = ""
    realisation: Text = ""

    def element(self, folder: FilePath) -> Element:
        own = {key: getattr(self, key) for key in ("name", "body_a", "p_a", "body_b", "p_b")}
        ends = {key: getattr(self, key) for key in ("mass", "mass_split", "diameter", "part", "realisation")}
        law, via = self.made(folder, LINE), tuple(guide.guide() for guide in self.via)
        if self.kind == Linear.kind and not via:
            return Spring(**own, **law.values(), **ends)
        return LineElement(**own, law=law, via=via, **ends)


class TorsionItem(OnJointsItem):
    noun = "a torsion spring"
    stiffness: TorsionalStiffness
    rest: Angle = 0.0
    part: Text = ""

    def element(self, folder: FilePath) -> Element:
        return TorsionSpring(self.name, self.terms, self.stiffness, self.rest, self.part)


@cache
def line_model(kind: str) -> type[Item]:
    """The model of a law along a line."""
    return law_model(ON_LINES[kind], LineItem, LINE)


@cache
def joint_model(kind: str) -> type[Item]:
    """The model of a law on a joint."""
    return law_model(ON_JOINTS[kind], CamItem if kind == Cam.kind else JointItem, JOINT)
