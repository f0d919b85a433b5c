"""What a real build does: manufacturing scatter and friction."""

from .scatter import Scatter
from .tolerance import Tolerance, tolerance

__all__ = ["Scatter", "Tolerance", "tolerance"]
