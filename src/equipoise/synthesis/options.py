"""What a method can be asked for, as one frozen type for each method.

Signatures, the checks of the front door, ``--set`` and `equipoise methods` all derive from the fields of these types,
and quantities given as text become numbers in them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from functools import wraps
from inspect import Parameter as Argument
from inspect import signature
from math import inf
from typing import Any, Concatenate, Literal, ParamSpec, TypeVar

from ..model.progress import Progress
from ..model.units import SI_UNITS, quantity, share

Kind = Literal[
    "length",
    "angle",
    "mass",
    "stiffness",
    "force",
    "torque",
    "number",
    "share",
    "whole",
    "text",
    "names",
    "pairs",
    "flag",
]
P = ParamSpec("P")
Value = TypeVar("Value")
Asked = TypeVar("Asked")
Answer = TypeVar("Answer")


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

    def number(self, path: tuple[str, ...], value: Any) -> Any:
        """The value with every quantity that is text as a number; what is no quantity stays as it is.

        Raises:
            InputError: a text is no such quantity.
        """
        if self.kind not in SI_UNITS and self.kind != "share":
            return value
        if isinstance(value, Mapping):
            return {key: self.number((*path, str(key)), one) for key, one in value.items()}
        if isinstance(value, (list, tuple)):
            return [self.number(path, one) for one in value]
        if not isinstance(value, str):
            return value
        return share(value, *path, most=inf) if self.kind == "share" else quantity(value, self.kind, *path)


def option(
    default: Any, kind: Kind, help: str, choices: tuple[str, ...] = (), *, each: bool = False, many: bool = False
) -> Any:
    """A field of options that ``--set`` can give and `equipoise methods` lists; see `Parameter`."""
    return field(default=default, metadata={"parameter": Parameter(kind, help, choices, each, many)})


@dataclass(frozen=True, kw_only=True)
class Options:
    """Options by name; a field made by `option` is also a parameter on the command line.

    Raises:
        InputError: a text is no quantity of the kind that its field holds.
    """

    def __post_init__(self) -> None:
        for name, parameter in self.parameters().items():
            object.__setattr__(self, name, parameter.number((name,), getattr(self, name)))

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """All options."""
        return tuple(f.name for f in fields(cls))

    @classmethod
    def parameters(cls) -> dict[str, Parameter]:
        """Those that the command line takes by ``--set``."""
        return {f.name: f.metadata["parameter"] for f in fields(cls) if "parameter" in f.metadata}

    def of(self, kind: type[Options]) -> dict[str, Any]:
        """Those that another type of options has too."""
        return {name: getattr(self, name) for name in kind.names()}


@dataclass(frozen=True, kw_only=True)
class MethodOptions(Options):
    """What every method can be asked for.

    Attributes:
        progress: called with what is being done and the share of it that is done; quick work reports none.
    """

    progress: Progress | None = field(default=None, repr=False, compare=False)


def takes(
    options: Callable[P, Asked],
) -> Callable[[Callable[[Value, Asked], Answer]], Callable[Concatenate[Value, P], Answer]]:
    """Decorate a function of (value, options): it takes the options by name, and has the signature of their type."""

    def decorate(function: Callable[[Value, Asked], Answer]) -> Callable[Concatenate[Value, P], Answer]:
        @wraps(function)
        def call(value: Value, /, *args: P.args, **given: P.kwargs) -> Answer:
            return function(value, options(*args, **given))

        own = signature(function)
        first = next(iter(own.parameters.values())).replace(kind=Argument.POSITIONAL_ONLY)
        named = signature(options).parameters.values()
        call.__signature__ = own.replace(parameters=[first, *named])  # type: ignore[attr-defined]
        return call

    return decorate
