"""Values typed on the command line: quantities, pairs, a method's settings."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from ..model import slips
from ..model.errors import Fault, InputError, nearest
from ..model.units import quantity, to_share, to_si
from . import terminal

if TYPE_CHECKING:
    from ..model.mechanism import Mechanism
    from ..model.payload import Payload
    from ..synthesis import Parameter

FLAGS = {"yes": True, "no": False, "true": True, "false": False}


def length(text: str, option: str) -> float:
    """A length such as ``0.15`` [m] or ``150mm``.

    Raises:
        InputError: it is not a length; the message names the option.
    """
    return quantity(text, "length", option)


def positive_length(text: str, option: str) -> float:
    """A length of more than 0 [m]."""
    value = length(text, option)
    if value <= 0:
        raise InputError(Fault((option,), f"must be more than 0 m, found {text}"))
    return value


def payload(mechanism: Mechanism, masses: str, body: str, place: str) -> Payload:
    """``LOW,HIGH`` [kg] on a body at ``X,Y,Z`` [m].

    Raises:
        InputError: not two masses, not three lengths, or no such body.
    """
    from ..model.payload import Payload

    bounds = [quantity(text, "mass", "--payload") for text in masses.split(",")]
    point = [length(text, "--payload-at") for text in place.split(",")]
    if len(bounds) != 2 or len(point) != 3:
        raise InputError("--payload: expected LOW,HIGH such as 0,2kg, and --payload-at X,Y,Z such as 0,0,50mm")
    terminal.slip(slips.twice(mechanism, body, point))
    return Payload.at(mechanism, bounds, body, point)


def free_lengths(texts: list[str]) -> float | dict[str, float] | None:
    """``LENGTH`` for all springs or ``SPRING=LENGTH`` for some; None when nothing is given.

    Raises:
        InputError: not a length, or one for all beside one for a spring.
    """
    found = {name.strip(): length(value, "--free-length") for name, _, value in (t.rpartition("=") for t in texts)}
    if "" in found and len(texts) > 1:
        raise InputError(Fault(("--free-length",), "give one length for all springs, or SPRING=LENGTH for each"))
    return found.get("", found) if found else None


def friction(texts: list[str], mechanism: Mechanism) -> dict[str, float]:
    """``TORQUE`` for all turning joints, ``JOINT=TORQUE`` for one; a sliding joint's is a force [N].

    Raises:
        InputError: an unknown joint, or not a torque or force.
    """
    from ..kinematics import Tree

    coordinates, found = Tree.of(mechanism).coordinates, {}
    for text in texts:
        name, equals, value = text.rpartition("=")
        if equals and name not in coordinates:
            problem = f"there is no coordinate {nearest(name, coordinates)}"
            raise InputError(Fault(("--friction",), problem, coordinates))
        for coordinate in coordinates:
            if coordinate == name if equals else coordinate.turns:
                found[coordinate] = quantity(value, coordinate.load, "--friction")
    return found


def tolerance(text: str) -> tuple[float | None, float | None]:
    """(share, torque [N m]): ``1e-3`` and ``0.1%`` are shares of the unbalanced torque, ``0.5 N*m`` is a torque.

    Raises:
        InputError: it is neither, or not positive.
    """
    expected = "expected a share such as 1e-3 or 0.1%, or a torque such as '0.5 N m'"
    share = torque = None
    try:
        share = to_share(text)
    except ValueError:
        try:
            torque = to_si(text, "torque")
        except ValueError:
            raise InputError(Fault(("--tolerance",), f"{expected}, found '{text}'")) from None
    value = torque if share is None else share
    if value is None or not 0 < value < inf:
        raise InputError(Fault(("--tolerance",), f"must be more than 0 and finite, found {text}"))
    return share, torque


def names(text: str) -> list[str]:
    """``A,B,C`` as names."""
    return [name.strip() for name in text.split(",") if name.strip()]


def pairs(text: str, option: str = "--pairs") -> list[tuple[str, str]]:
    """``A:B,C:D`` as pairs of body names.

    Raises:
        InputError: a part is not two names with a colon between.
    """
    found = []
    for part in text.split(","):
        names = [name.strip() for name in part.split(":")]
        if len(names) != 2 or not all(names):
            raise InputError(Fault((option,), f"expected A:B,C:D with names of bodies, found '{part.strip()}'"))
        found.append((names[0], names[1]))
    return found


def settings(texts: list[str], valid: dict[str, Parameter]) -> dict[str, Any]:
    """``NAME=VALUE`` of ``--set``, for the parameters that a method has; ``NAME.BODY=VALUE`` is for one body.

    Raises:
        InputError: an unknown name, or a value of the wrong kind.
    """
    found: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name, dot, body = name.partition(".")
        if not equals or name not in valid:
            problem = f"no parameter {nearest(name, valid)}" if equals else f"expected NAME=VALUE, found '{text}'"
            raise InputError(Fault(("--set",), problem, tuple(valid)))
        parameter = valid[name]
        if dot and not parameter.each:
            raise InputError(Fault(("--set", name), f"is one value for the whole mechanism, found '{text}'"))
        place, key = (found.setdefault(name, {}), body if dot else "*") if parameter.each else (found, name)
        if key in place:
            raise InputError(Fault(("--set", name), f"is given twice, the second time by '{text}'"))
        place[key] = _values(name, value, parameter)
    return found


def _values(name: str, text: str, parameter: Parameter) -> Any:
    if parameter.many:
        return [_value(name, part, parameter) for part in text.split(",")]
    return _value(name, text, parameter)


def _value(name: str, text: str, parameter: Parameter) -> Any:
    text = text.strip()
    if parameter.choices and text not in parameter.choices:
        raise InputError(Fault(("--set", name), f"unknown value {nearest(text, parameter.choices)}", parameter.choices))
    match parameter.kind:
        case "text":
            return text
        case "names":
            return names(text)
        case "pairs":
            return pairs(text, f"--set {name}")
        case "flag":
            if text not in FLAGS:
                raise InputError(Fault(("--set", name), f"unknown value {nearest(text, FLAGS)}", tuple(FLAGS)))
            return FLAGS[text]
        case "whole":
            try:
                return int(text)
            except ValueError:
                raise InputError(Fault(("--set", name), f"expected a whole number, found '{text}'")) from None
        case "share":
            try:
                return to_share(text)
            except ValueError:
                problem = f"expected a share such as 0.05 or 5%, found '{text}'"
                raise InputError(Fault(("--set", name), problem)) from None
        case dimension:
            return quantity(text, dimension, f"--set {name}")
