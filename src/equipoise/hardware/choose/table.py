"""Parts as numbers: every one pulls with k s - c over a range of lengths, whatever its kind.

* extension, hooked: c = k L_0 - F_0, from L_0 to where the largest force is
* extension behind an eyelet or a pulley: c is free, because the cable may be as long as one likes
* compression: c = k L_0, from where the largest force is (or it is solid) to L_0
* gas: k is how much it stiffens, c = k L + F_1 with its extended length L, between the ends of its stroke
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...model.arrays import Array, Booleans, Integers, frozen
from ..sizing.limits import Limits
from ..stock.part import Stock, endurance

LINES = ("extension", "compression", "gas")


@frozen
class Table:
    """P parts, each alone or several side by side, as one spring each.

    Attributes:
        part: (P,) which of the list. count: (P,) how many side by side.
        k, c: (P,) the pull k s - c [N/m, N].
        low, high: (P,) lengths between which it may be used [m].
        top, bottom: (P,) [1/N] it lasts while top * largest - bottom * least force is at most 1.
        tension: (P,) [N] at which it opens. body: (P,) its own length without load [m].
        mass, price: (P,) of all side by side.
        pulls: (P,) whether it can be behind an eyelet.
    """

    part: Integers
    count: Integers
    k: Array
    c: Array
    low: Array
    high: Array
    top: Array
    bottom: Array
    tension: Array
    body: Array
    mass: Array
    price: Array
    pulls: Booleans

    def __len__(self) -> int:
        return len(self.part)

    def rows(self, which: Booleans) -> Table:
        """Some of them."""
        return Table(**{name: values[which] for name, values in vars(self).items()})

    @staticmethod
    def of(
        catalogue: Sequence[Stock],
        limits: Limits,
        parallel: int = 1,
        longest: float = np.inf,
        strongest: float = np.inf,
        without: Sequence[str] = (),
    ) -> Table:
        """The parts of a list that can be used at all.

        Args:
            parallel: at most this many side by side.
            longest, strongest: of one spring in use [m], and of all side by side [N].
            without: names of parts that are left out.
        """
        kept = [i for i, one in enumerate(catalogue) if one.kind in LINES and one.part not in without]
        rows = [_row(catalogue[i], limits, longest) for i in kept]
        one = np.array(rows).reshape(len(rows), -1).T if rows else np.empty((10, 0))
        numbers = np.arange(1, parallel + 1)
        part, count = (x.ravel() for x in np.meshgrid(np.array(kept, int), numbers, indexing="ij"))
        k, c, low, high, top, bottom, tension, body, mass, price = np.repeat(one, parallel, axis=1)
        n = count.astype(float)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.where(k > 0, (strongest + n * c) / (n * k), np.inf)
        table = Table(
            part, count, n * k, n * c, low, np.minimum(high, reach), top / n, bottom / n, n * tension, body, n * mass,
            n * price, np.array([catalogue[i].kind == "extension" for i in part.tolist()], bool),
        )  # fmt: skip
        return table.rows(table.high > table.low)


def _row(part: Stock, limits: Limits, longest: float) -> tuple[float, ...]:
    k, tension, most = part.rate, part.initial_tension, part.max_force / limits.safety
    if part.kind == "gas":  # what its maker states is what it bears
        c, low, high, tension = (
            k * part.free_length + part.max_force - k * part.stroke,
            part.min_length,
            part.free_length,
            0.0,
        )
    elif part.kind == "compression":
        c, low, high = k * part.free_length, max(part.min_length, part.free_length - most / k), part.free_length
    else:
        c = k * part.free_length - tension
        low, high = part.free_length, min(part.free_length + (most - tension) / k, part.max_length)
    top, bottom = (0.0, 0.0) if part.kind == "gas" else endurance(part, limits)
    return k, c, low, min(high, longest), top, bottom, tension, part.free_length, part.mass, part.price
