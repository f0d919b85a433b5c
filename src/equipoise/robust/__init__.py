"""What a real build does: manufacturing scatter, friction, payloads."""

from .adjust import Adjustment, adjust
from .identify import Identified, identify
from .scatter import Scatter
from .sweep import Sweep, sweep
from .tolerance import Tolerance, tolerance

__all__ = ["Adjustment", "Identified", "Scatter", "Sweep", "Tolerance", "adjust", "identify", "sweep", "tolerance"]
