"""Torques, shares and poses as text."""

from __future__ import annotations

from collections.abc import Sequence

from ..energy.exactness import EXACT
from ..model.arrays import Array
from ..model.coordinate import Coordinate


def torque(value: float, floor: float = 0.0) -> str:
    """A torque or force; less than `floor` counts as nothing."""
    if value == 0:
        return "0"
    if value < floor:
        return f"< {floor:.0e}"
    return f"{value:.4f}" if value >= 1e-3 else f"{value:.1e}"


def rounded(value: float, floor: float = 0.0) -> str:
    """A torque or force in four digits, as in a sentence."""
    return f"{value:.4g}" if value >= max(floor, 1e-3) else torque(value, floor)


def percent(share: float) -> str:
    """A share; less than the certificate's tolerance counts as nothing."""
    return "0 %" if share == 0 else f"< {100 * EXACT:.0e} %" if share < EXACT else f"{100 * share:.3g} %"


def energies(pair: tuple[float, float]) -> str:
    """From the smallest to the largest."""
    return f"{pair[0]:.6g} to {pair[1]:.6g} J"


def pose(coordinates: Sequence[Coordinate], values: Array) -> str:
    """Every coordinate with its value, on one line."""
    return ", ".join(coordinate.show(value) for coordinate, value in zip(coordinates, values.tolist(), strict=True))
