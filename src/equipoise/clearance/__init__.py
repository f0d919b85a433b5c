"""How close springs come to links and to each other, and the poses in which a spring does not do its work."""

from .judge import Clearance, Gap, Line, clearance
from .room import Room
from .segments import closest

__all__ = ["Clearance", "Gap", "Line", "Room", "clearance", "closest"]
