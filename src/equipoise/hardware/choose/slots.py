"""A spring of a choice: its mount, its part and its numbers, and what it does over the poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...model.arrays import Array, frozen
from ..stock.part import Stock
from .field import Field
from .mount import Mount
from .table import Table

MARGIN = 1e-3
"""Of the lengths that a part may have, what a choice keeps from their ends: poses between those looked at need it."""


@frozen
class Slot:
    """A chosen spring.

    Attributes:
        mount: where it may be and how it is realised.
        row: which of the table's parts it is.
        x: (7,) the regions' own coordinates of its ends, and of a cabled one the `lead` [m] of `Mount.element`.
    """

    mount: Mount
    row: int
    x: Array


@frozen
class Doing:
    """What G variants of a spring do: (G, N * n) torque, (G, N) its length [m], (G, c) how far limits are passed."""

    torque: Array
    length: Array
    passed: Array


class Judge:
    """What slots do, and whether they may."""

    def __init__(self, field: Field, table: Table, catalogue: tuple[Stock, ...], longest: float, margin: float) -> None:
        self.field, self.table, self.catalogue, self.longest, self.margin = field, table, catalogue, longest, margin

    def doing(self, mount: Mount, row: int, x: Array, more: float = 0.0) -> Doing:
        """Of variants (G, 7) of a spring, which are to keep `more` than the margin."""
        t, field = self.table, self.field
        k = float(t.k[row])
        p_a, p_b = mount.points(x)
        outside = [_outside(x[:, :3], mount.region_a.shape), _outside(x[:, 3:6], mount.region_b.shape)]
        passed = [np.stack(outside, axis=1)]
        own = float(t.mass[row])
        if mount.realise == "pulley":
            parts = [self._over_pulley(mount, row, one) for one in x]
            torque, length = (np.stack(values) for values in zip(*parts, strict=True))
        else:
            K, C, s = field.lines(mount.a, p_a, mount.b, p_b)
            # a cable of another length moves the length at which the spring opens
            length = s + (float(t.body[row]) - x[:, 6:7] if mount.cabled else 0.0)
            c = k * x[:, 6] - float(t.tension[row]) if mount.cabled else np.full(len(x), float(t.c[row]))
            torque = k * K - c[:, None] * C
        passed.append(self.limits(row, length, self.margin + more))
        if mount.cabled:
            e, room = mount.behind(field, p_a, p_b)
            within = length.max(axis=1) + 4 * mount.radius
            passed.append((within - room)[:, None] / self.longest)
            torque = torque + own * field.weight(mount.a, p_a + within[:, None] * e)
        else:
            torque = torque + own / 2 * (field.weight(mount.a, p_a) + field.weight(mount.b, p_b))
        return Doing(torque, length, np.hstack(passed))

    def _over_pulley(self, mount: Mount, row: int, x: Array) -> tuple[Array, Array]:
        t = self.table
        element = mount.element(self.field, x[:6], float(x[6]), self.catalogue[int(t.part[row])], "spring")
        arms, path = self.field.element(element)
        assert element.law.free is not None
        stretch = path - element.law.free
        pull = float(t.tension[row]) + float(t.k[row]) * stretch
        per = len(arms) // len(path)
        return arms * np.repeat(pull, per), stretch + float(t.body[row])

    def limits(self, row: int, length: Array, margin: float) -> Array:
        """(G, 3) shares by which it is too short, too long, or will break in the end; below 0 within its limits.

        Args:
            length: (G, N) [m] over the poses, without its cable. margin: what it is to keep from its limits.
        """
        t = self.table
        low, high = float(t.low[row]), float(t.high[row])
        keep = margin * (high - low)
        short, long = length.min(axis=1), length.max(axis=1)
        ends = np.abs(float(t.k[row]) * np.stack([short, long]) - float(t.c[row]))
        worn = float(t.top[row]) * ends.max(axis=0) - float(t.bottom[row]) * ends.min(axis=0) - 1 + margin
        width = high - low
        return np.stack([(low + keep - short) / width, (long - high + keep) / width, worn], axis=1)

    def may(self, slot: Slot) -> bool:
        """Whether a spring keeps all its limits over the poses."""
        return bool((self.doing(slot.mount, slot.row, slot.x[None]).passed <= 1e-6).all())

    def torque(self, slot: Slot) -> Array:
        """(N * n,) of one spring."""
        return self.doing(slot.mount, slot.row, slot.x[None]).torque[0]

    def inside(self, slot: Slot) -> Slot:
        """With its ends inside their regions."""
        x = slot.x.copy()
        p_a, p_b = slot.mount.points(x[None])
        x[:6] = slot.mount.own(p_a[0], p_b[0])
        return replace(slot, x=x)


def _outside(u: Array, shape: str) -> Array:
    size = np.abs(u).max(axis=1) if shape == "box" else np.linalg.norm(u, axis=1)
    return 0.1 * np.maximum(size - 1.0 - 1e-9, 0.0)
