"""How close springs come to links and to each other, and the poses in which a spring does not do its work."""

from .segments import closest

__all__ = ["closest"]
