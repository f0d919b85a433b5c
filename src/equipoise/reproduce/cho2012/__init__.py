"""A roll-pitch shoulder with bevel gears (Cho, Lee, Lee and Kang 2012), balanced by the method `bevel`.

C. Cho, W. Lee, J. Lee and S. Kang, "A 2-dof gravity compensator with bevel gears", J. Mechanical Science and Technology
26 (2012): the shoulder of Sec. 4.
"""

from .rows import reproduction
from .shoulder import GRID, TABLE_1, TIMES, arm, balanced, motion

__all__ = ["GRID", "TABLE_1", "TIMES", "arm", "balanced", "motion", "reproduction"]
