"""Designing springs: the problem, the methods and the design they return."""

from .convex.method import solve
from .design import Design
from .load import Load
from .method import Method, Parameter
from .methods import METHODS, by_name, design, reasons
from .problem import Problem, Region

__all__ = [
    "METHODS",
    "Design",
    "Load",
    "Method",
    "Parameter",
    "Problem",
    "Region",
    "by_name",
    "design",
    "reasons",
    "solve",
]
