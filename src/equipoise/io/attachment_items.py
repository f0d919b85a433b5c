"""The entries of `attachments` of a mechanism file, and how they are written."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from ..model.errors import InputError
from ..model.region import ORIGIN, Attachment, Region
from .fields import Item, Length, Point, Text, point_or_name, show

SHAPES = ("box", "ball", "point")


def _true(value: object) -> bool:
    if value is not True:
        raise InputError(f"expected true, found {show(value)}: leave it out where there is a box or a ball")
    return True


class AttachmentItem(Item):
    noun = "an attachment"
    body: Text
    centre: Annotated[Any, BeforeValidator(point_or_name)] = ORIGIN
    box: Point | None = None
    ball: Length | None = None
    point: Annotated[bool, BeforeValidator(_true)] | None = Field(default=None, validate_default=True)

    @field_validator("point")
    @classmethod
    def _one(cls, value: object, info: ValidationInfo) -> object:
        given = [info.data.get("box", 0), info.data.get("ball", 0), value]  # a wrong value has a fault of its own
        if "box" in info.data and "ball" in info.data and sum(one is not None for one in given) != 1:
            raise InputError("give one of 'box' (its half sides), 'ball' (its radius) and 'point: true'")
        return value

    def attachment(self) -> Attachment:
        """The body with its region."""
        if self.ball is not None:
            return Attachment(self.body, Region.ball(self.ball, self.centre))
        return Attachment(self.body, Region.box(self.box or ORIGIN, self.centre))


def written(one: Attachment) -> dict[str, Any]:
    """An attachment as an entry of the file."""
    region = one.region
    centre = region.centre if isinstance(region.centre, str) else [float(x) for x in region.centre]
    out: dict[str, Any] = {"body": one.body} | ({} if region.centre == ORIGIN else {"centre": centre})
    if region.shape == "ball":
        return out | {"ball": float(region.half[0])}
    return out | ({"box": [float(h) for h in region.half]} if region.axes else {"point": True})
