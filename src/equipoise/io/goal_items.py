"""The goal as a mechanism file has it: its keys, and the `Goal` that they make."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from ..model.errors import InputError, Path
from ..model.goal import SHARES, TORQUES, Count, Goal, Gravity, Loads, Tool, masses
from ..model.units import number
from .fields import Angle, Item, Point, Text, one_of
from .fields import Gravity as Vector


def _own(check: Callable[[Any], Any]) -> BeforeValidator:
    """A check that names its field itself; here the place in the file does."""

    def plain(value: object) -> object:
        try:
            return check(value)
        except InputError as error:
            raise InputError([replace(fault, path=()) for fault in error.faults]) from None

    return BeforeValidator(plain)


def _texts(value: object) -> object:
    return [value] if isinstance(value, str) else value


Share = Annotated[float, _own(lambda value: number("share", value, positive=True))]
Factor = Annotated[float, _own(lambda value: number("factor", value, positive=False))]


class ToolItem(Item):
    noun = "a load"
    name: Text
    body: Text
    payload: Annotated[Any, _own(masses)]
    at: Point = (0.0, 0.0, 0.0)
    share: Share = 1.0


class GravityItem(Item):
    noun = "a direction of gravity"
    vector: Vector
    share: Share = 1.0


class CountItem(Item):
    noun = "count"
    torque: Annotated[Any, one_of("torque that counts", TORQUES)] = "rms"
    joints: dict[str, Factor] = Field(default_factory=dict)
    only: Annotated[list[Text], BeforeValidator(_texts)] | None = None
    share_of: Annotated[Any, one_of("share", SHARES)] = None


class GoalItem(Item):
    noun = "a goal"
    loads: list[ToolItem] = Field(default_factory=list)
    gravity: list[GravityItem] = Field(default_factory=list)
    tilt: Angle = 0.0
    count: CountItem = CountItem()

    def goal(self) -> Goal:
        """Its value.

        Raises:
            InputError: a tilt out of range.
        """
        tools = (Tool(**item.values()) for item in self.loads)
        gravity = (Gravity(**item.values()) for item in self.gravity)
        return Goal(Loads(tuple(tools), tuple(gravity), self.tilt), Count(**self.count.values()))


ITEMS: dict[str, type[Item]] = {"loads": ToolItem, "gravity": GravityItem, "count": CountItem}


def model_at(path: Path) -> type[Item]:
    """The model of what stands at a path inside the goal."""
    return ITEMS.get(str(path[0]), GoalItem) if path else GoalItem
