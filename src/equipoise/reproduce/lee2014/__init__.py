"""Layouts of springs on planar arms (Lee and Chen 2014): Tables 2 to 5 and Fig. 10.

Y.-Y. Lee and D.-Z. Chen, "Determination of spring installation configuration on statically balanced planar articulated
manipulators", Mechanism and Machine Theory 74 (2014).
"""

from .arm import arm, balanced, completed, motion, printed
from .rows import reproduction
from .tables import CASES, TIMES

__all__ = ["CASES", "TIMES", "arm", "balanced", "completed", "motion", "printed", "reproduction"]
