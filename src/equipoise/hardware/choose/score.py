"""Every part at many places at once: what each would leave, in closed form."""

from __future__ import annotations

import numpy as np

from ...model.arrays import Array, Integers, frozen
from .field import Field
from .mount import Mount
from .slots import MARGIN
from .table import Table

ENTRIES = 1_000_000  # places times parts at a time


@frozen
class Scores:
    """Of P parts, each at the best of the places looked at: the mean square left (inf where it fits nowhere), and x."""

    left: Array
    x: Array


def score(field: Field, mount: Mount, table: Table, load: Array, u: Array) -> Scores:
    """What every part leaves of a load (N * n,) at its best place of `u` (G, 6)."""
    P = len(table)
    left, x = np.full(P, np.inf), np.zeros((P, 7))
    if not P:
        return Scores(left, x)
    step = max(1, ENTRIES // max(P, 3 * len(load)))
    for i in range(0, len(u), step):
        part = u[i : i + step]
        p_a, p_b = mount.points(part)
        K, C, s = field.lines(mount.a, p_a, mount.b, p_b)
        sums = [np.einsum("gm,gm->g", a, b)[:, None] for a, b in ((K, K), (K, C), (C, C))]
        sums += [(K @ load)[:, None], (C @ load)[:, None]]
        short, long = s.min(axis=1)[:, None], s.max(axis=1)[:, None]
        if mount.cabled:
            room = mount.behind(field, p_a, p_b)[1][:, None]
            found, lead = _cabled(table, sums, short, long, room - 4 * mount.radius)
        else:
            found, lead = _direct(table, sums, short, long), None
        best = found.argmin(axis=0)
        value = found[best, np.arange(P)] + float(load @ load)
        better = value < left
        left = np.where(better, value, left)
        x[better, :6] = part[best[better]]
        if lead is not None:
            x[better, 6] = lead[best[better], np.flatnonzero(better)]
    return Scores(left, x)


def _square(k: Array, c: Array, sums: list[Array]) -> Array:
    """(G, P) mean square less that of the load alone."""
    KK, KC, CC, Kg, Cg = sums
    return k * (k * KK - 2 * c * KC + 2 * Kg) + c * (c * CC - 2 * Cg)


def _direct(t: Table, sums: list[Array], short: Array, long: Array) -> Array:
    keep = 2 * MARGIN * (t.high - t.low)
    a, b = np.abs(t.k * short - t.c), np.abs(t.k * long - t.c)
    lasts = t.top * np.maximum(a, b) - t.bottom * np.minimum(a, b) <= 1 - 2 * MARGIN
    good = (short >= t.low + keep) & (long <= t.high - keep) & lasts
    return np.where(good, _square(t.k, t.c, sums), np.inf)


def _cabled(t: Table, sums: list[Array], short: Array, long: Array, room: Array) -> tuple[Array, Array]:
    """With the best length of cable: its `lead` is between what opens it everywhere and what stretches it too far."""
    _, KC, CC, _, Cg = sums
    keep = 2 * MARGIN * (t.high - t.low)
    most = short - keep
    least = long - (np.minimum(t.high - keep, room) - t.body)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = t.k * (t.top - t.bottom)
        worn = (t.top * (t.tension + t.k * long) - t.bottom * (t.tension + t.k * short) - 1 + 2 * MARGIN) / slope
    least = np.where(slope > 0, np.maximum(least, worn), least)
    best = (Cg + t.k * KC) / np.maximum(CC, 1e-300)
    lead = np.clip((best + t.tension) / t.k, least, np.maximum(most, least))
    good = (least <= most) & t.pulls
    return np.where(good, _square(t.k, t.k * lead - t.tension, sums), np.inf), lead


def leading(scores: Scores, count: int) -> Integers:
    """The parts that leave least, the best first; those that fit nowhere are not among them."""
    order = np.argsort(scores.left, kind="stable")[:count]
    return order[np.isfinite(scores.left[order])]
