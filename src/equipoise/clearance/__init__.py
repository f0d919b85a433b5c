"""How close springs, weights and links come to each other, and the poses in which a spring does not do its work."""

from .constraint import ClearanceConstraint
from .segments import closest
from .verdict import Clearance, Gap, SpringStates, clearance
from .within import within

__all__ = ["Clearance", "ClearanceConstraint", "Gap", "SpringStates", "clearance", "closest", "within"]
