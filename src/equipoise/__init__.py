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
from .model.elements import Guide, JointElement, LineElement, Pulley, Spring, TorsionSpring, laws
from .model.mechanism import Body, Coupling, Joint, Loop, Mechanism, PointMass, Workspace

if TYPE_CHECKING:
    from .balance import Balance, check
    from .io import load, save
    from .synthesis import Design, Load, Problem, Region, design, solve

__all__ = [
    "Balance",
    "Body",
    "Coupling",
    "Design",
    "Guide",
    "Joint",
    "JointElement",
    "LineElement",
    "Load",
    "Loop",
    "Mechanism",
    "PointMass",
    "Problem",
    "Pulley",
    "Region",
    "Spring",
    "TorsionSpring",
    "Workspace",
    "__version__",
    "check",
    "design",
    "laws",
    "load",
    "save",
    "solve",
]

_LAZY = {
    "Balance": "balance",
    "check": "balance",
    "load": "io",
    "save": "io",
    "Design": "synthesis",
    "Load": "synthesis",
    "Problem": "synthesis",
    "Region": "synthesis",
    "design": "synthesis",
    "solve": "synthesis",
}

notebook.supplied_by(lambda: import_module(f"{__name__}.report.notebook"))


def __getattr__(name: str) -> Any:
    # what computes is imported on first use, so that `import equipoise` stays quick
    if name in _LAZY:
        return getattr(import_module(f"{__name__}.{_LAZY[name]}"), name)
    raise AttributeError(f"module 'equipoise' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(__all__)
