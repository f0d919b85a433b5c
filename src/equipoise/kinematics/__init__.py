"""Where the bodies are: poses, Jacobians and random configurations."""

from .sampling import sample
from .tree import Poses, Tree, Velocities

__all__ = ["Poses", "Tree", "Velocities", "sample"]
