"""What a real build does: manufacturing scatter, friction, payloads."""

from .adjust import Adjustment, adjust
from .scatter import Scatter
from .sweep import Sweep, sweep
from .tolerance import Tolerance, tolerance

__all__ = ["Adjustment", "Scatter", "Sweep", "Tolerance", "adjust", "sweep", "tolerance"]
