"""What a spring may bear and how it may be proportioned: every number with its source, and all of them replaceable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ...model.errors import Fault, InputError, nearest
from .wire import Quantity

LOW, FOR_EVER = 1e3, 1e6  # cycles between which the strength falls
BENDING = 0.577  # stress in torsion over the one in bending that wears as much (distortion energy; Shigley, 10-12)


@dataclass(frozen=True)
class Limits:
    """Permissible stresses and proportions.

    Attributes:
        extension: static torsional stress of an extension spring, share of Rm.
        compression: the same of a compression spring at its largest working force.
        solid: the same when it is pressed solid.
        bending: static bending stress of a torsion spring, share of Rm.
        hook_bending, hook_torsion: stresses in the loop of an extension spring, share of Rm.
        shear_strength: ultimate strength in torsion, share of Rm, where Goodman's line ends.
        amplitude, mean: [Pa] a pair that unpeened springs endure for ever, where Goodman's line begins.
        low_cycle: alternating strength at 10^3 cycles, share of the ultimate strength in torsion.
        cycles: that a spring must live through, from its least to its largest force and back.
        initial, initial_slope: greatest initial stress of an extension spring, (initial - initial_slope w) Rm.
        index: least and greatest spring index w = D/d.
        coils_extension, coils_compression: least number of active coils.
        free_length: [m] greatest of a compression spring.
        slenderness: greatest free length of a compression spring over its coil diameter, guided in a case.
        safety: static margin that is asked for.
        fatigue: Goodman margin that is asked for; 0 asks for none.
    """

    extension: float = 0.45
    compression: float = 0.50
    solid: float = 0.56
    bending: float = 0.70
    hook_bending: float = 0.75
    hook_torsion: float = 0.40
    shear_strength: float = 0.67
    amplitude: float = 241e6
    mean: float = 379e6
    low_cycle: float = 0.9
    cycles: float = 1e5
    initial: float = 0.135
    initial_slope: float = 0.00625
    index: tuple[float, float] = (4.0, 20.0)
    coils_extension: float = 3.0
    coils_compression: float = 2.0
    free_length: float = 0.630
    slenderness: float = 20.0
    safety: float = 1.2
    fatigue: float = 1.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            least = 0.0 if field.name in ("fatigue", "initial", "initial_slope") else 1e-12
            for one in value if isinstance(value, tuple) else (value,):
                if not least <= one < float("inf"):
                    raise InputError(Fault(("limits", field.name), f"must be more than 0 and finite, found {one:g}"))

    def endured(self, ultimate: Quantity, distortion: float = 1.0) -> Quantity:
        """Stress amplitude [Pa] about no mean that is endured for `cycles`, at an ultimate strength [Pa].

        From 10^6 on that of springs that last for ever; down to 10^3 straight in both logarithms.

        Args:
            distortion: of the stress in torsion that wears as much as the one in question: `BENDING` for bending.
        """
        for_ever = self.amplitude / distortion / (1 - self.mean / distortion / ultimate)
        share = np.clip(np.log10(FOR_EVER / self.cycles) / np.log10(FOR_EVER / LOW), 0.0, 1.0)
        return for_ever * (self.low_cycle * ultimate / for_ever) ** share

    @staticmethod
    def changed(values: Mapping[str, str]) -> Limits:
        """The defaults with some numbers replaced, as typed; ``index`` is LOW:HIGH.

        Raises:
            InputError: an unknown name, or not a number.
        """
        names = tuple(field.name for field in fields(Limits))
        found: dict[str, Any] = {}
        for name, text in values.items():
            if name not in names:
                raise InputError(Fault(("limits",), f"unknown limit {nearest(name, names)}", names))
            numbers: list[float] = []
            try:
                numbers += map(float, text.split(":"))
            except ValueError:
                numbers.clear()
            if len(numbers) != (2 if name == "index" else 1):
                raise InputError(Fault(("limits", name), f"expected a number (index: LOW:HIGH), found '{text}'"))
            found[name] = (numbers[0], numbers[1]) if name == "index" else numbers[0]
        return Limits(**found)

    def initial_stress(self, w: Quantity, rm: Quantity) -> Quantity:
        """Greatest initial torsional stress [Pa] of an extension spring of index `w`."""
        return np.maximum(self.initial - self.initial_slope * w, 0.0) * rm


SOURCES = {
    "extension": "EN 13906-2:2013, 10.2: cold coiled, static",
    "compression": "EN 13906-1:2013: cold coiled, static, usual share below the solid length's",
    "solid": "EN 13906-1:2013, 10: cold coiled, at solid length",
    "bending": "EN 13906-3:2014: cold coiled, static",
    "hook_bending": "Shigley's Mechanical Engineering Design, table 10-7: 75 % of Rm for carbon steel, not set",
    "hook_torsion": "Shigley's Mechanical Engineering Design, table 10-7: 40 % of Rm for carbon steel, at the end",
    "shear_strength": "Shigley's Mechanical Engineering Design, eq. 10-30: Ssu = 0.67 Sut",
    "amplitude": "Zimmerli's data, unpeened, in Shigley's Mechanical Engineering Design, eq. 10-28",
    "mean": "Zimmerli's data, unpeened, in Shigley's Mechanical Engineering Design, eq. 10-28",
    "low_cycle": "Norton, Machine Design, 12.4: 0.9 of the ultimate strength in torsion at 10^3 cycles",
    "cycles": "the user's choice",
    "initial": "EN 13906-2:2013, 10.4: the higher of its two guide lines; its lower one is 0.075 - 0.00375 w",
    "initial_slope": "as initial",
    "index": "EN 13906-1 and -2, table 1",
    "coils_extension": "EN 13906-2, table 1",
    "coils_compression": "EN 13906-1, table 1",
    "free_length": "EN 13906-1, table 1",
    "slenderness": "assumed: what can be wound straight and guided; EN 13906-1 has no limit for guided springs",
    "safety": "the user's choice",
    "fatigue": "the user's choice",
}
"""Where each default comes from."""
