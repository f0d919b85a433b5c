"""A coordinate of a mechanism, as a value: its name, which knows what it measures."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi


class Coordinate(str):
    """The coordinate of a joint that turns: an angle, which a torque holds. `Slide` is the other kind.

    It is a text, its own name: equal to it, printed and written as it, a valid key wherever a name is one.

    Attributes:
        turns: whether it is an angle.
        dimension, unit: what it measures, a key of `units.SI_UNITS`, and the SI unit.
        load, load_unit: the same of what holds it.
        shown_unit, scale: the unit that people read it in, and how many of it make one SI unit.
    """

    __slots__ = ()
    turns = True
    dimension, unit = "angle", "rad"
    load, load_unit = "torque", "N m"
    shown_unit, scale = "deg", 180 / pi

    def show(self, value: float) -> str:
        """``elbow 30.0 deg``: the coordinate at a value [rad or m]."""
        return f"{self} {self.scale * value:.1f} {self.shown_unit}"


class Slide(Coordinate):
    """The coordinate of a joint that slides: a length, which a force holds."""

    __slots__ = ()
    turns = False
    dimension, unit = "length", "m"
    load, load_unit = "force", "N"
    shown_unit, scale = "mm", 1e3


def load_unit(coordinates: Iterable[Coordinate]) -> str:
    """Of what holds these coordinates together: newtons where all slide; else a slide's force counts times a length."""
    kinds = {coordinate.turns for coordinate in coordinates}
    return Slide.load_unit if kinds == {False} else Coordinate.load_unit
