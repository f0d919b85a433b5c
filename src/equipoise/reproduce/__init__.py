"""The source papers, reproduced: one module for each, its tables and figures, published beside computed."""

from __future__ import annotations

from importlib import import_module

from ..model.arrays import Array
from ..model.errors import Fault, InputError, nearest
from .record import Map, Plot, Reproduction, Row

PAPERS: tuple[str, ...] = (
    "lin2010",
    "cho2012",
    "simionescu2015",
    "lenzo2017",
    "lee2014",
)
"""Keys of the papers; each names its file."""

MOTIONS: tuple[str, ...] = ("lin2010", "lenzo2017", "lee2014", "cho2012")
"""Those that drive their arm through a motion; their files have `TIMES`, `motion` and `arm`."""

__all__ = ["MOTIONS", "PAPERS", "Map", "Plot", "Reproduction", "Row", "motion", "reproduce"]


def motion(paper: str) -> tuple[str, Array, tuple[str, ...], Array]:
    """A paper's motion: the arm's name, times (T,) [s], coordinates, and their values (T, coordinates) [rad]."""
    module = import_module(f".{paper}", __package__)
    arm = module.arm()
    return arm.name, module.TIMES, arm.coordinates, module.motion()


def reproduce(paper: str) -> Reproduction:
    """Compute everything that a paper prints.

    Raises:
        InputError: no such paper.
    """
    if paper not in PAPERS:
        raise InputError(Fault(("paper",), f"there is no paper {nearest(paper, PAPERS)}", PAPERS))
    return import_module(f".{paper}", __package__).reproduction()
