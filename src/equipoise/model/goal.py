"""What a design is for: what hangs on the mechanism, and which torque counts by how much. Frozen values.

A mechanism carries its goal, so that a design says what it was made for and can be judged by that again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import pi
from typing import TYPE_CHECKING, Any, Literal

from .errors import Fault, InputError, Path, at_least, finite, known, nearest
from .immutable import immutable
from .motion import MOST, Where
from .units import Amount, number, point, quantity

if TYPE_CHECKING:
    from .mechanism import Mechanism

Vec3 = tuple[float, float, float]
Torque = Literal["rms", "peak"]
TORQUES: tuple[Torque, ...] = ("rms", "peak")
SHARES = ("effort",)


@dataclass(frozen=True)
class Tool:
    """What a body carries at a point: a mass, or any mass of a range. Of several tools one is carried at a time.

    Attributes:
        payload: [kg] the smallest and the largest; made from one mass, or from both.
        at: [m] in the frame of `body`.
        share: how often it is carried, relative to the other tools.

    Raises:
        InputError: not one or two masses of at least 0, the smaller one first; not a point; a share of 0 or less.
    """

    name: str
    body: str
    payload: tuple[float, float]
    at: Vec3 = (0.0, 0.0, 0.0)
    share: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "payload", masses(self.payload))
        object.__setattr__(self, "at", point(self.at, "at"))
        object.__setattr__(self, "share", number("share", self.share, positive=True))

    @property
    def mean(self) -> float:
        """[kg] the middle of its range."""
        return sum(self.payload) / 2


def masses(given: Amount | Sequence[Amount]) -> tuple[float, float]:
    """One mass or the smallest and largest [kg], as a pair.

    Raises:
        InputError: they are not.
    """
    every = (given,) if isinstance(given, (str, float, int)) else tuple(given)
    if len(every) not in (1, 2):
        raise InputError(Fault(("payload",), f"must be one mass, or the smallest and largest, found {[*every]}"))
    low, high = (number("payload", quantity(m, "mass", "payload"), positive=False) for m in (every[0], every[-1]))
    if high < low:
        raise InputError(Fault(("payload",), f"the smallest comes first, found {low:g} kg, {high:g} kg"))
    return low, high


@dataclass(frozen=True)
class Gravity:
    """A direction of gravity, of another way to mount the mechanism: `vector` [m/s^2] in the world's frame."""

    vector: Vec3
    share: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "share", number("share", self.share, positive=True))


@dataclass(frozen=True)
class Loads:
    """Alternatives: one tool, one gravity and one tilt at a time.

    Of root mean squares the mean over all of them counts (of a payload's range: over its two ends), of peaks the worst.

    Attributes:
        tools: none: the mechanism as it is.
        gravity: none: the mechanism's own.
        tilt: [rad] the base leans by up to this, in every direction.
    """

    tools: tuple[Tool, ...] = ()
    gravity: tuple[Gravity, ...] = ()
    tilt: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "tools", tuple(self.tools))
        object.__setattr__(self, "gravity", tuple(self.gravity))
        tilt = number("tilt", quantity(self.tilt, "angle", "tilt"), positive=False)
        if tilt > pi / 2:
            raise InputError(Fault(("tilt",), f"must be at most a quarter turn, found {tilt:g} rad"))
        object.__setattr__(self, "tilt", tilt)


@dataclass(frozen=True)
class Count:
    """By how much the torque of each joint counts.

    Attributes:
        torque: the root mean square of all joints together, or the largest of any joint.
        joints: joint or coordinate -> a factor, 1 where none is given.
        only: the joints or coordinates that count, None for all.
        share_of: "effort": torque as a share of what the joint's motor can do.
        heat: what the torque makes in the motor instead: (torque / torque constant)^2 resistance.
        friction: only what the dry friction of a joint does not hold; of the largest torque.

    Raises:
        InputError: an unknown torque or share, a factor below 0, shares and heat at once, friction of a mean square.
    """

    torque: Torque = "rms"
    joints: Mapping[str, float] = field(default_factory=dict, hash=False)
    only: tuple[str, ...] | None = None
    share_of: Literal["effort"] | None = None
    heat: bool = False
    friction: bool = False

    def __post_init__(self) -> None:
        if self.heat and self.share_of:
            raise InputError(Fault(("heat",), "does not go with share_of: give one of them"))
        if self.friction and self.torque != "peak":
            problem = "does not go with torque rms: what friction does not hold is known of the peak"
            raise InputError(Fault(("friction",), problem))
        for name, value, valid in (("torque", self.torque, TORQUES), ("share_of", self.share_of, (None, *SHARES))):
            if value not in valid:
                choices = tuple(one for one in valid if one)
                raise InputError(Fault((name,), f"unknown {name} {nearest(value, choices)}", choices))
        joints = {name: number("joints", value, positive=False) for name, value in self.joints.items()}
        object.__setattr__(self, "joints", immutable(joints))
        object.__setattr__(self, "only", None if self.only is None else tuple(self.only))


@dataclass(frozen=True)
class Cost:
    """What a design may cost at most.

    Attributes:
        springs: their number.
        stiffness: [N/m] the rates of all springs together.
        energy: [J] the energy that they store together, on the mean over the poses.
    """

    springs: int | None = None
    stiffness: float | None = None
    energy: float | None = None

    def __post_init__(self) -> None:
        for name in LIMITED:
            dimension, value = LIMITED[name], getattr(self, name)
            if value is not None:
                most = quantity(value, dimension, name)
                object.__setattr__(self, name, number(name, most, positive=True))
        if self.springs is not None and (self.springs != int(self.springs) or self.springs < 1):
            raise InputError(Fault(("springs",), f"must be a whole number of at least 1, found {self.springs}"))

    def to_dict(self) -> dict[str, Any]:
        """As a mechanism file has it."""
        every = {name: getattr(self, name) for name in ("springs", *LIMITED)}
        return {name: {"limit": value} for name, value in every.items() if value is not None}


LIMITED = {"stiffness": "stiffness", "energy": "energy"}
"""What is limited for all springs together, and its dimension."""


@dataclass(frozen=True)
class Goal:
    """What a design is for."""

    loads: Loads = field(default_factory=Loads)
    poses: Where = field(default_factory=Where)
    count: Count = field(default_factory=Count)
    cost: Cost = field(default_factory=Cost)

    def __bool__(self) -> bool:
        """Whether anything but what counts by default is asked for."""
        return self != BY_DEFAULT

    def to_dict(self) -> dict[str, Any]:
        """As a mechanism file has it, without what is as by default."""
        loads, count = self.loads, self.count
        tools = [
            {"name": tool.name, "body": tool.body, "at": [*tool.at], "payload": [*tool.payload], **_share(tool.share)}
            for tool in loads.tools
        ]
        gravity = [{"vector": [*one.vector], **_share(one.share)} for one in loads.gravity]
        counted = {
            "torque": count.torque,
            "joints": dict(count.joints),
            "only": None if count.only is None else [*count.only],
            "share_of": count.share_of,
            "heat": count.heat,
            "friction": count.friction,
        }
        defaults = {"torque": "rms", "joints": {}, "only": None, "share_of": None, "heat": False, "friction": False}
        counted = {name: value for name, value in counted.items() if value != defaults[name]}
        poses = self.poses.to_dict()
        found = {"loads": tools, "gravity": gravity, "tilt": loads.tilt, "poses": poses, "count": counted}
        found["cost"] = self.cost.to_dict()
        return {name: value for name, value in found.items() if value}

    def counting(self, **changes: Any) -> Goal:
        """The same with other fields of `count`."""
        return replace(self, count=replace(self.count, **changes))

    def faults(self, m: Mechanism) -> Iterator[Fault]:
        """What does not fit a mechanism, with paths of the mechanism file."""
        names: dict[str, int] = {}
        for i, tool in enumerate(self.loads.tools):
            path: Path = ("goal", "loads", i)
            yield from known((*path, "body"), tool.body, "body", m.body_names)
            yield from finite((*path, "at"), tool.at)
            if not tool.name:
                yield Fault((*path, "name"), "must not be empty")
            elif tool.name in names:
                first = names[tool.name]
                yield Fault((*path, "name"), f"duplicate name '{tool.name}', first used by goal.loads[{first}]")
            names.setdefault(tool.name, i)
        for i, gravity in enumerate(self.loads.gravity):
            yield from finite(("goal", "gravity", i, "vector"), gravity.vector)
        if self.loads.tilt:
            yield from at_least(("goal", "tilt"), self.loads.tilt, 0, "rad")
        for part, name in self.poses.coordinates():
            if name not in m.coordinates:
                yield Fault(("goal", "poses", part), f"no coordinate {nearest(name, m.coordinates)}", m.coordinates)
        if self.poses.box is not None:
            yield from known(("goal", "poses", "box", "body"), self.poses.box.body, "body", m.body_names)
        if self.poses.size > MOST:
            problem = f"has {self.poses.size:,} numbers, and a file holds at most {MOST:,}: leave out rows"
            yield Fault(("goal", "poses"), problem)
        yield from _joints(("goal", "count", "joints"), self.count.joints, m)
        yield from _joints(("goal", "count", "only"), self.count.only or (), m)


BY_DEFAULT = Goal()
"""The root mean square torque of all joints, of the mechanism as it is."""


def _share(share: float) -> dict[str, float]:
    return {} if share == 1.0 else {"share": share}


def _joints(path: Path, names: Iterable[str], m: Mechanism) -> Iterator[Fault]:
    choices = m.coordinates
    valid = {*choices, *(name.rpartition(".")[0] for name in choices)}
    for name in names:
        if name not in valid:
            yield Fault((*path, name), f"there is no joint {nearest(name, choices)}", choices)
