"""equipoise designs the springs that make a robot weightless, and proves it.

The names below are the whole public interface::

    import equipoise as eq

    design = eq.design(eq.load("ur5.urdf"), span=3)
    print(design.balance.exact, design.balance.residual.max)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._version import __version__
from .model import notebook

if TYPE_CHECKING:
    from .balance import Balance, check
    from .io import load, save
    from .model.elements import Guide, JointElement, LineElement, Pulley, Spring, TorsionSpring, laws
    from .model.goal import Count, Goal, Gravity, Loads, Tool
    from .model.mechanism import Body, Coupling, Joint, Loop, Mechanism, PointMass, Workspace
    from .proof.certificate import Certified, certify, verify
    from .synthesis import Design, Load, Problem, Region, design, solve

__all__ = [
    "Balance",
    "Body",
    "Certified",
    "Count",
    "Coupling",
    "Design",
    "Goal",
    "Gravity",
    "Guide",
    "Joint",
    "JointElement",
    "LineElement",
    "Load",
    "Loads",
    "Loop",
    "Mechanism",
    "PointMass",
    "Problem",
    "Pulley",
    "Region",
    "Spring",
    "Tool",
    "TorsionSpring",
    "Workspace",
    "__version__",
    "certify",
    "check",
    "design",
    "laws",
    "load",
    "save",
    "solve",
    "verify",
]

_PLACES = {
    "balance": ("Balance", "check"),
    "io": ("load", "save"),
    "model.elements": ("Guide", "JointElement", "LineElement", "Pulley", "Spring", "TorsionSpring", "laws"),
    "model.goal": ("Count", "Goal", "Gravity", "Loads", "Tool"),
    "model.mechanism": ("Body", "Coupling", "Joint", "Loop", "Mechanism", "PointMass", "Workspace"),
    "proof.certificate": ("Certified", "certify", "verify"),
    "synthesis": ("Design", "Load", "Problem", "Region", "design", "solve"),
}
_MODULE = {name: module for module, names in _PLACES.items() for name in names}

notebook.supplied_by(lambda: import_module(f"{__name__}.report.notebook"))


def __getattr__(name: str) -> Any:
    # imported on first use, so that `import equipoise` waits for nothing
    if name in _MODULE:
        found = globals()[name] = getattr(import_module(f"{__name__}.{_MODULE[name]}"), name)
        return found
    raise AttributeError(f"module 'equipoise' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(__all__)
