"""Potential energy: the slow sum (`reference`), the way chosen (`evaluate`), its exact Fourier form (`fourier`)."""

from ..errors import NoFourierForm
from .evaluate import Potential
from .fourier import FourierEnergy

__all__ = ["FourierEnergy", "NoFourierForm", "Potential"]
