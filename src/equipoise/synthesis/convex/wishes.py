"""What a person wants of equivalent springs, as rows that are to be small beside the torque.

For each spring: its ends on the side of the link's inboard axis on which its mass centre is, in the plane of parallel
axes where there is one, little force, short, in line with the mass centre.
"""

from __future__ import annotations

from copy import copy
from typing import Literal, get_args

import numpy as np

from ...kinematics import Poses, Tree, sample
from ...model.arrays import Array, frozen
from ...model.region import Region
from .drawn import Plane, drawn, towards_mass
from .least_squares_form import LeastSquaresForm
from .polish import Parts, by_block
from .spring_block import SpringBlock

Preference = Literal["force", "energy", "length", "rate"]
PREFERENCES: tuple[Preference, ...] = get_args(Preference)
WEIGHTS = {
    "side": 0.1, "plane": 0.3, "offset": 0.1, "in line": 0.03,
    "force": 1.0, "length": 0.05, "energy": 0.0, "rate": 0.0,
}  # fmt: skip
FIRST = 5.0  # of what is preferred
STRICT = 1.0  # of the right side, where it is insisted on
STEP = 1e-3  # relative: what is preferred counts as equal
POSES = 100  # at which forces and lengths are looked at
WRONG = 0.01  # share of a region: so far on the wrong side
LINEAR = ("side", "side", "in line", "in line", "plane", "offset", "offset")  # rows that are linear in the ends
SIDES = 2  # of them that count on one side only
ROWS = len(LINEAR) + 4


@frozen
class _Place:
    """Of the springs of one block: linear rows (LINEAR, side), stretch (POSES, 3, side), mean energy (unknowns,)."""

    linear: Array
    stretch: Array
    energy: Array
    plane: Plane | None


class Wishes:
    """The rows of `polish`, in proportion to the forces, lengths, energies and rates of some parts."""

    def __init__(self, reduced: LeastSquaresForm, parts: Parts, prefer: Preference | None = None) -> None:
        self.reduced, self.prefer = reduced, prefer
        self.weights = WEIGHTS | ({} if prefer is None else {prefer: FIRST})
        mechanism = reduced.problem.judged
        tree = self.tree = Tree.of(mechanism)
        poses = tree.poses(sample(tree, POSES, 0))
        self.places = {
            number: _place(tree, poses, block, reduced.cost[number])
            for block, _, number in by_block(reduced, parts.block)
            if isinstance(block, SpringBlock)
        }
        self.unit = dict.fromkeys(("force", "length", "energy", "rate"), 1.0)
        every = np.abs(self._each(parts)[0]).max(axis=1).min(axis=0)  # of the set in which the most is the least
        self.unit = {name: max(float(most), 1e-300) for name, most in zip(self.unit, every, strict=True)}

    def rows(self, parts: Parts) -> Array:
        """(batch, parts ROWS)."""
        linear, measures = self._linear(parts)[0], self._each(parts)[0] / [*self.unit.values()]
        weights = [self.weights[name] for name in self.unit]
        measures = measures**_POWERS * weights
        return np.concatenate([linear, measures], axis=2).reshape(len(parts), -1)

    def slopes(self, parts: Parts) -> Array:
        """(batch, parts ROWS, parts (1 + shape))."""
        units, weights = np.array([*self.unit.values()]), np.array([self.weights[name] for name in self.unit])
        (values, slopes), (_, linear) = self._each(parts), self._linear(parts)
        factor = _POWERS * np.maximum(values / units, 1e-12) ** (_POWERS - 1) * weights / units
        own = np.concatenate([linear, slopes * factor[..., None]], axis=2)  # (batch, parts, ROWS, 1 + shape)
        batch, count, rows, width = own.shape
        out = np.zeros((batch, count, rows, count, width))
        for i in range(count):
            out[:, i, :, i] = own[:, i]
        return out.reshape(batch, count * rows, count * width)

    @property
    def usual(self) -> tuple[Wishes, Wishes]:
        """Those without a preference, and the same with the right side above all."""
        return self._with(WEIGHTS), self._with({**WEIGHTS, "side": STRICT})

    def _with(self, weights: dict[str, float]) -> Wishes:
        other = copy(self)
        other.weights, other.prefer = weights, None
        return other

    def drawn(self, parts: Parts) -> Parts:
        """The same springs of a set (batch of 1), each where one would draw it."""
        u = parts.u.copy()
        for i, number in enumerate(parts.block[0].tolist()):
            block = self.reduced.blocks[number]
            if isinstance(block, SpringBlock):
                own = slice(block.shape)
                u[0, i, own] = drawn(self.tree, block, self.places[number].plane, u[0, i, own])
        return Parts(parts.block, parts.k, u)

    def stored(self, parts: Parts) -> float:
        """[J] The largest stored energies of a set (batch of 1) together, what springs weigh is in proportion to."""
        force, length = np.moveaxis(self._each(parts)[0][0], 1, 0)[:2]
        return float(force @ length) / 2

    def worth(self, parts: Parts) -> list[tuple[int, float]]:
        """Of each set: what comes first, and how little the wishes are met; less is better.

        First is what is preferred, in steps of a thousandth, else how many ends are on the wrong side.
        """
        first = (self._linear(parts)[0][..., :SIDES] < -WRONG * self.weights["side"]).sum(axis=(1, 2))
        if self.prefer is not None:
            each = self._each(parts)[0][..., [*self.unit].index(self.prefer)]
            measure = each.sum(axis=1) if self.prefer == "energy" else each.max(axis=1)
            first = np.rint(np.log(np.maximum(measure, 1e-300)) / STEP)
        return list(zip(first.astype(int).tolist(), (self.rows(parts) ** 2).sum(axis=1).tolist(), strict=True))

    def _linear(self, parts: Parts) -> tuple[Array, Array]:
        """(batch, parts, LINEAR) and the derivative (..., 1 + shape)."""
        weights = np.array([self.weights[name] for name in LINEAR])
        rows = np.zeros((*parts.k.shape, len(LINEAR)))
        slopes = np.zeros((*rows.shape, 1 + parts.u.shape[2]))
        for block, at, number in by_block(self.reduced, parts.block):
            if not isinstance(block, SpringBlock):
                continue
            own = block.ends(parts.u[at, : block.shape]) @ self.places[number].linear.T
            wrong = own < 0
            wrong[:, SIDES:] = True
            rows[at] = np.where(wrong, own, 0.0) * weights
            by_u = self.places[number].linear[:, block.others] * weights[:, None]
            slopes[at, :, 1 : 1 + block.shape] = np.where(wrong[..., None], by_u, 0.0)
        return rows, slopes

    def _each(self, parts: Parts) -> tuple[Array, Array]:
        """(batch, parts, 4) largest force [N], length [m], mean energy [J], rate [N/m]; and (..., 1 + shape) slopes."""
        values = np.zeros((*parts.k.shape, 4))
        slopes = np.zeros((*values.shape, 1 + parts.u.shape[2]))
        for block, at, number in by_block(self.reduced, parts.block):
            if not isinstance(block, SpringBlock):
                continue
            place, k, u = self.places[number], parts.k[at], parts.u[at, : block.shape]
            inner, n = slice(1, 1 + block.shape), np.arange(len(k))
            d = np.einsum("pis,ns->npi", place.stretch, block.ends(u))
            lengths = np.linalg.norm(d, axis=2)
            worst = lengths.argmax(axis=1)
            length = np.maximum(lengths[n, worst], 1e-12)
            by_u = np.einsum("ni,nis->ns", d[n, worst], place.stretch[worst])[:, block.others] / length[:, None]
            energy, by_energy = block.part(u) @ place.energy, block.slopes(u) @ place.energy
            values[at] = np.stack([k * length, length, k * energy, k], axis=1)
            found = np.zeros((len(k), 4, 1 + parts.u.shape[2]))
            found[:, [0, 2, 3], 0] = np.stack([k * length, k * energy, k], axis=1)
            found[:, :3, inner] = np.stack([k[:, None] * by_u, by_u, k[:, None] * by_energy], axis=1)
            slopes[at] = found
        return values, slopes


_POWERS = np.array([2.0, 1.0, 0.5, 2.0])  # the largest force and rate count most, and all energies together


def _place(tree: Tree, poses: Poses, block: SpringBlock, energy: Array) -> _Place:
    A, B = (tree.index[name] for name in block.place)
    stretch = np.concatenate([-poses.R[:, A], (poses.p[:, B] - poses.p[:, A])[:, :, None], poses.R[:, B]], axis=2)
    linear = np.zeros((len(LINEAR), 7))
    ends = (block.region_a, slice(0, 3)), (block.region_b, slice(4, 7))
    sizes = [max(region.half) or float(np.linalg.norm(region.at)) or 1.0 for region, _ in ends]
    for end, (_, own) in enumerate(ends):
        centre = towards_mass(tree, block.place[end])
        if centre is not None:
            axis, towards = centre
            linear[end, own] = towards / sizes[end]
            linear[SIDES + end, own] = np.cross(axis, towards) / sizes[end]
    plane = Plane.between(poses, A, B)
    if plane is not None:
        linear[4] = np.concatenate([-plane.a, [plane.apart], plane.b]) / min(sizes)
        for row, (region, own), normal, size in zip((5, 6), ends, (plane.a, plane.b), sizes, strict=True):
            linear[row, own], linear[row, 3] = normal / size, -_offset(region, normal) / size
    return _Place(linear @ block.lift, stretch @ block.lift, energy, plane)


def _offset(region: Region, normal: Array) -> float:
    """[m] how far off a body's origin, along a normal, the region's points nearest to it are."""
    middle = float(normal @ region.at)
    reach = region.half[0] if region.shape == "ball" else float(np.abs(normal) @ region.half)
    return float(np.clip(0.0, middle - reach, middle + reach))
