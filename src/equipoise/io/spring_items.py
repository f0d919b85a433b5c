"""The kinds of spring as a mechanism file has them: the keys of each, and the element that they make."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field, ValidationInfo, field_validator

from ..model.elements import KINDS, Element, Spring, TorsionSpring
from ..model.errors import InputError
from .fields import Angle, Item, Length, Mass, Number, Point, Stiffness, Text, TorsionalStiffness, one_of


def of_kind(value: object) -> object:
    """An entry of `springs` as the model of its kind; what is wrong inside keeps its own place."""
    return spring_model(value).model_validate(value) if isinstance(value, dict) else SpringItem.model_validate(value)


def spring_model(value: object) -> type[Item]:
    kind = value.get("kind", Spring.kind) if isinstance(value, dict) else Spring.kind
    return SPRINGS.get(kind, OtherSpring) if isinstance(kind, str) else OtherSpring


Kind = Annotated[str, one_of("kind of spring", tuple(KINDS))]


class OtherSpring(Item):
    """Of a kind that does not exist: that is the fault."""

    model_config = ConfigDict(extra="ignore")
    noun = "a spring"
    kind: Kind


class SpringItem(Item):
    noun = "a spring"
    name: Text
    kind: Kind = Spring.kind
    body_a: Text
    p_a: Point
    body_b: Text
    p_b: Point
    stiffness: Stiffness
    free_length: Length = 0.0
    mass: Mass = 0.0
    mass_split: Number = 0.5
    diameter: Length = 0.0

    def element(self) -> Element:
        return Spring(**{key: value for key, value in self.values().items() if key != "kind"})


class TorsionItem(Item):
    noun = "a torsion spring"
    name: Text
    kind: Kind
    joint: Text | None = None
    joints: dict[str, Number] = Field(default={}, validate_default=True)
    stiffness: TorsionalStiffness
    rest: Angle = 0.0

    @field_validator("joints")
    @classmethod
    def _either(cls, value: dict[str, float], info: ValidationInfo) -> dict[str, float]:
        if ("joint" in info.data and info.data["joint"] is None) == (not value):
            raise InputError("give 'joint', or 'joints' with a ratio each, and not both")
        return value

    def element(self) -> Element:
        joints = self.joints or {str(self.joint): 1.0}
        return TorsionSpring(self.name, tuple(joints.items()), self.stiffness, self.rest)


SPRINGS: dict[str, type[Item]] = {Spring.kind: SpringItem, TorsionSpring.kind: TorsionItem}
