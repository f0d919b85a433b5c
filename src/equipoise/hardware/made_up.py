"""A list of springs that no vendor sells, for demonstrations and tests: sized by the formulas, named as made up."""

from __future__ import annotations

import numpy as np

from ..errors import Fault, InputError
from ..validate import whole_number
from .compression import CompressionSpring
from .extension import LOOP, ExtensionSpring
from .limits import Limits
from .stock import Catalogue, Stock
from .wire import MM, WIRES

DIAMETERS = (0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3)  # [mm]
INDICES = (6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0)
COILS = tuple(range(10, 180, 2))
LONGEST = 0.6  # [m] unloaded
TENSION = 0.5  # of the initial stress that may be wound in
PRICE_EACH, PRICE_PER_KG = 1.5, 40.0  # of an invented currency


def made_up_catalogue(count: int = 2000, seed: int = 0) -> Catalogue:
    """`count` springs of DH wire; the same for the same seed.

    A third each are extension springs without and with initial tension, and compression springs.

    Raises:
        InputError: more than there can be.
    """
    whole_number("count", count, 1)
    kinds = (_extension(0.0), _extension(TENSION), _compression())
    most = 3 * min(len(kind) for kind in kinds)
    if count > most:
        raise InputError(Fault(("count",), f"at most {most:,} can be made up, found {count:,}"))
    rng = np.random.default_rng(seed)
    chosen = []
    for number, kind in enumerate(kinds):
        share = (count + number) // 3  # the shares of all three are the count
        chosen += [kind[i] for i in sorted(rng.choice(len(kind), share, replace=False))]
    return tuple(Stock(**{**vars(one), "part": f"MADE-UP-{number:05d}"}) for number, one in enumerate(chosen, start=1))


def _extension(share: float) -> list[Stock]:
    limits, found = Limits(), []
    for d, D, n in _sizes():
        bare = ExtensionSpring(WIRES["DH"], d, D, n)
        stress = share * float(limits.initial_stress(bare.index, bare.strength))
        s = ExtensionSpring(WIRES["DH"], d, D, n, stress, LOOP * bare.inner)
        unit = min(float(s.static_margin(1.0, limits)), float(s.hook_margin(1.0, limits)))
        found.append(_row("extension", s, float(s.free_length), unit, float(s.initial_tension)))
    return [one for one in found if one.free_length <= LONGEST and one.max_force > one.initial_tension]


def _compression() -> list[Stock]:
    limits, found = Limits(), []
    for d, D, n in _sizes():
        bare = CompressionSpring(WIRES["DH"], d, D, n)
        force = float(limits.compression * bare.strength / bare.stress(1.0))
        length = float(np.ceil((force / bare.rate + bare.solid_length + bare.gaps) / MM)) * MM
        s = CompressionSpring(WIRES["DH"], d, D, n, length)
        found.append(_row("compression", s, length, float(s.stroke * s.rate), 0.0))
    return [one for one in found if one.free_length <= LONGEST]


def _sizes() -> list[tuple[float, float, float]]:
    return [(d * MM, round(w * d, 1) * MM, float(n)) for d in DIAMETERS for w in INDICES for n in COILS]


def _row(kind: str, s: ExtensionSpring | CompressionSpring, length: float, force: float, tension: float) -> Stock:
    price = round(PRICE_EACH + PRICE_PER_KG * s.mass, 2)
    return Stock("", kind, s.rate, force, length, s.outer, s.d, s.mass, tension, price)
