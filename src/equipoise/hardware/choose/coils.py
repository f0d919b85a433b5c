"""Torsion springs of a list on joints: which part on which joint, and where it is at rest, in closed form.

The torque of a coil is k (angle - rest): what is left is a square in the rest, which must be so far off that the coil
is only ever wound up, and not so far that it is wound too much.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...model.arrays import Array, frozen
from ...model.elements import TorsionSpring
from ..sizing.limits import Limits
from ..stock.part import Stock
from .field import Field
from .polish import torque_size

BETTER = 0.99  # of what was left: less is worth no further coil


@frozen
class Coil:
    """A part, `count` side by side, on a joint; `torque` (N * n,) is what all of them do."""

    part: Stock
    count: int
    joint: str
    rest: float
    torque: Array

    def elements(self, name: str) -> list[TorsionSpring]:
        """As a mechanism file has them, one for each."""
        names = [name] if self.count == 1 else [f"{name}{'abcdefgh'[i]}" for i in range(self.count)]
        k = self.part.torsional_rate
        return [TorsionSpring(one, ((self.joint, 1.0),), k, self.rest, self.part.part) for one in names]


def coils(
    field: Field, parts: Sequence[Stock], limits: Limits, parallel: int, most: int | None, peak: bool
) -> list[Coil]:
    """The coils that leave least, one after the other, each where it helps most.

    Args:
        most: how many joints at most get one.
        peak: whether the largest torque counts, or the root mean square.
    """
    parts = [part for part in parts if part.kind == "torsion"]
    revolute = [joint.name for joint in field.mechanism.joints if joint.type == "revolute"]
    load, found = field.load, []
    while parts and len(found) < (len(revolute) if most is None else most):
        taken = {coil.joint for coil in found}
        every = [c for name in revolute if name not in taken for c in _on(field, name, parts, limits, parallel, load)]
        best = min(every, key=lambda coil: _size(load + coil.torque, peak), default=None)
        if best is None or _size(load + best.torque, peak) > BETTER * _size(load, peak):
            break
        found.append(best)
        load = load + best.torque
    return found


def _size(torque: Array, peak: bool) -> float:
    return torque_size(torque, 1, peak)


def _on(field: Field, joint: str, parts: Sequence[Stock], limits: Limits, parallel: int, load: Array) -> list[Coil]:
    """The best rest of every part on a joint, wound either way."""
    arms, angle = field.element(TorsionSpring("coil", ((joint, 1.0),), 1.0))
    wide = np.repeat(angle, len(arms) // len(angle))
    k = np.array([part.torsional_rate for part in parts])[:, None] * np.arange(1, parallel + 1)
    reach = np.array([part.max_torque / part.torsional_rate for part in parts])[:, None] / limits.safety
    K, size = arms * wide, float(arms @ arms)
    if not size:
        return []
    best = (float(arms @ load) / k + float(arms @ K)) / size
    low, high = float(angle.min()), float(angle.max())
    found = []
    for least, most in ((high - reach, np.full_like(reach, low)), (np.full_like(reach, high), low + reach)):
        good = np.broadcast_to(least <= most, k.shape)
        rest = np.clip(best, least, np.maximum(least, most))
        torque = k[..., None] * (K - rest[..., None] * arms)
        left = np.where(good, ((load + torque) ** 2).sum(axis=2), np.inf)
        for i, j in zip(*np.nonzero(np.isfinite(left)), strict=True):
            found.append(Coil(parts[i], int(j) + 1, joint, float(rest[i, j]), torque[i, j]))
    return found
