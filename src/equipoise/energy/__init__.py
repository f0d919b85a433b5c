"""Potential energy: the obvious reference (`potential`) and its exact Fourier form (`fourier`)."""

from ..errors import NoFourierForm
from .fourier import FourierEnergy
from .potential import Potential

__all__ = ["FourierEnergy", "NoFourierForm", "Potential"]
