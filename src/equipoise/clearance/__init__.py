"""How close springs come to links and to each other, and the poses in which a spring does not do its work."""

from .constraint import Room
from .segments import closest
from .verdict import Clearance, Gap, Line, clearance

__all__ = ["Clearance", "Gap", "Line", "Room", "clearance", "closest"]
