"""What a real build does: manufacturing scatter, friction, payloads."""

from .payload import Sweep, sweep
from .scatter import Scatter
from .tolerance import Tolerance, tolerance

__all__ = ["Scatter", "Sweep", "Tolerance", "sweep", "tolerance"]
