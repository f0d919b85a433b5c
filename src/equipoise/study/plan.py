"""A study as it is worked on: any of its designs by number, made from the parameters of that number alone."""

from __future__ import annotations

import hashlib
import json
import math
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from .._version import __version__
from ..io.yaml_positions import Located
from ..model.errors import EquipoiseError, EquipoiseWarning, Fault, InputError, Path, shortened
from ..model.mechanism import Mechanism
from .axes import Axis, axes, plain
from .commands import COMMANDS
from .generators import GENERATORS
from .quantities import Recorded
from .robots import Robot
from .target import Target, recordings, targets

OK, INFEASIBLE, FAILED = "ok", "infeasible", "failed"
"""What a row's status says: the answer is there, the answer is "no", or there is none."""
FIXED = {"design": "int64", "mechanism": "string"}
AFTER = {"status": "string", "error": "string", "warning": "string", "seconds": "double", "version": "string"}
"""The columns before the parameters, and those after the results; seconds are of processor time."""


@dataclass(frozen=True)
class Plan:
    """A study without its files: `document` is all of it, as plain data, and what a worker gets.

    Attributes:
        targets: of each parameter, what it is set in.
        record: the columns of results.
        located: the places of all that stands in its file.
    """

    document: Mapping[str, Any]
    robots: tuple[Robot, ...]
    axes: tuple[Axis, ...]
    targets: Mapping[str, Target]
    record: tuple[Recorded, ...]
    located: Located | None = None

    @staticmethod
    def of(document: Mapping[str, Any], located: Located | None = None) -> Plan:
        """Check a document and lay it out.

        Raises:
            InputError: with a fault for everything that is wrong; their paths are those of the study file.
        """
        faults: list[Fault] = []
        robots = tuple(Robot(one["name"], one["text"]) for one in document.get("robots", ()))
        found: tuple[Axis, ...] = ()
        try:
            found = axes(document.get("vary", {}))
        except InputError as error:
            faults += (_within("vary", fault) for fault in error.faults)
        if len(robots) > 1:
            found = (Axis({"mechanism": range(len(robots))}), *found)
        set_in, wrong = targets(document, robots)
        record, more = recordings(document)
        if faults or wrong or more:
            raise InputError([*faults, *wrong, *more])
        return Plan(document, robots, found, set_in, record, located)

    def __len__(self) -> int:
        return math.prod(map(len, self.axes))

    @cached_property
    def hash(self) -> str:
        """The same for the same study: its text and that of its mechanisms."""
        return hashlib.sha256(json.dumps(self.document).encode()).hexdigest()

    @cached_property
    def parameters(self) -> dict[str, str]:
        """The columns of what varies, with their types."""
        return {
            name: _type(values) for axis in self.axes for name, values in axis.values.items() if name != "mechanism"
        }

    def values(self, number: int) -> dict[str, Any]:
        """The parameters of a design; the last one changes fastest."""
        found: list[tuple[str, Any]] = []
        for axis in reversed(self.axes):
            number, i = divmod(number, len(axis))
            found += [(name, values[i]) for name, values in axis.values.items()]
        return dict(reversed(found))

    def row(self, number: int) -> dict[str, Any]:
        """A design as a row: parameters, results, and how it went. Whatever goes wrong, it is a row."""
        start, values = time.thread_time(), self.values(number)
        row, status, error = self._begun(number, values), OK, None
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", EquipoiseWarning)
            try:
                results = self.results(values)
                row |= {one.name: one.of(results) for one in self.record}
            except EquipoiseError as failure:
                status, error = INFEASIBLE if failure.exit_code == 1 else FAILED, str(failure)
            except Exception as failure:
                status, error = FAILED, f"internal error: {type(failure).__name__}: {shortened(str(failure))}"
        said = dict.fromkeys(str(one.message) for one in caught if issubclass(one.category, EquipoiseWarning))
        row |= {"status": status, "error": error, "warning": "; ".join(said) or None}
        return row | {"seconds": time.thread_time() - start, "version": __version__}

    def lost(self, number: int, why: str) -> dict[str, Any]:
        """The row of a design that takes down the process that works on it."""
        row = self._begun(number, self.values(number))
        return row | {"status": FAILED, "error": why, "warning": None, "seconds": 0.0, "version": __version__}

    def results(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """What the commands say, by command; each goes on with the mechanism that the one before it made.

        Raises:
            EquipoiseError: as the commands.
        """
        mechanism, found = self.mechanism(values), {}
        for command, options in self.document["run"].items():
            given = {name: plain(value) for name, value in (options or {}).items()}
            given |= {target.option: values[name] for name, target in self.targets.items() if target.command == command}
            found[command] = COMMANDS[command].run(mechanism, given)  # type: ignore[arg-type]
            mechanism = COMMANDS[command].made(found[command]) or mechanism
        return found

    def mechanism(self, values: Mapping[str, Any]) -> Mechanism | None:
        """The mechanism that the first command gets; None where none needs one."""
        if "generator" in self.document:
            own = {t.option: values[name] for name, t in self.targets.items() if t.command == "mechanism"}
            generator = self.document["generator"]
            return GENERATORS[generator["name"]](**{**generator["options"], **own})
        if not self.robots:
            return None
        robot = self.robots[values.get("mechanism", 0)]
        changes: dict[Path, Any] = {
            target.places[robot.name]: values[name] for name, target in self.targets.items() if target.places
        }
        return robot.mechanism(changes)

    def design(self, number: int) -> Mechanism:
        """The mechanism that a design ends with, made again.

        Raises:
            InputError: there is no such design, or it makes no mechanism; EquipoiseError: as the commands.
        """
        if not 0 <= number < len(self):
            raise InputError(f"there is no design {number}: they are numbered from 0 to {len(self) - 1:,}")
        values = self.values(number)
        mechanism, found = self.mechanism(values), self.results(values)
        for command, result in found.items():
            mechanism = COMMANDS[command].made(result) or mechanism if command in COMMANDS else mechanism
        if mechanism is None:
            raise InputError("this study makes no mechanisms")
        return mechanism

    def _begun(self, number: int, values: Mapping[str, Any]) -> dict[str, Any]:
        """A row without results."""
        row: dict[str, Any] = {"design": number, "mechanism": self._name(values)}
        row |= {name: _cell(value) for name, value in values.items() if name != "mechanism"}
        return row | dict.fromkeys((one.name for one in self.record), None)

    def _name(self, values: Mapping[str, Any]) -> str | None:
        if "generator" in self.document:
            return self.document["generator"]["name"]
        return self.robots[values.get("mechanism", 0)].name if self.robots else None


def _within(key: str, fault: Fault) -> Fault:
    return Fault((key, *fault.path), fault.message, fault.choices)


def _cell(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, (list, tuple, dict)) else value


def _type(values: Any) -> str:
    """What a column of these values holds."""
    kinds = {type(value) for value in values}
    if kinds == {bool}:
        return "bool"
    if kinds == {int}:
        return "int64"
    return "double" if kinds <= {int, float} else "string"
