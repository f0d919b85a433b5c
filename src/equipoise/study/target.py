"""What the names of a study stand for: fields of the mechanism's file, options of a generator or a command, columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..model.errors import Fault, InputError, Path, nearest
from ..model.units import SI_UNITS
from ..synthesis import Parameter
from . import generators
from .commands import COMMANDS
from .quantities import QUANTITIES, Recorded, recorded
from .robots import SECTIONS, Robot

RESERVED = ("design", "mechanism", "status", "error", "warning", "seconds", "version")
"""Columns that every table has: no parameter is called so."""


@dataclass(frozen=True)
class Target:
    """What a parameter sets: an option of a command, or of the generator ("mechanism"), or a field of every robot."""

    command: str = ""
    option: str = ""
    places: Mapping[str, Path] = field(default_factory=dict)


def targets(document: Mapping[str, Any], robots: tuple[Robot, ...]) -> tuple[dict[str, Target], list[Fault]]:
    """Of each parameter, and the faults of the options that ``run:`` gives and of the names under ``vary:``."""
    faults: list[Fault] = []
    found: dict[str, Target] = {}
    vary, run = document.get("vary", {}), document["run"]
    options = _options(document, faults)
    if len(options) < len(run):
        return found, faults  # without its options nothing can be said of the names
    for name, given in vary.items():
        path = ("vary", name)
        if "." in name and name.partition(".")[0] in SECTIONS and robots:
            try:
                found[name] = Target(places={robot.name: robot.place(name) for robot in robots})
            except InputError as error:
                faults += [Fault(path, fault.message, fault.choices) for fault in error.faults]
            continue
        command, _, option = name.partition(".")
        having = [command] if command in options and option else [c for c, names in options.items() if name in names]
        option = option if command in options and option else name
        if len(having) > 1:
            choices = tuple(f"{one}.{name}" for one in having)
            faults.append(Fault(path, f"'{name}' is an option of {' and '.join(having)}: say of which", choices))
        elif not having or option not in options[having[0]]:
            valid = options[having[0]] if having else tuple(one for names in options.values() for one in names)
            fields = SECTIONS if robots and not having else ()
            more = f", nor is it a field such as {SECTIONS[3]}.NAME..." if fields else ""
            faults.append(Fault(path, f"no option {nearest(option, (*valid, *fields))}{more}", valid))
        elif name in RESERVED:
            faults.append(Fault(path, f"a column is called '{name}' already: write {having[0]}.{name}"))
        elif having[0] != "mechanism" and option in (run[having[0]] or {}):
            faults.append(Fault(path, f"'run: {having[0]}' gives '{option}' too: leave out one of them"))
        else:
            found[name] = Target(having[0], option)
            faults += _values(path, given, _parameters(document, having[0]).get(option))
    return found, faults


def recordings(document: Mapping[str, Any]) -> tuple[tuple[Recorded, ...], list[Fault]]:
    """The columns of results, and what is wrong with their names; without ``record:`` all quantities of the run."""
    faults: list[Fault] = []
    found: dict[str, Recorded] = {}
    commands = tuple(document["run"])
    names = document.get("record")
    if names is None:
        taken = [*document.get("vary", {}), *(name for command in commands for name in QUANTITIES[command])]
        names = [
            name if taken.count(name) == 1 else f"{command}.{name}"
            for command in commands
            for name in QUANTITIES[command]
        ]
    for i, name in enumerate(names):
        path = ("record", i)
        if name in (*RESERVED, *document.get("vary", {}), *found):
            having = [command for command in commands if name in QUANTITIES[command]]
            instead = f": write {having[0]}.{name}" if having else ""
            faults.append(Fault(path, f"there is a column '{name}' already{instead}"))
            continue
        try:
            found[name] = recorded(str(name), commands)
        except InputError as error:
            faults += [Fault(path, fault.message, fault.choices) for fault in error.faults]
    return tuple(found.values()), faults


def _given(document: Mapping[str, Any], command: str) -> dict[str, Any]:
    """The options that ``run:`` gives to a command, and of those that vary what decides on others."""
    method = document.get("vary", {}).get("method")
    return {**({"method": method} if method else {}), **(document["run"][command] or {})}


def _options(document: Mapping[str, Any], faults: list[Fault]) -> dict[str, tuple[str, ...]]:
    """Command -> its options; the generator's are under "mechanism"."""
    found: dict[str, tuple[str, ...]] = {}
    if "generator" in document:
        found["mechanism"] = generators.options(document["generator"]["name"])
    for command, given in document["run"].items():
        try:
            valid = found[command] = COMMANDS[command].options(_given(document, command))
        except InputError as error:
            place = ("run", command) if "method" in (given or {}) else ("vary",)
            faults += [Fault((*place, *fault.path), fault.message, fault.choices) for fault in error.faults]
            continue
        parameters = _parameters(document, command)
        for name, value in (given or {}).items():
            path = ("run", command, name)
            if name not in valid:
                faults.append(Fault(path, f"no option {nearest(name, valid)}", valid))
            else:
                faults += _values(path, [value], parameters.get(name), single=True)
    return found


def _parameters(document: Mapping[str, Any], command: str) -> Mapping[str, Parameter]:
    return {} if command == "mechanism" else COMMANDS[command].parameters(_given(document, command))


def _values(path: Path, given: Any, parameter: Parameter | None, single: bool = False) -> list[Fault]:
    """What is wrong with the values of a parameter, as far as it is known what they have to be."""
    if parameter is None or not isinstance(given, (list, tuple)):
        return []
    faults = []
    for i, value in enumerate(given):
        place = path if single else (*path, i)
        if parameter.choices and value not in parameter.choices:
            message = f"unknown value {nearest(value, parameter.choices)}"
            faults.append(Fault(place, message, parameter.choices))
        elif parameter.kind == "whole" and (not isinstance(value, int) or isinstance(value, bool)):
            faults.append(Fault(place, f"expected a whole number, found {value}"))
        elif parameter.kind in SI_UNITS and not parameter.each:
            try:
                parameter.number((), value)
            except InputError as error:
                faults += [Fault(place, fault.message, fault.choices) for fault in error.faults]
    return faults
