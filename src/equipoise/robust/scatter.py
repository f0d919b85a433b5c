"""How far a build is from its drawing: the parameters that scatter, and points as affine functions of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Literal, get_args

import numpy as np

from ..kinematics import Tree
from ..model.arrays import Array, frozen
from ..model.elements import lines
from ..model.errors import Fault, InputError, UnsupportedError, nearest
from ..model.mechanism import Mechanism
from ..model.units import AmountField

Shape = Literal["normal", "uniform"]
Kind = Literal["stiffness", "attachment", "mass", "length"]
KINDS: tuple[Kind, ...] = get_args(Kind)
LARGEST = 0.2  # a relative scatter beyond this draws masses and stiffnesses below zero


@dataclass(frozen=True)
class Scatter:
    """One standard deviation of a normal distribution, or the half width of a uniform one, of every value of a kind.

    Attributes:
        stiffness: of each spring, as a share of its own; 5 % is usual for wound springs.
        attachment: of each coordinate of each end of a spring [m].
        mass: of each body and point mass, as a share of its own; spring masses are taken as drawn.
        length: of each coordinate of each joint's place and of each mass centre [m].
    """

    stiffness: AmountField = AmountField("share", 0.05)
    attachment: AmountField = AmountField("length", 0.5e-3)
    mass: AmountField = AmountField("share", 0.01)
    length: AmountField = AmountField("length", 0.5e-3)
    shape: Shape = "normal"

    def __post_init__(self) -> None:
        for kind in KINDS:
            value, share = getattr(self, kind), kind in ("stiffness", "mass")
            if not 0 <= value <= (LARGEST if share else np.inf) or value == np.inf:
                limits = f"a share from 0 to {LARGEST:g}" if share else "a length of at least 0 m"
                raise InputError(Fault((kind,), f"must be {limits}, found {value:g}"))
        if self.shape not in get_args(Shape):
            choices = get_args(Shape)
            raise InputError(Fault(("shape",), f"no distribution {nearest(self.shape, choices)}", choices))

    def deviation(self, kind: Kind) -> float:
        """One standard deviation."""
        return getattr(self, kind) / (np.sqrt(3.0) if self.shape == "uniform" else 1.0)

    def times(self, factor: float) -> Scatter:
        """The same, every value `factor` times as large."""
        values = {kind: factor * getattr(self, kind) for kind in KINDS}
        return Scatter(**values, shape=self.shape)

    def draw(self, rng: np.random.Generator, builds: int, parameters: int) -> Array:
        """(builds, parameters) draws of mean 0 and variance 1."""
        if self.shape == "uniform":
            return rng.uniform(-np.sqrt(3.0), np.sqrt(3.0), (builds, parameters))
        return rng.standard_normal((builds, parameters))

    def to_dict(self) -> dict[str, object]:
        return asdict(self)


@dataclass(frozen=True)
class Parameter:
    """A value that scatters: `item` is the spring, body or joint it belongs to, `deviation` one standard deviation."""

    kind: Kind
    item: str
    value: str
    deviation: float

    @property
    def name(self) -> str:
        return f"{self.item}: {self.value}"


@frozen
class Lump:
    """A mass at a point: numbers of its parameters; a spring's end scatters with its attachment, not in mass."""

    body: int
    mass: float
    point: Array
    relative: int | None
    place: tuple[int, ...]


class Drawing:
    """Which parameters a mechanism has, numbered; those without scatter are left out.

    Attributes:
        parameters: in the order of the mechanism's sections.
        stiffness: parameter number of each spring's stiffness, or None.
        ends: of each spring's two ends, the three parameter numbers or none.
        offsets: the same of each joint, by the body it carries.
        lumps: every mass.

    Raises:
        UnsupportedError: lengths scatter in a mechanism with loops, which moves all its poses.
    """

    def __init__(self, mechanism: Mechanism, scatter: Scatter) -> None:
        if mechanism.loops and scatter.length:
            raise UnsupportedError("lengths cannot scatter where loops close: set them to 0 (--length 0)")
        self.scatter = scatter
        self.parameters: list[Parameter] = []
        index = Tree.of(mechanism).index
        springs = lines(mechanism, "tolerance")
        self.stiffness = [self._one("stiffness", s.name, "stiffness") for s in springs]
        self.ends = [
            (self._three("attachment", s.name, "p_a"), self._three("attachment", s.name, "p_b")) for s in springs
        ]
        self.offsets = {index[j.child]: self._three("length", j.name, "xyz") for j in mechanism.joints}
        self.lumps = list(self._lumps(mechanism, index))

    def _lumps(self, mechanism: Mechanism, index: dict[str, int]) -> Iterator[Lump]:
        heavy = [(b.name, b.name, b.mass, b.com, "com") for b in mechanism.bodies]
        heavy += [(m.name, m.body, m.mass, m.position, "position") for m in mechanism.masses]
        for item, body, mass, p, label in heavy:
            if mass and index[body]:
                relative, place = self._one("mass", item, "mass"), self._three("length", item, label)
                yield Lump(index[body], mass, np.array(p), relative, place)
        for spring, ends in zip(mechanism.springs, self.ends, strict=True):
            for (body, mass, p), place in zip(spring.lumps(), ends, strict=True):
                if mass and index[body]:
                    yield Lump(index[body], mass, np.array(p), None, place)

    def _one(self, kind: Kind, item: str, value: str, scale: float = 1.0) -> int | None:
        deviation = self.scatter.deviation(kind) * scale
        if not deviation:
            return None
        self.parameters.append(Parameter(kind, item, value, deviation))
        return len(self.parameters) - 1

    def _three(self, kind: Kind, item: str, label: str) -> tuple[int, ...]:
        numbers = (self._one(kind, item, f"{label}.{letter}") for letter in "xyz")
        return tuple(number for number in numbers if number is not None)
