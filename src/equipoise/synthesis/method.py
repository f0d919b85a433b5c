"""What a design method is: data that the command line, the tests and the documentation read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from ..mechanism import Mechanism
from .design import Design

Kind = Literal[
    "length", "angle", "mass", "stiffness", "torque", "number", "share", "whole", "text", "names", "pairs", "flag"
]


@dataclass(frozen=True)
class Parameter:
    """One free parameter of a method, as ``--set NAME=VALUE`` takes it.

    Attributes:
        kind: a dimension of `units.SI_UNITS`, or what else the text stands for.
        choices: the valid texts, where there is a list of them.
        each: may also be given for one body, ``NAME.BODY=VALUE``; the method gets a mapping then, with the value for
            all other bodies, if there is one, under "*".
        many: ``VALUE,VALUE,...``; the method gets a list.
    """

    kind: Kind
    help: str
    choices: tuple[str, ...] = ()
    each: bool = False
    many: bool = False


@dataclass(frozen=True)
class Method:
    """A way to design springs.

    Attributes:
        applies: mechanism -> the reasons why it does not apply, empty when it does.
        exact: whether it has formulas for exact balance, instead of an objective and a bound.
        run: ``run(mechanism, **options)``; every parameter is one of its options.
    """

    name: str
    summary: str
    source: str
    applies: Callable[[Mechanism], list[str]]
    run: Callable[..., Design]
    parameters: dict[str, Parameter] = field(default_factory=dict)
    exact: bool = True
