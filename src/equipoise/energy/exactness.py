"""What counts as exactly balanced: one definition for every proof, and no unit in it.

The distance from exact is how much the energy varies, over how much there is to be balanced. Both are root mean squares
over all configurations, whatever the ranges of the joints: of an angle over whole turns; what slides (or an angle that
a spring on a joint acts on) counts with the size of its range, one power of it at a time. To be balanced is what each
mass alone makes the energy vary by; where gravity does no work, each spring alone. The root of their summed squares is
taken before anything cancels.

Masses, stiffnesses and lengths times any number leave the distance as it is. Rounding leaves about 1e-15 of what
cancels: up to `EXACT` the energy counts as constant. What is moved or made to vary by less than `ROUNDING` of its own
size is at rest: a heavy turret whose axis is vertical gives nothing to balance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

EXACT = 1e-10
ROUNDING = 1e-13


@dataclass(frozen=True)
class Distance:
    """From exact: `varies` and `scale` are the root mean squares of what is left and of what there is to balance [J].

    `scale` is 0 where nothing is to be balanced.
    """

    varies: float
    scale: float

    @property
    def exact(self) -> bool:
        """Whether the energy is constant, to rounding."""
        return bool(np.isfinite(self.varies + self.scale) and self.relative <= EXACT)

    @property
    def relative(self) -> float:
        """What is left, as a share."""
        return self.varies / self.scale if self.scale else 0.0


def size(values: ArrayLike) -> float:
    """The root of the summed squares, however large or small they are."""
    values = np.abs(np.asarray(values)).ravel()
    largest = float(values.max(initial=0.0))
    return largest * float(np.linalg.norm(values / largest)) if 0 < largest < np.inf else largest
