"""What a study records: a quantity by its name, or any value of the command's JSON object by its path."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Any, Literal

from ..model.errors import Fault, InputError, nearest
from ..synthesis.planar.layouts import name

Type = Literal["int64", "double", "bool", "string"]


@dataclass(frozen=True)
class Quantity:
    """A number, truth or text of a result; `help` says which, with its unit."""

    type: Type
    of: Callable[[Any], Any]
    help: str


def _largest(values: Any) -> float:
    return float(max(values, default=0.0))


def _rms(load: Any) -> float:
    return sqrt(float(sum(load.rms**2)))


JUDGED: dict[str, Quantity] = {
    "exact": Quantity("bool", lambda b: b.exact, "whether balance is proved at every configuration"),
    "largest_torque": Quantity("double", lambda b: _largest(b.residual.max), "largest residual torque [N m]"),
    "largest_unbalanced": Quantity("double", lambda b: _largest(b.unbalanced.max), "the same without springs [N m]"),
    "relative": Quantity("double", lambda b: float(b.relative), "one over the other"),
    "largest_force": Quantity("double", lambda b: _largest(u.max_force for u in b.use), "of any spring [N]"),
    "longest": Quantity("double", lambda b: _largest(u.max_length for u in b.use), "any spring gets [m]"),
}
DESIGNED: dict[str, Quantity] = {
    "residual": Quantity("double", lambda d: d.residual, "torque that is left, as the objective has it [N m]"),
    "unbalanced": Quantity("double", lambda d: d.unbalanced, "the same without springs [N m]"),
    "share": Quantity("double", lambda d: d.residual / d.unbalanced if d.unbalanced else 0.0, "one over the other"),
    "bound": Quantity("double", lambda d: d.bound, "no springs on these pairs and regions leave less [N m]"),
    "gap": Quantity("double", lambda d: d.certified_gap, "residual less bound, as a share of unbalanced"),
    "springs": Quantity("int64", lambda d: len(d.mechanism.springs), "how many there are"),
    "exact_feasible": Quantity("bool", lambda d: d.exact_feasible, "whether exact balance is possible"),
    "fewest": Quantity("int64", lambda d: d.fewest and d.fewest.springs, "springs exact balance needs at least"),
    "weight": Quantity("double", lambda d: float(sum(m.mass for m in d.mechanism.masses)), "of all point masses [kg]"),
    **{name: Quantity(q.type, lambda d, q=q: q.of(d.balance), q.help) for name, q in JUDGED.items()},
}
QUANTITIES: dict[str, dict[str, Quantity]] = {
    "check": {
        "residual": Quantity("double", lambda b: _rms(b.residual), "root mean square of what is left [N m]"),
        "unbalanced": Quantity("double", lambda b: _rms(b.unbalanced), "the same without springs [N m]"),
        "springs": Quantity("int64", lambda b: len(b.mechanism.springs), "how many there are"),
        **JUDGED,
    },
    "design": DESIGNED,
    "tolerance": {
        "yield": Quantity("double", lambda t: t.yield_, "share of builds that friction holds"),
        "nominal": Quantity("double", lambda t: _largest(t.nominal), "peak residual torque of the drawing [N m]"),
        "mean_peak": Quantity("double", lambda t: _largest(t.peak.mean(axis=0)), "of a build on average [N m]"),
        "worst_peak": Quantity("double", lambda t: _largest(t.peak.max(axis=0)), "of the worst build [N m]"),
        "main_cause": Quantity("string", lambda t: next(iter(t.by_kind)), "what scatters most"),
    },
    "layouts": {
        "candidates": Quantity("int64", lambda s: s.candidates, "layouts looked at"),
        "pruned": Quantity("int64", lambda s: sum(map(len, s.pruned.values())), "excluded by a criterion"),
        "proved": Quantity("int64", lambda s: len(s.proved), "excluded by a proof"),
        "feasible": Quantity("int64", lambda s: len(s.feasible), "of least cost"),
        "open": Quantity("int64", lambda s: len(s.open), "undecided"),
        "cost": Quantity("double", lambda s: s.feasible[0].cost if s.feasible else None, "the least"),
        "best": Quantity("string", lambda s: " ".join(name(one.layout) for one in s.feasible), "the feasible layouts"),
    },
    "wait": {"waited": Quantity("double", lambda w: w.seconds, "[s]")},
}
"""Of each command, in the order in which they are recorded when nothing is said."""


@dataclass(frozen=True)
class Recorded:
    """A column of results.

    Attributes:
        name: as the study has it.
        command: whose result it is of.
        path: in the command's JSON object, empty for a quantity.
    """

    name: str
    command: str
    path: tuple[str, ...] = ()

    @property
    def type(self) -> Type | None:
        """What the column holds; None where only a result can tell."""
        return None if self.path else QUANTITIES[self.command][self.name.rpartition(".")[2]].type

    def of(self, results: dict[str, Any]) -> Any:
        """Its value, from the results of all commands.

        Raises:
            InputError: the JSON object has no such key; a list that is too short gives None.
        """
        found = results[self.command]
        if not self.path:
            return QUANTITIES[self.command][self.name.rpartition(".")[2]].of(found)
        key = f"{self.command} as JSON"  # made once for all columns
        if key not in results:
            results[key] = found.to_dict()
        node = results[key]
        for i, key in enumerate(self.path):
            node = self._step(node, key, self.path[:i])
        return json.dumps(node) if isinstance(node, (list, dict)) else node

    def _step(self, node: Any, key: str, above: tuple[str, ...]) -> Any:
        if node is None:
            return None
        if isinstance(node, dict) and key in node:
            return node[key]
        if isinstance(node, list) and key.isdecimal():
            return node[int(key)] if int(key) < len(node) else None
        choices = tuple(node) if isinstance(node, dict) else ("0", "1", "...") if isinstance(node, list) else ()
        where = ".".join((self.command, *above))
        raise InputError(Fault(("record",), f"there is no {nearest(key, choices)} in '{where}'", choices))


def recorded(wanted: str, commands: tuple[str, ...]) -> Recorded:
    """What an entry of ``record:`` means: NAME, COMMAND.NAME, or a path such as ``balance.torque.residual.max.0``.

    Raises:
        InputError: no command of the study has it, or several have.
    """
    first, _, rest = wanted.partition(".")
    if first in commands and rest:
        if rest in QUANTITIES[first]:
            return Recorded(wanted, first)
        return Recorded(wanted, first, tuple(rest.split(".")))
    having = [command for command in commands if wanted in QUANTITIES[command]]
    if len(having) > 1:
        choices = tuple(f"{command}.{wanted}" for command in having)
        raise InputError(Fault((), f"'{wanted}' may be of {' or '.join(having)}", choices))
    if having:
        return Recorded(wanted, having[0])
    if rest and len(commands) == 1:
        return Recorded(wanted, commands[0], tuple(wanted.split(".")))
    choices = tuple(dict.fromkeys(known for command in commands for known in QUANTITIES[command]))
    raise InputError(Fault((), f"no quantity {nearest(wanted, choices)}; a path of the JSON would do too", choices))
