"""The array types of every signature, and frozen dataclasses that hold arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, TypeVar, dataclass_transform

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Integers = NDArray[np.integer]
Booleans = NDArray[np.bool_]
Class = TypeVar("Class", bound=type)


@dataclass_transform(frozen_default=True)
def frozen(cls: Class) -> Class:
    """A frozen dataclass that may hold arrays: equal to another when all fields are, arrays element by element.

    What `dataclass` makes would raise there. It has no hash, because arrays have none.
    """
    made = dataclass(frozen=True, eq=False)(cls)
    made.__eq__, made.__hash__ = _equal, None
    return made


def _equal(self: Any, other: Any) -> bool:
    if type(other) is not type(self):
        return NotImplemented
    return all(_same(getattr(self, f.name), getattr(other, f.name)) for f in fields(self) if f.compare)


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        numbers = a.dtype.kind in "fc" and b.dtype.kind in "fc"
        return np.array_equal(a, b, equal_nan=numbers)  # what is not known is the same
    if isinstance(a, (tuple, list)) and type(a) is type(b):
        return len(a) == len(b) and all(map(_same, a, b))
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(_same(value, b[key]) for key, value in a.items())
    return a is b or bool(np.all(a == b))


def vec3(v: Array) -> tuple[float, float, float]:
    """Three numbers as the frozen values of a mechanism hold them."""
    x, y, z = (float(c) for c in v)
    return x, y, z
