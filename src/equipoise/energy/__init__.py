"""Potential energy: the obvious reference (`potential`) and its exact Fourier form (`fourier`)."""

from .fourier import FourierEnergy
from .frames import NoFourierForm
from .potential import Potential

__all__ = ["FourierEnergy", "NoFourierForm", "Potential"]
