"""Where the bodies are: poses, Jacobians and random configurations."""

from .assembly import Mobility
from .branch import Status
from .linkage import Linkage
from .sampling import sample
from .tree import Poses, Tree, Velocities

__all__ = ["Linkage", "Mobility", "Poses", "Status", "Tree", "Velocities", "sample"]
