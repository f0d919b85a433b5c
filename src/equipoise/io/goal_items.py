"""The goal as a mechanism file has it: its keys, and the `Goal` that they make."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Annotated, Any, TypeVar

from pydantic import BeforeValidator, Field

from ..model.coordinate import Coordinate
from ..model.errors import Fault, InputError, Path
from ..model.goal import SHARES, TORQUES, Cost, Count, Goal, Gravity, Loads, Tool, masses
from ..model.motion import Box, Listed, Motion, Where
from ..model.units import number, quantity
from .fields import Angle, Item, Point, Stiffness, Text, number_of, one_of, whole
from .fields import Gravity as Vector
from .motion_table import read_motion, read_poses

Made = TypeVar("Made")
Time = Annotated[float, number_of("time")]


def _own(check: Callable[[Any], Any]) -> BeforeValidator:
    """A check that names its field itself; here the place in the file does."""

    def plain(value: object) -> object:
        try:
            return check(value)
        except InputError as error:
            raise InputError([replace(fault, path=()) for fault in error.faults]) from None

    return BeforeValidator(plain)


def _file(value: object) -> object:
    """The name of a file alone."""
    return {"file": value} if isinstance(value, str) else value


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
    heat: bool = False
    friction: bool = False


class MotionItem(Item):
    noun = "a motion"
    file: Text | None = None
    time: list[Time] = Field(default_factory=list)
    joints: dict[str, list[Any]] = Field(default_factory=dict)
    stops: bool = False
    share: Share = 1.0

    def motion(self, folder: FilePath, coordinates: Sequence[Coordinate]) -> Motion:
        """Its value.

        Raises:
            InputError: the file cannot be used, or what is written out is no motion.
        """
        if self.file is not None:
            if self.time or self.joints:
                raise InputError(Fault(("file",), "give 'file', or 'time' and 'joints', and not both"))
            return read_motion(folder / self.file, coordinates, self.stops, self.share)
        return Motion(tuple(self.joints), tuple(self.time), _rows(self.joints, coordinates), self.stops, self.share)


class ListItem(Item):
    noun = "a list of poses"
    file: Text | None = None
    joints: dict[str, list[Any]] = Field(default_factory=dict)
    shares: list[Share] = Field(default_factory=list)

    def listed(self, folder: FilePath, coordinates: Sequence[Coordinate]) -> Listed:
        """Its value; raises as a motion."""
        if self.file is not None:
            if self.joints or self.shares:
                raise InputError(Fault(("file",), "give 'file', or 'joints' and 'shares', and not both"))
            return read_poses(folder / self.file, coordinates)
        rows = _rows(self.joints, coordinates)
        return Listed(tuple(self.joints), rows, tuple(self.shares) or (1.0,) * len(rows))


def _rows(joints: dict[str, list[Any]], coordinates: Sequence[Coordinate]) -> tuple[tuple[float, ...], ...]:
    """The columns of coordinates as rows in SI units; what is no coordinate is a fault of the mechanism's."""
    dimensions = {str(c): c.dimension for c in coordinates}
    columns = [
        [quantity(x, dimensions.get(name, "angle"), "joints", name) for x in own] for name, own in joints.items()
    ]
    if len({*map(len, columns)}) > 1:
        raise InputError(Fault(("joints",), "must have as many values for every joint"))
    return tuple(zip(*columns, strict=True))


class BoxItem(Item):
    noun = "a box"
    body: Text
    low: Point
    high: Point
    at: Point = (0.0, 0.0, 0.0)


class PosesItem(Item):
    noun = "poses"
    motion: Annotated[MotionItem, BeforeValidator(_file)] | None = None
    motions: list[Annotated[MotionItem, BeforeValidator(_file)]] = Field(default_factory=list)
    list_: Annotated[ListItem, BeforeValidator(_file)] | None = Field(default=None, alias="list")
    box: BoxItem | None = None
    samples: Annotated[int, BeforeValidator(whole)] | None = None
    seed: Annotated[int, BeforeValidator(whole)] = 0
    whole_turns: bool = False

    def where(self, folder: FilePath, coordinates: Sequence[Coordinate]) -> Where:
        """Its value.

        Raises:
            InputError: a file that cannot be used, or more than one of motions, a list and a box.
        """
        every = [(("motion",), self.motion)] if self.motion else []
        every += [(("motions", i), item) for i, item in enumerate(self.motions)]
        motions = [_at(path, item.motion, folder, coordinates) for path, item in every]
        listed = None if self.list_ is None else _at(("list",), self.list_.listed, folder, coordinates)
        box = None if self.box is None else _at(("box",), Box, **self.box.values())
        return Where(tuple(motions), listed, box, self.samples, self.seed, self.whole_turns)


def _at(path: Path, make: Callable[..., Made], *args: Any, **values: Any) -> Made:
    """What is made, and the place of what is wrong with it; faults in other files stay there."""
    try:
        return make(*args, **values)
    except InputError as error:
        inside = [fault if fault.file else replace(fault, path=(*path, *fault.path)) for fault in error.faults]
        if all(fault.file for fault in inside):
            inside = [Fault(path, "cannot be used"), *inside]
        raise InputError(inside) from None


class NumberItem(Item):
    noun = "a limit"
    limit: Annotated[int, BeforeValidator(whole)]


class StiffnessItem(Item):
    noun = "a limit"
    limit: Stiffness


class EnergyItem(Item):
    noun = "a limit"
    limit: Annotated[float, number_of("energy")]


class CostItem(Item):
    noun = "cost"
    springs: NumberItem | None = None
    stiffness: StiffnessItem | None = None
    energy: EnergyItem | None = None

    def cost(self) -> Cost:
        """Its value."""
        given = {name: getattr(self, name) for name in ("springs", "stiffness", "energy")}
        return Cost(**{name: item.limit for name, item in given.items() if item is not None})


class GoalItem(Item):
    noun = "a goal"
    loads: list[ToolItem] = Field(default_factory=list)
    gravity: list[GravityItem] = Field(default_factory=list)
    tilt: Angle = 0.0
    poses: PosesItem = PosesItem()
    count: CountItem = CountItem()
    cost: CostItem = CostItem()

    def goal(self, folder: FilePath, coordinates: Sequence[Coordinate]) -> Goal:
        """Its value; files are relative to the folder of the mechanism file.

        Raises:
            InputError: a tilt out of range, or poses that cannot be used.
        """
        tools = (Tool(**item.values()) for item in self.loads)
        gravity = (Gravity(**item.values()) for item in self.gravity)
        loads = Loads(tuple(tools), tuple(gravity), self.tilt)
        where = _at(("poses",), self.poses.where, folder, coordinates)
        return Goal(loads, where, _at(("count",), Count, **self.count.values()), _at(("cost",), self.cost.cost))


ITEMS: dict[str, type[Item]] = {"loads": ToolItem, "gravity": GravityItem, "count": CountItem}
COSTS: dict[str, type[Item]] = {"springs": NumberItem, "stiffness": StiffnessItem, "energy": EnergyItem}
POSES: dict[str, type[Item]] = {"motion": MotionItem, "motions": MotionItem, "list": ListItem, "box": BoxItem}


def model_at(path: Path) -> type[Item]:
    """The model of what stands at a path inside the goal."""
    if path[:1] == ("poses",):
        return POSES.get(str(path[1]), PosesItem) if len(path) > 1 else PosesItem
    if path[:1] == ("cost",):
        return COSTS.get(str(path[1]), CostItem) if len(path) > 1 else CostItem
    return ITEMS.get(str(path[0]), GoalItem) if path else GoalItem
