"""Springs that can be wound to order, as a list to choose from: sizes in steps, with initial tension and without."""

from __future__ import annotations

import numpy as np

from ...model.arrays import Array
from ..sizing.extension import LOOP, ExtensionSpring
from ..sizing.limits import Limits
from ..sizing.wire import MM, WIRES
from ..stock.part import Catalogue, Stock

DIAMETERS = (0.5, 0.7, 1.0, 1.25, 1.6, 2.0, 2.5, 2.8, 3.2, 3.6, 4.0, 4.5, 5.0, 6.3)  # [mm]
INDICES = (5.0, 6.0, 7.0, 8.0, 10.0, 12.0)
COILS = np.unique(np.round(np.geomspace(8, 120, 16)))
GRADE = "DH"


def wound(limits: Limits, longest: float = np.inf) -> Catalogue:
    """Extension springs of DH wire; `part` is what a workshop needs to know.

    Args:
        longest: unloaded [m].
    """
    wire = WIRES[GRADE]
    d, w, n = (x.ravel() for x in np.meshgrid(DIAMETERS, INDICES, COILS, indexing="ij"))
    D: Array = np.round(w * d, 1).astype(np.float64) * MM
    d = d * MM
    found = []
    for share in (0.0, 1.0):
        bare = ExtensionSpring(wire, d, D, n)
        stress = share * limits.initial_stress(bare.index, bare.strength)
        s = ExtensionSpring(wire, d, D, n, stress, LOOP * bare.inner)
        force = np.minimum(s.static_margin(1.0, limits), s.hook_margin(1.0, limits))
        good = (s.free_length <= longest) & (force / limits.safety > s.initial_tension)
        rows = np.stack([s.rate, force, s.free_length, s.outer, s.d, s.mass, s.initial_tension], axis=1)
        for i in np.flatnonzero(good):
            name = f"{GRADE} {d[i] / MM:.3g} x {D[i] / MM:.3g} mm, {n[i]:.0f} coils, F0 {s.initial_tension[i]:.3g} N"
            found.append(Stock(name, "extension", *(float(x) for x in rows[i]), wire=GRADE))
    return tuple(found)
