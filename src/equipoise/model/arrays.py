"""The array types of every signature."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Integers = NDArray[np.integer]
Booleans = NDArray[np.bool_]


def vec3(v: Array) -> tuple[float, float, float]:
    """Three numbers as the frozen values of a mechanism hold them."""
    x, y, z = (float(c) for c in v)
    return x, y, z
