"""Static balancing of DELTA robots and of a rocker about two axes (Simionescu, Ciupitu and Ionita 2015).

The example gives neither the places of the mass centres nor how the spring's mass splits. Taken here: mass centres at
mid-link (links 3 and 5 on the axes of their joints), half the spring's mass at V, base and platform of equal radius.
"""

from .rows import reproduction

__all__ = ["reproduction"]
