"""Inertias that MuJoCo accepts."""

from __future__ import annotations

import warnings
from xml.etree import ElementTree as ET

import numpy as np

from ..model.errors import EquipoiseWarning
from ..model.mechanism import Body
from ..model.rotation import to_quaternion
from .lint import impossible, principal
from .text import numbers

RADIUS = 0.05
"""Of the uniform sphere that stands for a body whose inertia is not known [m]."""


class Inertials:
    """Writes them, and remembers which ones it had to make up."""

    def __init__(self) -> None:
        self.unknown: list[str] = []
        self.impossible: list[str] = []

    def write(self, element: ET.Element, body: Body) -> None:
        if not body.mass and not any(body.inertia or ()):
            return
        moments, axes = principal(body)
        if body.inertia is None:
            self.unknown.append(body.name)
            moments, axes = np.full(3, 0.4 * body.mass * RADIUS**2), np.eye(3)
        elif impossible(body):
            self.impossible.append(body.name)
            moments, axes = np.full(3, max(float(moments.mean()), 0.0)), np.eye(3)
        low, middle, high = np.maximum(moments, 0.0).tolist()
        # MuJoCo allows no rounding in the triangle inequality; `impossible` has let pass no more than that
        high = min(high, low + middle)
        ET.SubElement(
            element, "inertial", pos=numbers(body.com), quat=numbers(to_quaternion(axes)), mass=numbers([body.mass]),
            diaginertia=numbers([low, middle, high]),
        )  # fmt: skip

    def warn(self) -> None:
        for names, what in (
            (self.unknown, f"unknown inertia, a uniform sphere of radius {RADIUS} m was written"),
            (self.impossible, "impossible inertia, equal moments with the same sum were written"),
        ):
            if names:
                quoted = ", ".join(f"'{name}'" for name in names)
                warnings.warn(f"bodies {quoted}: {what}; motion depends on it, balance does not", EquipoiseWarning,
                              stacklevel=4)  # fmt: skip
