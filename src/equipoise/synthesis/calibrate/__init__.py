"""Calibration: the best rates, preloads and masses of a mechanism whose ends are fixed by its hardware."""

from .calibrate import Calibration, calibrate

__all__ = ["Calibration", "calibrate"]
