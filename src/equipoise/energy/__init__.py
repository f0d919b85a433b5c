"""Potential energy: the slow sum (`reference`), the way chosen (`evaluate`), its exact Fourier form (`fourier`),
and its distance from constant without one (`span`)."""

from ..model.errors import NoFourierForm
from .evaluate import Potential
from .fourier.energy import FourierEnergy
from .span.energy import SpanEnergy

__all__ = ["FourierEnergy", "NoFourierForm", "Potential", "SpanEnergy"]
