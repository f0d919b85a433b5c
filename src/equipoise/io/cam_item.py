"""A cam as a mechanism file has it: its energy, and beside it the profile with the cable or roller and the spring."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path as FilePath
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from ..model.elements.laws import ON_LINES, Cam, Law
from ..model.elements.laws.profile import FIXED_TO, Cable, CamSpring, Profile, Roller
from ..model.errors import InputError
from ..model.units import share
from .fields import Angle, Item, Length, Text, one_of, rows_of
from .law_items import LINE, JointItem, LawItem, law_model


def _two(value: object) -> object:
    if isinstance(value, list) and len(value) == 2:
        return value
    raise InputError("expected two lengths, x and y in the plane of the joint")


FlatPoint = Annotated[tuple[float, float], rows_of("length"), BeforeValidator(_two)]


class CableItem(Item):
    noun = "the cable of a cam"
    point: FlatPoint
    length: Length
    behind: Length = 0.0
    diameter: Length = 0.0


class RollerItem(Item):
    noun = "the roller of a cam"
    radius: Length
    direction: Angle
    offset: Length = 0.0
    seat: Length = 0.0


class CamSpringItem(LawItem):
    noun = "the spring of a cam"
    own_noun = False
    kind: Annotated[str, one_of("kind of spring", tuple(ON_LINES))] = "linear"
    part: Text = ""


@cache
def cam_spring_model(kind: str) -> type[Item]:
    """The model of the spring of a cam."""
    return law_model(ON_LINES[kind], CamSpringItem, LINE)


def of_spring(value: object) -> object:
    """The spring of a cam as the model of its kind."""
    if value is None:
        return None
    return cam_spring(value).model_validate(value)


def cam_spring(value: object) -> type[Item]:
    """That model; a kind that does not exist is the fault of the plainest one."""
    kind = value.get("kind", "linear") if isinstance(value, dict) else "linear"
    return cam_spring_model(kind if isinstance(kind, str) and kind in ON_LINES else "linear")


class CamItem(JointItem):
    profile: Annotated[Any, rows_of("length", "length")] = ()
    fixed_to: Annotated[str, one_of("body of the joint", FIXED_TO)] = "child"
    cable: CableItem | None = None
    roller: RollerItem | None = None
    friction: Annotated[float, BeforeValidator(share)] = 0.0
    spring: Annotated[Any, BeforeValidator(of_spring)] = Field(default=None, validate_default=True)

    @field_validator("spring")
    @classmethod
    def _whole(cls, value: object, info: ValidationInfo) -> object:
        profile = info.data.get("profile", True)  # a wrong value has a fault of its own
        given = [name for name in ("cable", "roller") if info.data.get(name) is not None]
        if not profile and (given or value is not None):
            raise InputError(f"'{[*given, 'spring'][0]}' belongs to a 'profile', and there is none")
        if profile and value is None and profile is not True:
            raise InputError("missing: a 'profile' needs the spring behind its cable or roller")
        return value

    def made(self, folder: FilePath, path: dict[str, str]) -> Law:
        """Its law, with the profile where there is one."""
        law = super().made(folder, path)
        if not self.profile or not isinstance(law, Cam):
            return law
        made = Profile(
            self.profile,
            CamSpring(self.spring.made(folder, LINE), self.spring.part),
            self.fixed_to,
            None if self.cable is None else Cable(**self.cable.values()),
            None if self.roller is None else Roller(**self.roller.values()),
            self.friction,
        )
        return replace(law, made=made)
