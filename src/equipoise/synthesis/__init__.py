"""Designing springs: the problem, the methods and the design they return."""

from .design import Design
from .methods import METHODS, Method, design
from .problem import Problem, Region

__all__ = ["METHODS", "Design", "Method", "Problem", "Region", "design"]
