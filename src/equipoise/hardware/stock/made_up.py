"""A list of springs that no vendor sells, for demonstrations and tests: sized by the formulas, named as made up."""

from __future__ import annotations

import numpy as np

from ...model.arrays import Array, Booleans
from ...model.errors import Fault, InputError, nearest
from ...model.validate import whole_number
from ..sizing.compression import CompressionSpring, least_free_length
from ..sizing.extension import LOOP, ExtensionSpring
from ..sizing.limits import Limits
from ..sizing.wire import MM, WIRES
from .part import Catalogue, Stock

DIAMETERS = (0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3)  # [mm]
INDICES = (6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0)
COILS = tuple(float(n) for n in range(10, 180, 2))
LONGEST = 0.6  # [m] unloaded
MADE_OF = ("extension", "extension", "compression")  # without initial tension, with it
MADE = ("extension", "compression")
TENSION = 0.5  # of the initial stress that may be wound in
PRICE_EACH, PRICE_PER_KG = 1.5, 40.0  # of an invented currency


def made_up_catalogue(count: int = 2000, seed: int = 0, kind: str | None = None) -> Catalogue:
    """`count` springs of DH wire; the same for the same seed.

    A third each are extension springs without and with initial tension, and compression springs; or all are of a kind.

    Raises:
        InputError: more than there can be.
    """
    whole_number("count", count, 1)
    if kind not in (None, *MADE):
        raise InputError(Fault(("kind",), f"unknown kind {nearest(str(kind), MADE)}", MADE))
    kinds = [rows for name, rows in zip(MADE_OF, _all(), strict=True) if kind in (None, name)]
    most = len(kinds) * min(len(rows) for rows in kinds)
    if count > most:
        raise InputError(Fault(("count",), f"at most {most:,} can be made up, found {count:,}"))
    rng = np.random.default_rng(seed)
    chosen = []
    for number, rows in enumerate(kinds):
        share = (count + number) // len(kinds)  # the shares of all are the count
        chosen += [rows[i] for i in sorted(rng.choice(len(rows), share, replace=False))]
    return tuple(Stock(**{**vars(one), "part": f"MADE-UP-{number:05d}"}) for number, one in enumerate(chosen, start=1))


def _all() -> tuple[list[Stock], ...]:
    return _extension(0.0), _extension(TENSION), _compression()


def _extension(share: float) -> list[Stock]:
    limits = Limits()
    bare = ExtensionSpring(WIRES["DH"], *_sizes())
    stress = share * limits.initial_stress(bare.index, bare.strength)
    s = ExtensionSpring(bare.wire, bare.d, bare.D, bare.n, stress, LOOP * bare.inner)
    force = np.minimum(s.static_margin(1.0, limits), s.hook_margin(1.0, limits))
    good = (s.free_length <= LONGEST) & (force > s.initial_tension)
    return _rows("extension", s, force, s.initial_tension, good)


def _compression() -> list[Stock]:
    limits = Limits()
    bare = CompressionSpring(WIRES["DH"], *_sizes())
    stroke = limits.compression * bare.strength / bare.stress(bare.rate)
    s = CompressionSpring(bare.wire, bare.d, bare.D, bare.n, least_free_length(bare, stroke))
    good = (s.free_length <= LONGEST) & (s.free_length <= limits.slenderness * s.D)
    return _rows("compression", s, s.stroke * s.rate, np.zeros_like(s.d), good)


def _sizes() -> tuple[Array, Array, Array]:
    d, w, n = (x.ravel() for x in np.meshgrid(DIAMETERS, INDICES, COILS, indexing="ij"))
    D: Array = np.round(w * d, 1).astype(np.float64)
    return d * MM, D * MM, n


def _rows(
    kind: str, s: ExtensionSpring | CompressionSpring, force: Array, tension: Array, good: Booleans
) -> list[Stock]:
    price = np.round(PRICE_EACH + PRICE_PER_KG * s.mass, 2)
    columns = (s.rate, force, s.free_length, s.outer, s.d, s.mass, tension, price)
    return [Stock("", kind, *(float(x) for x in row), wire="DH") for row in np.stack(columns, axis=1)[good]]
