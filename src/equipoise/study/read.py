"""The study file: YAML to a document that needs no other file, with everything that is wrong in it at once."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path as FilePath
from typing import Any

from ..io.files import read_text
from ..io.yaml_positions import Located, parse
from ..model.errors import Fault, InputError, nearest
from . import generators
from .axes import plain
from .commands import COMMANDS
from .plan import Plan
from .robots import Robot, files

KEYS = ("name", "mechanism", "vary", "run", "record")


def read(study: str | os.PathLike[str] | Mapping[str, Any]) -> Plan:
    """A study from its file, or from a mapping as the file has it; mechanism files are read now.

    Raises:
        InputError: everything that is wrong, with file, line, column and the valid choices.
    """
    if isinstance(study, Mapping):
        return _checked(dict(study), "study", FilePath())
    path = os.fspath(study)
    located = parse(read_text(path), path)
    if located.faults:
        raise located.error()
    try:
        return _checked(located.data, FilePath(path).stem, FilePath(path).parent, located)
    except InputError as error:
        raise located.error(located.locate(fault, on_key=True) for fault in error.faults) from None


def _checked(data: Any, name: str, folder: FilePath, located: Located | None = None) -> Plan:
    if not isinstance(data, dict):
        raise InputError(Fault((), "expected a mapping", KEYS))
    faults = [Fault((key,), f"unknown key {nearest(key, KEYS)}", KEYS) for key in data if key not in KEYS]
    faults += _run(data)
    document: dict[str, Any] = {"name": str(data.get("name", name))}
    for key, kind, what in (("vary", dict, "a mapping of parameters"), ("record", list, "a list of names")):
        if key in data and not isinstance(data[key], kind):
            faults.append(Fault((key,), f"expected {what}, found {data[key]}"))
    needed = any(COMMANDS[c].on_mechanism for c in data.get("run") or () if c in COMMANDS)
    if "mechanism" in data:
        try:
            document |= _subject(data["mechanism"], folder)
        except InputError as error:
            faults += (f if f.file else Fault(("mechanism", *f.path), f.message, f.choices) for f in error.faults)
    elif needed:
        faults.append(
            Fault((), "'mechanism' is missing", ("a file", "a folder", "a list of files", "{generator: ...}"))
        )
    if faults:
        raise InputError(faults)
    document |= {key: data[key] for key in ("vary", "run", "record") if data.get(key) is not None}
    return Plan.of(document, located)


def _run(data: Mapping[str, Any]) -> Iterator[Fault]:
    run = data.get("run")
    if not isinstance(run, dict) or not run:
        yield Fault(("run",) if "run" in data else (), "'run' needs a command", tuple(COMMANDS))
        return
    for command, options in run.items():
        if command not in COMMANDS:
            yield Fault(("run", command), f"no command {nearest(command, COMMANDS)}", tuple(COMMANDS))
        elif options is not None and not isinstance(options, dict):
            yield Fault(("run", command), f"expected a mapping of options, found {options}")


def _subject(given: Any, folder: FilePath) -> dict[str, Any]:
    """Robots as their texts, or a generator with its options."""
    if isinstance(given, dict):
        return {"generator": _generator(given)}
    names = given if isinstance(given, list) else [given]
    faults, paths = [], list[FilePath]()
    for i, name in enumerate(names):
        place = (i,) if isinstance(given, list) else ()
        if not isinstance(name, str):
            faults.append(Fault(place, f"expected a file, a folder, a list of them or a generator, found {name}"))
            continue
        try:
            paths += files(name, folder)
        except InputError as error:
            faults += [Fault(place, fault.message, fault.choices) for fault in error.faults]
    robots: dict[str, Robot] = {}
    for path in paths:
        try:
            robot = Robot.of(path)
        except InputError as error:
            faults += error.faults
            continue
        if robot.name in robots:
            faults.append(Fault((), f"two mechanism files are called '{robot.name}'"))
        robots[robot.name] = robot
    if faults:
        raise InputError(faults)
    return {"robots": [{"name": robot.name, "text": robot.text} for robot in robots.values()]}


def _generator(given: Mapping[str, Any]) -> dict[str, Any]:
    name, known = given.get("generator"), tuple(generators.GENERATORS)
    if name not in known:
        path = ("generator",) if "generator" in given else ()
        raise InputError(Fault(path, f"no generator {nearest(name, known)}", known))
    valid = generators.options(name)
    unknown = [key for key in given if key not in (*valid, "generator")]
    if unknown:
        raise InputError(Fault((key,), f"unknown key {nearest(key, valid)}", valid) for key in unknown)
    return {"name": name, "options": {key: plain(value) for key, value in given.items() if key != "generator"}}
