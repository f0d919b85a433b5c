"""An element whose ends or joints are fixed and whose numbers are chosen: torsion, gas, constant or ordinary.

The unknowns are a rate or force k >= 0 and, where a free length or an angle at rest may be chosen, ``k u``: that
number is in the middle of its limits at u = 0 and on one of them at -1 and 1. So ``|k u| <= k``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...energy.fourier.frames import Frames
from ...energy.fourier.series import Series
from ...kinematics import Poses, Tree, Velocities, sample
from ...model.arrays import Array
from ...model.elements import Element, TorsionSpring
from ...model.errors import Fault, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.names import Names
from ..dials import Dial, dials, set_to
from .blocks import Block, Cone

POSES = 300  # at which a spring's shortest length is looked for


@dataclass(frozen=True)
class SetBlock(Block):
    """What `dial` sets on `element`.

    The unknowns are k [N/m, N m/rad, N or N m] and k u; a part is the element with one unit of k, its shape u.
    """

    element: Element
    dial: Dial

    @staticmethod
    def torsion(mechanism: Mechanism, joints: Iterable[str]) -> Iterator[SetBlock]:
        """A torsion spring on each of these joints, all revolute ones for "all".

        Raises:
            InputError: no such revolute joint.
        """
        valid, names = tuple(joint.name for joint in mechanism.joints if joint.type == "revolute"), tuple(joints)
        used = Names(element.name for element in mechanism.springs)
        for joint in valid if names == ("all",) else dict.fromkeys(names):
            if joint not in valid:
                raise InputError(Fault(("torsion",), f"no revolute joint {nearest(joint, valid)}", valid))
            spring = TorsionSpring(used.new(f"torsion {joint}"), ((joint, 1.0),), 1.0)
            (dial,) = dials(mechanism.with_springs([spring]), np.zeros((1, Tree.of(mechanism).n)), {})
            yield SetBlock(spring, dial)

    @staticmethod
    def of_file(mechanism: Mechanism, names: Iterable[str]) -> Iterator[SetBlock]:
        """The elements of the mechanism with these names.

        Raises:
            InputError: no such element, or one of which nothing can be set.
        """
        valid, names = tuple(element.name for element in mechanism.springs), tuple(dict.fromkeys(names))
        for name in names:
            if name not in valid:
                raise InputError(Fault(("tune",), f"there is no spring {nearest(name, valid)}", valid))
        if not names:
            return
        held = [name for name in valid if name not in names]
        found = {dial.item: dial for dial in dials(mechanism, sample(Tree.of(mechanism), POSES), {}, held)}
        for element in mechanism.springs:
            dial = found.get(element.name)
            if element.name in names:
                if dial is None or not dial.product:
                    raise InputError(
                        Fault(("tune",), f"'{element.name}' is {element.noun}: it cannot be designed here")
                    )
                yield SetBlock(element, dial)

    @property
    def limits(self) -> tuple[float, float]:
        """Middle and half width of what its second number may be."""
        low, high = (0.0, 0.0) if self.dial.second is None else self.dial.second.limits
        return (low + high) / 2, (high - low) / 2

    @property
    def sign(self) -> float:
        """Of its rate or force."""
        return -1.0 if self.dial.first.now < 0 else 1.0

    @property
    def shape(self) -> int:
        return int(self.limits[1] > 0)

    @property
    def unknowns(self) -> int:
        return 1 + self.shape

    @property
    def place(self) -> tuple[str, ...]:
        return (self.element.name,)

    def _at(self, u: float) -> Element:
        """One unit of it."""
        middle, half = self.limits
        return set_to(self.element, self.dial, (self.sign, middle + half * u))

    @property
    def _ends(self) -> list[Element]:
        """Two whose difference is what ``k u`` does, or the one."""
        return [self._at(u) for u in (0.0, 1.0)[: self.unknowns]]

    def series(self, frames: Frames) -> Series:
        each = [element.series(frames) for element in self._ends]
        rows = np.array([[1.0, -1.0], [0.0, 1.0]])[: self.unknowns, : self.unknowns]
        return Series.sum([Series(s.keys, s.coef[:, :, 0] * row) for s, row in zip(each, rows, strict=True)])

    def sampled(self, tree: Tree, q: Array, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        torque, energy = [], []
        for element in self._ends:
            path, pull = element.state(tree, poses, velocities)
            torque.append(pull)
            energy.append(element.law.energy(path).sum())
        if self.shape:
            torque[1], energy[1] = torque[1] - torque[0], energy[1] - energy[0]
        return np.stack(torque, axis=-1), np.array(energy)

    def cones(self) -> Iterable[Cone]:
        yield Cone("nonnegative", np.array([[1.0, 1.0], [1.0, -1.0]]) if self.shape else np.eye(1))

    def part(self, u: Array) -> Array:
        return np.hstack([np.ones((len(u), 1)), u])

    def slopes(self, u: Array) -> Array:
        return np.tile(np.eye(self.unknowns)[1:], (len(u), 1, 1))

    def split(self, x: Array, least: float) -> tuple[Array, Array]:
        k = x[:1]
        return (np.zeros(0), np.zeros((0, self.shape))) if k[0] < least else (k, self.project(x[None, 1:] / k[0]))

    def cost(self, energy: Array) -> Array:
        """Of the rate alone: energies of preloads are counted from anywhere."""
        return np.abs(energy) * np.eye(self.unknowns)[0]

    def add(self, mechanism: Mechanism, k: float, u: Array) -> Mechanism:
        middle, half = self.limits
        made = set_to(self.element, self.dial, (self.sign * k, middle + half * float(u.sum())))
        return mechanism.with_springs((*mechanism.springs, made))


def without(mechanism: Mechanism, blocks: Iterable[Block]) -> Mechanism:
    """The mechanism without the elements that blocks choose anew."""
    names = {block.element.name for block in blocks if isinstance(block, SetBlock)}
    return replace(mechanism, springs=tuple(element for element in mechanism.springs if element.name not in names))
