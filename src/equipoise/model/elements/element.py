"""What every force element answers, whatever its kind. Sizes and places come from the tree and poses that are given.

Values only: a mechanism holds elements as it holds bodies. What they need of kinematics, Fourier series or the kernel's
symbols is handed to them, so that a kind is one file and everything else asks.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import Field, replace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from ..arrays import Array
from ..errors import Fault
from .laws.law import Knob, State

if TYPE_CHECKING:
    from ...energy.fourier.frames import Frames
    from ...energy.fourier.series import Series
    from ...energy.kernel.trace import Trace, Value, Vector
    from ...energy.span.nodes import Nodes
    from ...kinematics import Poses, Tree, Velocities
    from ..mechanism import Mechanism
    from .cam_outline import Track
    from .guides import Pulley

Vec3 = tuple[float, float, float]
End = tuple[str, Vec3]  # a body's name and a point in its frame [m]
Range = tuple[float, float]
Tendon = tuple[str, Mapping[str, Iterable[float]], Sequence[tuple[str, Mapping[str, str | float]]]]
"""Of MJCF: its tag, its numbers, and what it runs along (tag and attributes)."""


Pull = Callable[["Value"], None]
LinePen = Callable[[tuple[End, End], float], tuple["Vector", Pull]]
AnglePen = Callable[[tuple[tuple[str, float], ...]], tuple["Value", Pull]]


class Pens(NamedTuple):
    """How a recursion of the kernel writes paths down; each gives a path and takes what multiplies its derivative.

    Attributes:
        line: (ends, scale) -> the stretch times the scale, and what takes the factor of its torque.
        angle: (ratio of each joint) -> the sum of the joints' values, and what takes the force.
    """

    line: LinePen
    angle: AnglePen


class Element(ABC):
    """A force element: frozen, with a `name`, the path that its class has, and a law.

    Attributes:
        kind: as a mechanism file names it.
        noun: as a message names it.
        knobs: its numbers that a viewer offers to turn.
        path_unit, force_unit: of its path ("m" or "rad") and of its force ("N" or "N m").
        law: force as a function of the path; a field of some classes and made by others.
    """

    path_unit: ClassVar[str]
    force_unit: ClassVar[str]
    name: str

    if TYPE_CHECKING:
        # every kind is a dataclass with fields of its own, which only who knows the kind can ask for
        __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

        def __getattr__(self, name: str) -> Any: ...

    @property
    def kind(self) -> str:
        return self.law.kind

    @property
    def noun(self) -> str:
        return self.law.noun

    @property
    def knobs(self) -> tuple[Knob, ...]:
        return self.law.knobs

    # physics

    @abstractmethod
    def path(self, tree: Tree, poses: Poses) -> Array:
        """(N,) [m or rad]."""

    @abstractmethod
    def lever_arms(self, tree: Tree, poses: Poses, velocities: Velocities) -> Array:
        """(N, n) change of the path per unit of each coordinate [m or 1, or 1 or 1/m]."""

    def state(self, tree: Tree, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        """Path (N,) [m or rad] and holding torque (N, n) [N m or N]."""
        path = self.path(tree, poses)
        return path, self.law.pull(path)[:, None] * self.lever_arms(tree, poses, velocities)

    @abstractmethod
    def series(self, frames: Frames) -> Series:
        """The energy [J] as a finite series; coefficients (T, 1, 1).

        Raises:
            NoFourierForm: it has none.
        """

    @abstractmethod
    def affine(self, nodes: Nodes) -> Array:
        """What its energy is half the square of, a vector in the world's frame as `nodes` write it [sqrt(J)].

        Raises:
            NoFourierForm: its energy is no such square.
        """

    @abstractmethod
    def symbols(self, t: Trace, pens: Pens) -> tuple[Value, Value]:
        """Path and energy [J] on the kernel's symbols; the pens get its torque."""

    @property
    def compiled(self) -> bool:
        """Whether it has symbols; if not, its mechanism is summed."""
        return True

    def routing(self, tree: Tree, poses: Poses) -> list[tuple[State, Array]]:
        """What is to be reported beside the states of its law: a state, and the number (N,) that it is about."""
        return []

    def lumps(self) -> Iterator[tuple[str, float, Vec3]]:
        """Its own mass as (body, mass [kg], point in the body's frame [m])."""
        return iter(())

    @property
    def turns(self) -> tuple[str, ...]:
        """The joints whose angle itself, not its sine and cosine, is in its energy."""
        return ()

    # files

    @abstractmethod
    def faults(self, mechanism: Mechanism) -> Iterator[Fault]:
        """What is wrong with it, paths from the element on; its name is checked with all others."""

    @property
    @abstractmethod
    def keys(self) -> dict[str, Any]:
        """What a mechanism file says of it beside its name and kind, as far as ``check --json`` repeats it."""

    def to_dict(self, path: Range, force: Range) -> dict[str, Any]:
        """Its entry in ``check --json``, with the least and greatest path [m or rad] and force [N or N m]."""
        used = {"path": list(path), "force": list(force), "unit": self.force_unit}
        return {"name": self.name, "kind": self.kind, **self.keys, **used}

    @abstractmethod
    def mjcf(self) -> Tendon:
        """It as a tendon of MJCF; without numbers where no tendon holds its law."""

    def mjcf_bias(self) -> tuple[float, float] | None:
        """(b0, b1) where it is no tendon's spring but an actuator with the force ``-(b0 + b1 path)``, else None."""
        return None if self.mjcf()[1] else self.law.mjcf_bias()

    # pictures and words

    @property
    def places(self) -> tuple[tuple[str, End], ...]:
        """The points that it runs through in order, each with a mark."""
        return tuple(zip("ab", self.ends, strict=False))

    @property
    def wheels(self) -> tuple[tuple[str, Pulley], ...]:
        """The pulleys that it lies on, each with a mark."""
        return ()

    @property
    def ends(self) -> tuple[End, ...]:
        """The points where it is fixed to bodies; none where a joint carries it."""
        return ()

    def outline(self, tree: Tree) -> tuple[End | Track, ...]:
        """A line to draw it along, as points of bodies, fixed or moving in them."""
        return self.ends

    @property
    @abstractmethod
    def where(self) -> str:
        """What it acts on, for a legend."""

    @property
    @abstractmethod
    def between(self) -> str:
        """The same within a sentence."""

    @property
    def strength(self) -> tuple[float, str]:
        """The number that says how strong it is, and its unit."""
        number, unit = self.law.strength
        return number, unit or self.force_unit

    @property
    def free(self) -> float | None:
        """The path at which it exerts nothing [m or rad], where there is one."""
        return self.law.free

    @abstractmethod
    def sentence(self, path: Range, force: Range) -> str:
        """One line for a terminal: what it is, where, and how it is used."""

    def number(self, field: str) -> float:
        """The value of a number of its own or of its law."""
        return float(getattr(self if field in self.__dataclass_fields__ else self.law, field))

    def changed(self, **values: Any) -> Self:
        """The same with other values of its fields, or of its law's."""
        own = {name: value for name, value in values.items() if name in self.__dataclass_fields__}
        of_law = {name: value for name, value in values.items() if name not in own}
        return replace(self, **own, **({"law": replace(self.law, **of_law)} if of_law else {}))

    @abstractmethod
    def scaled(self, factor: float) -> Element:
        """The same, its force times `factor`."""
