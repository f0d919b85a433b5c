"""Potential energy: the slow sum (`reference`), the way chosen (`evaluate`), its exact Fourier form (`fourier`)."""

from ..model.errors import NoFourierForm
from .evaluate import Potential
from .fourier.energy import FourierEnergy

__all__ = ["FourierEnergy", "NoFourierForm", "Potential"]
