"""Designing springs: the problem, the methods and the design they return."""

from .design import Design
from .method import Method, Parameter
from .methods import METHODS, design
from .problem import Problem, Region

__all__ = ["METHODS", "Design", "Method", "Parameter", "Problem", "Region", "design"]
