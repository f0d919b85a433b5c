"""Designing springs: the problem, the methods and the design they return."""

from .convex.method import solve
from .design import Design
from .method import Method, Parameter
from .methods import METHODS, by_name, design
from .problem import Problem, Region

__all__ = ["METHODS", "Design", "Method", "Parameter", "Problem", "Region", "by_name", "design", "solve"]
