"""What a real build does: manufacturing scatter, friction, payloads."""

from .adjust import Adjustment, adjust
from .payload import Sweep, sweep
from .scatter import Scatter
from .tolerance import Tolerance, tolerance

__all__ = ["Adjustment", "Scatter", "Sweep", "Tolerance", "adjust", "sweep", "tolerance"]
