"""equipoise designs the springs that make a robot weightless, and proves it.

Every command of the command line is a function of the same name here, and its result prints as the command does::

    import equipoise as eq

    design = eq.design("ur5.urdf", span=3)
    print(design)
    print(eq.hardware(design.mechanism))
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from ._version import __version__
from .model import notebook

if TYPE_CHECKING:
    from .balance import Balance, check
    from .clearance import clearance
    from .hardware import bill as hardware
    from .hardware import choose as stock
    from .io import load, save
    from .model.elements import Guide, JointElement, LineElement, Pulley, Spring, TorsionSpring, laws
    from .model.errors import EquipoiseError, InfeasibleError, InputError, UnsupportedError
    from .model.goal import Cost, Count, Goal, Gravity, Loads, Tool
    from .model.mechanism import Body, Coupling, Joint, Loop, Mechanism, PointMass, Workspace
    from .model.motion import Box, Listed, Motion, Where
    from .model.payload import Payload
    from .proof.certificate import Certified, certify, verify
    from .report.export import export
    from .report.figure import plot
    from .report.page.make import write as report
    from .reproduce import reproduce
    from .robust import adjust, identify, sweep, tolerance
    from .simulate import play
    from .simulate import release as simulate
    from .study.compare import compare
    from .study.make import study
    from .synthesis import Design, Load, Problem, Region, design, solve
    from .synthesis import reasons as methods
    from .synthesis.calibrate import calibrate
    from .synthesis.planar.layouts import search as layouts
    from .viewer.server import Viewer as view

__all__ = [
    "Balance",
    "Body",
    "Box",
    "Certified",
    "Cost",
    "Count",
    "Coupling",
    "Design",
    "EquipoiseError",
    "Goal",
    "Gravity",
    "Guide",
    "InfeasibleError",
    "InputError",
    "Joint",
    "JointElement",
    "LineElement",
    "Listed",
    "Load",
    "Loads",
    "Loop",
    "Mechanism",
    "Motion",
    "Payload",
    "PointMass",
    "Problem",
    "Pulley",
    "Region",
    "Spring",
    "Tool",
    "TorsionSpring",
    "UnsupportedError",
    "Where",
    "Workspace",
    "__version__",
    "adjust",
    "calibrate",
    "certify",
    "check",
    "clearance",
    "compare",
    "design",
    "export",
    "hardware",
    "identify",
    "laws",
    "layouts",
    "load",
    "methods",
    "play",
    "plot",
    "report",
    "reproduce",
    "save",
    "simulate",
    "solve",
    "stock",
    "study",
    "sweep",
    "tolerance",
    "verify",
    "view",
]

_PLACES: dict[str, tuple[str, ...]] = {
    "balance": ("Balance", "check"),
    "clearance": ("clearance",),
    "hardware": ("bill as hardware", "choose as stock"),
    "io": ("load", "save"),
    "model.elements": ("Guide", "JointElement", "LineElement", "Pulley", "Spring", "TorsionSpring", "laws"),
    "model.errors": ("EquipoiseError", "InfeasibleError", "InputError", "UnsupportedError"),
    "model.goal": ("Cost", "Count", "Goal", "Gravity", "Loads", "Tool"),
    "model.motion": ("Box", "Listed", "Motion", "Where"),
    "model.mechanism": ("Body", "Coupling", "Joint", "Loop", "Mechanism", "PointMass", "Workspace"),
    "model.payload": ("Payload",),
    "study": ("study",),
    "study.compare": ("compare",),
    "proof.certificate": ("Certified", "certify", "verify"),
    "report.export": ("export",),
    "report.figure": ("plot",),
    "report.page.make": ("write as report",),
    "reproduce": ("reproduce",),
    "robust": ("adjust", "identify", "sweep", "tolerance"),
    "simulate": ("play", "release as simulate"),
    "synthesis": ("Design", "Load", "Problem", "Region", "design", "reasons as methods", "solve"),
    "synthesis.planar.layouts": ("search as layouts",),
    "viewer.server": ("Viewer as view",),
    "synthesis.calibrate": ("calibrate",),
}
_FROM = {name.split(" as ")[-1]: (module, name.split(" as ")[0]) for module, names in _PLACES.items() for name in names}

notebook.supplied_by(lambda: import_module(f"{__name__}.report.notebook"))


class _Front(ModuleType):
    """This module. A package of the same name as a command, once imported, does not take the command's place."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _FROM and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Front


def __getattr__(name: str) -> Any:
    # imported on first use, so that `import equipoise` waits for nothing
    if name in _FROM:
        module, own = _FROM[name]
        found = globals()[name] = getattr(import_module(f"{__name__}.{module}"), own)
        return found
    raise AttributeError(f"module 'equipoise' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(__all__)
