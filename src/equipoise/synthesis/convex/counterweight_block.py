"""The counterweight of one body: a mass and its moment, within a ball about the body's origin (docs/theory.md).

Weights add up, so any number of them on a body does what one of the same mass in their centre does.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from ...energy.fourier.frames import Frames
from ...energy.fourier.series import Series
from ...kinematics import Poses, Tree, Velocities
from ...kinematics.groups import places
from ...model.arrays import Array
from ...model.errors import Fault, InputError, nearest
from ...model.mechanism import Mechanism, PointMass
from ...model.names import Names
from ...model.region import EXTREME, Region
from ...model.units import Amount, quantity
from ..mounts import Mounts
from .ball_block import BallBlock
from .blocks import Cone

SIZE = 4  # a mass and three moments
ROUNDING = 1e-12  # of the radius: a coordinate that is zero
EARTH = 9.81  # [m/s^2] what mass times radius is worth beside the energy of springs


@dataclass(frozen=True)
class CounterweightBlock(BallBlock):
    """A mass on `body`, within `radius` [m] of its origin.

    The unknowns are m and m p / radius [kg]; a part is a weight, its shape p / radius.
    """

    body: str
    radius: float
    weighs: ClassVar[bool] = True

    @classmethod
    def each(cls, mechanism: Mechanism, given: Amount | Mapping[str, Amount]) -> Iterator[Self]:
        """One for every link that moves, within one distance [m], or for each of the bodies that have one.

        Raises:
            InputError: no such body, one that does not move, or a distance out of all proportion to the mechanism.
        """
        mounts, choices = Mounts.of(mechanism), moving(mechanism)
        named = given if isinstance(given, Mapping) else dict.fromkeys(mounts.bodies[1:], given)
        if not named:
            raise InputError(Fault(("counterweights",), "no body is named", choices))
        for body, amount in named.items():
            if body not in choices:
                what = (
                    f"'{body}' does not move" if body in mechanism.body_names else f"no body {nearest(body, choices)}"
                )
                raise InputError(Fault(("counterweights",), what, choices))
            radius = quantity(amount, "length", "counterweights", body)
            least, most = mounts.reach / EXTREME, mounts.reach * EXTREME
            if not least <= radius <= most:
                problem = f"must be between {least:.1g} m and {most:.1g} m, found {radius:g} m"
                raise InputError(Fault(("counterweights", body), problem))
            yield cls(body, radius)

    @property
    def unknowns(self) -> int:
        return SIZE

    @property
    def shape(self) -> int:
        return SIZE - 1

    @property
    def place(self) -> tuple[str, ...]:
        return (self.body,)

    def series(self, frames: Frames) -> Series:
        g, body = -np.array(frames.tree.mechanism.gravity), frames.tree.index[self.body]
        at = [frames.linear(g, frames.moment([(body, 1.0, p)])) for p in self._ends()]
        return Series.sum([Series(s.keys, s.coef[:, :, 0] * row) for s, row in zip(at, self._rows(), strict=True)])

    def sampled(self, tree: Tree, q: Array, poses: Poses, velocities: Velocities) -> tuple[Array, Array]:
        g, body = -np.array(tree.mechanism.gravity), tree.index[self.body]
        energy = np.stack([poses.point(body, p) @ g for p in self._ends()], axis=-1) @ self._rows()
        rates = [np.einsum("i,nij->nj", g, velocities.point(poses, body, p)) for p in self._ends()]
        return np.stack(rates, axis=-1) @ self._rows(), energy.sum(axis=0)

    def _ends(self) -> Array:
        """Points whose unit masses span all weights (unknowns, 3) [m]."""
        return self.radius * self._shapes()

    @staticmethod
    def _shapes() -> Array:
        """(unknowns, shape) of them."""
        return np.vstack([np.zeros(3), np.eye(3)])

    def _rows(self) -> Array:
        """What the energies of unit masses at `_ends` are in those of the unknowns (unknowns, unknowns)."""
        return np.asarray(np.linalg.inv(self.part(self._shapes())).T, float)

    def cones(self) -> Iterable[Cone]:
        yield Cone("second order", np.eye(SIZE))

    def cost(self, energy: Array) -> Array:
        """A weight's energy says nothing; its mass does."""
        return EARTH * self.radius * np.eye(SIZE)[0]

    def add(self, mechanism: Mechanism, k: float, u: Array) -> Mechanism:
        x, y, z = Region.ball(self.radius).inside(np.where(np.abs(u) < ROUNDING, 0.0, u)).tolist()
        names = Names(mass.name for mass in mechanism.masses)
        weight = PointMass(names.new(f"counterweight {self.body}"), self.body, k, (x, y, z))
        return mechanism.with_masses((*mechanism.masses, weight))

    def enlarged(self, factor: float) -> tuple[CounterweightBlock, Array]:
        return CounterweightBlock(self.body, factor * self.radius), np.array([1.0, factor, factor, factor])


def moving(mechanism: Mechanism) -> tuple[str, ...]:
    """The bodies that move: a weight on any other does nothing."""
    tree = Tree.of(mechanism)
    place = places(tree, ("fixed",))
    return tuple(name for i, name in enumerate(tree.names) if place[i].root)
