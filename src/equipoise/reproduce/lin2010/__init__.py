"""An industrial arm with auxiliary links (Lin, Shieh and Chen 2010), balanced by the method `pseudobase`.

P.-Y. Lin, W.-B. Shieh and D.-Z. Chen, "Design of a gravity-balanced general spatial serial-type manipulator",
J. Mechanisms Robotics 2 (2010): the arm of Sec. 6.
"""

from .arm import TIMES, arm, balanced, motion
from .rows import reproduction
from .tables import TABLE_2, TABLE_3

__all__ = ["TABLE_2", "TABLE_3", "TIMES", "arm", "balanced", "motion", "reproduction"]
