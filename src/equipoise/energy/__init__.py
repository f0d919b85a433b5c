"""Potential energy: the slow sum (`reference`), what chooses a quicker way (`evaluate`), its Fourier form (`fourier`)."""

from ..errors import NoFourierForm
from .evaluate import Potential
from .fourier import FourierEnergy

__all__ = ["FourierEnergy", "NoFourierForm", "Potential"]
