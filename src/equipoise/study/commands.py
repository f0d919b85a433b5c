"""What a study can run on a mechanism: commands with the options of their Python functions."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields
from inspect import signature
from typing import Any

from ..balance import check
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from ..robust import Scatter, tolerance
from ..synthesis import METHODS, Parameter
from ..synthesis.convex.ordinary import OrdinaryOptions
from ..synthesis.methods import by_name
from ..synthesis.planar.layouts import search

Given = Mapping[str, Any]
APART = ("progress", "mechanism", "max_terms")  # arguments that are no options


@dataclass(frozen=True)
class Command:
    """A command.

    Attributes:
        run: of a mechanism, and options by name -> the result, which has a `to_dict`.
        options: of the options given -> all names that are valid beside them.
        parameters: of the options given -> what is known of the values of some.
        made: the mechanism that comes out, for the next command and for ``--export``.
        on_mechanism: whether it needs one.
    """

    run: Callable[[Mechanism, dict[str, Any]], Any]
    options: Callable[[Given], tuple[str, ...]]
    parameters: Callable[[Given], Mapping[str, Parameter]] = lambda given: {}
    made: Callable[[Any], Mechanism | None] = lambda found: None
    on_mechanism: bool = True


@dataclass(frozen=True)
class Waited:
    """Nothing was done for `seconds`."""

    seconds: float

    def to_dict(self) -> dict[str, Any]:
        return asdict(self)


def _of(function: Callable[..., Any]) -> tuple[str, ...]:
    return tuple(name for name in signature(function).parameters if name not in APART)


def _methods(given: Given) -> list[str]:
    """The methods that a design is asked of: one, or those that are varied."""
    method = given.get("method", "convex")
    names = method if isinstance(method, (list, tuple)) else [method]
    for name in names:
        if name not in METHODS:
            raise InputError(Fault(("method",), f"there is no method {nearest(name, METHODS)}", tuple(METHODS)))
    return list(names)


FINISH = tuple(f.name for f in fields(OrdinaryOptions))  # of ordinary springs: a step after the method


def _design_options(given: Given) -> tuple[str, ...]:
    own = (name for method in _methods(given) for name in METHODS[method].options.names() if name not in APART)
    return tuple(dict.fromkeys(("method", *own, *FINISH, "diameter")))


def _design_parameters(given: Given) -> dict[str, Parameter]:
    return {name: one for method in _methods(given) for name, one in METHODS[method].parameters.items()}


def _design(mechanism: Mechanism, given: dict[str, Any]) -> Any:
    finish = {name: given.pop(name) for name in FINISH if name in given}
    diameter = given.pop("diameter", None)
    for name in ("pairs", "joints"):
        if isinstance(given.get(name), str):
            parts = [part.strip() for part in given[name].split(",")]
            given[name] = [part.split(":") for part in parts] if name == "pairs" else parts
    found = by_name(mechanism, given.pop("method", "convex"), **given)
    if diameter is not None:
        found = found.with_diameter(diameter)
    return found.with_ordinary_springs(**finish) if finish else found


SCATTER = tuple(f.name for f in fields(Scatter))


def _tolerance(mechanism: Mechanism, given: dict[str, Any]) -> Any:
    scatter = Scatter(**{name: given.pop(name) for name in SCATTER if name in given})
    return tolerance(mechanism, scatter, **given)


def _wait(mechanism: Mechanism, given: dict[str, Any]) -> Waited:
    seconds = float(given.get("seconds", 0.0))
    time.sleep(seconds)
    return Waited(seconds)


COMMANDS = {
    "check": Command(lambda mechanism, given: check(mechanism, **given), lambda given: _of(check)),
    "design": Command(_design, _design_options, _design_parameters, lambda found: found.mechanism),
    "tolerance": Command(
        _tolerance, lambda given: tuple(name for name in (*SCATTER, *_of(tolerance)) if name != "scatter")
    ),
    "layouts": Command(lambda _, given: search(**given), lambda given: _of(search), on_mechanism=False),
    "wait": Command(_wait, lambda given: ("seconds",), on_mechanism=False),
}
"""By name. ``wait`` takes its time and does nothing: it measures what a cluster costs by itself."""
