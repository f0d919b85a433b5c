"""Energy and torque of many poses, compiled: see `Kernel`.

A tree is flattened (`layout`), the recursions are written down on symbols (`recursions`) and become a straight-line
program (`trace`). That one program is run by numpy, by an interpreter that numba compiles once, or as vector code.
"""

from .kernel import Batch, Kernel, Parts, Tier

__all__ = ["Batch", "Kernel", "Parts", "Tier"]
