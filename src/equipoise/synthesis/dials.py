"""What can be set on hardware whose ends are fixed: a rate or force and what goes with it, or a mass.

The torque is linear in a rate k and in ``k p``, where p is a free length, an angle at rest or a progression; of an
extension spring in its rate and its initial tension. So each element has at most two unknowns, in a polygon.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import inf, pi
from typing import NamedTuple

import numpy as np

from ..energy.evaluate import Potential
from ..kinematics import Tree
from ..model.arrays import Array
from ..model.elements import Element
from ..model.elements.laws import Compression, Extension, Gas, Linear
from ..model.elements.laws.constant import ConstantForce, ConstantTorque
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism

WIDE = 1000.0  # times what the file has: as far as a rate, a force or a mass goes where nothing limits it
ONE_NEWTON = 1.0  # of which an initial tension that is zero in the file is a thousandth
TURNS = 2 * pi  # [rad] either way: where an angle at rest may be

Limits = tuple[float, float]


class Setting(NamedTuple):
    """A number of an item: its field, its value in the file and its limits, in SI units."""

    field: str
    now: float
    limits: Limits

    @property
    def fixed(self) -> bool:
        """Whether it stays."""
        return self.limits[0] == self.limits[1]


@dataclass(frozen=True)
class Dial:
    """The numbers of one element or mass that can be set.

    Attributes:
        item: its name.
        first: a rate, force, torque or mass; it multiplies what the element does.
        second: a free length, angle at rest, progression or initial tension.
        product: the second unknown is the first times the second; else it is the second itself.
    """

    item: str
    first: Setting
    second: Setting | None = None
    product: bool = True

    @property
    def settings(self) -> tuple[Setting, ...]:
        """Both, or the one."""
        return (self.first,) if self.second is None else (self.first, self.second)

    @property
    def now(self) -> Array:
        """(1 or 2,) the unknowns as the file has them."""
        return self.unknowns(*(setting.now for setting in self.settings))

    @property
    def size(self) -> Array:
        """(1 or 2,) what a change of the unknowns counts in proportion to."""
        first = abs(self.first.now) or max(map(abs, self.first.limits)) or 1.0
        if self.second is None:
            return np.array([first])
        second = abs(self.second.now) or max(map(abs, self.second.limits)) or 1.0
        return np.array([first, first * second if self.product else second])

    def unknowns(self, first: float, second: float = 0.0) -> Array:
        """(1 or 2,) for values of the settings."""
        if self.second is None:
            return np.array([first])
        return np.array([first, first * second if self.product else second])

    def values(self, x: Array) -> tuple[float, ...]:
        """The inverse of `unknowns`, inside the limits; where the first is nothing, the second stays as it is."""
        first = float(np.clip(x[0], *self.first.limits))
        if self.second is None:
            return (first,)
        second = float(x[1]) if not self.product else float(x[1]) / first if first else self.second.now
        return first, float(np.clip(second, *self.second.limits))

    @property
    def polygon(self) -> tuple[Array, Array]:
        """(rows, 1 or 2) A and (rows,) b: the unknowns are possible where ``A x <= b``."""
        (low, high), width = self.first.limits, len(self.settings)
        A, b = [np.eye(width)[0], -np.eye(width)[0]], [high, -low]
        if self.second is not None:
            least, most = self.second.limits
            if self.product:
                sign = 1.0 if high > 0 else -1.0  # of the first, all of whose values have one
                A += [sign * np.array([-most, 1.0]), sign * np.array([least, -1.0])]
                b += [0.0, 0.0]
            else:
                A += [np.array([0.0, 1.0]), np.array([0.0, -1.0])]
                b += [most, -least]
        return np.array(A), np.array(b)

    @property
    def corners(self) -> Array:
        """(corners, 1 or 2) of the polygon, between which all that is possible lies."""
        seconds = (0.0,) if self.second is None else self.second.limits
        return np.array([self.unknowns(first, second) for first in self.first.limits for second in seconds])


def dials(
    mechanism: Mechanism, q: Array, bounds: Mapping[str, Mapping[str, Limits]], held: Sequence[str] = ()
) -> tuple[Dial, ...]:
    """Those of all elements that are not held, and of the masses that have a bound.

    Args:
        q: (N, n) the poses; a spring's free length is by default no more than its shortest length at these.
        bounds: item -> field -> limits in SI units.

    Raises:
        InputError: no such item or field, a limit that no such number can have, or nothing to set.
    """
    tree = Tree.of(mechanism)
    poses = tree.poses(q)
    found: list[Dial] = []
    for element in mechanism.springs:
        if element.name not in held:
            found += _of_element(element, float(element.path(tree, poses).min()))
    found += [
        Dial(m.name, Setting("mass", m.mass, (0.0, WIDE * m.mass))) for m in mechanism.masses
        if m.name in bounds and m.name not in held
    ]  # fmt: skip
    names = [item.name for item in (*mechanism.springs, *mechanism.masses)]
    for name in (*bounds, *held):
        if name not in names:
            raise InputError(Fault(("bound",), f"there is no spring or mass {nearest(name, names)}", tuple(names)))
    bounded = tuple(_bounded(dial, bounds.get(dial.item, {})) for dial in found)
    for name in bounds:
        if name not in [dial.item for dial in bounded]:
            raise InputError(Fault(("bound", name), "has no number that can be set with its ends fixed"))
    if all(setting.fixed for dial in bounded for setting in dial.settings):
        raise InputError(
            f"mechanism '{mechanism.name}': there is nothing to set; it has {len(names)} springs and masses"
        )
    return bounded


def _of_element(element: Element, shortest: float) -> Iterator[Dial]:
    law, own = element.law, element.__dataclass_fields__
    if isinstance(law, Linear):
        rate = Setting("stiffness", law.stiffness, (0.0, WIDE * law.stiffness))
        name, free = ("rest", law.free_length) if "rest" in own else ("free_length", law.free_length)
        limits = (-TURNS, TURNS) if element.path_unit == "rad" else (0.0, max(shortest, 0.0))
        yield Dial(element.name, rate, Setting(name, free, (min(limits[0], free), max(limits[1], free))))
    elif isinstance(law, Extension):
        rate = Setting("stiffness", law.stiffness, (0.0, WIDE * law.stiffness))
        most = WIDE * max(law.initial_tension, ONE_NEWTON)
        yield Dial(element.name, rate, Setting("initial_tension", law.initial_tension, (0.0, most)), product=False)
    elif isinstance(law, Compression):
        yield Dial(element.name, Setting("stiffness", law.stiffness, (0.0, WIDE * law.stiffness)))
    elif isinstance(law, Gas):
        growth = law.progression or (law.force_shortest or law.force) / law.force
        rate = Setting("force", law.force, (0.0, WIDE * law.force))
        yield Dial(element.name, rate, Setting("progression", growth, (growth, growth)))
    elif isinstance(law, (ConstantForce, ConstantTorque)):
        (number,) = (field.name for field in fields(law))
        far = WIDE * law.amount
        yield Dial(element.name, Setting(number, law.amount, (min(far, 0.0), max(far, 0.0))))


def _bounded(dial: Dial, bounds: Mapping[str, Limits]) -> Dial:
    """With other limits for some of its settings."""
    valid = tuple(setting.field for setting in dial.settings)
    for field, (low, high) in bounds.items():
        if field not in valid:
            raise InputError(Fault(("bound", dial.item), f"has no number {nearest(field, valid)}", valid))
        if not -inf < low <= high < inf:
            raise InputError(
                Fault(("bound", dial.item, field), f"must be from a lesser to a greater, found {low:g}:{high:g}")
            )
        if field == dial.first.field and low * high < 0:
            raise InputError(Fault(("bound", dial.item, field), f"must not change its sign, found {low:g}:{high:g}"))
        if field in ("stiffness", "mass", "initial_tension", "progression") and low < 0:
            raise InputError(Fault(("bound", dial.item, field), f"must be at least 0, found {low:g}"))
    first, second = (
        None if setting is None else setting._replace(limits=bounds.get(setting.field, setting.limits))
        for setting in (dial.first, dial.second)
    )
    return replace(dial, first=first, second=second)


def columns(mechanism: Mechanism, found: Sequence[Dial], q: Array) -> tuple[Array, Array]:
    """Torques (N, n, unknowns) of one unit of each unknown at poses (N, n), and (N, n) of all that stays."""
    tree = Tree.of(mechanism)
    poses = tree.poses(q)
    velocities = tree.velocities(q, poses)
    names = {dial.item for dial in found}
    rest = mechanism.with_springs(e for e in mechanism.springs if e.name not in names)
    rest = rest.with_masses(mass for mass in mechanism.masses if mass.name not in names)
    load = Potential(rest)(q).torque
    each = []
    for dial in found:
        of_mass = next((mass for mass in mechanism.masses if mass.name == dial.item), None)
        if of_mass is not None:
            each.append(Potential(rest.with_masses((*rest.masses, replace(of_mass, mass=1.0))))(q).torque - load)
            continue
        element = next(e for e in mechanism.springs if e.name == dial.item)
        one, both = (
            set_to(element, dial, values).state(tree, poses, velocities)[1] for values in ((1.0, 0.0), (1.0, 1.0))
        )
        each += [one] if dial.second is None else [one, both - one]
    return np.stack(each, axis=-1), load


def set_to(element: Element, dial: Dial, values: Sequence[float]) -> Element:
    """The element with these numbers."""
    given = dict(zip((setting.field for setting in dial.settings), values, strict=False))
    if "progression" in given:
        given["force_shortest"] = None  # type: ignore[assignment]
    return element.changed(**given)
