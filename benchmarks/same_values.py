"""Whether two versions say the same: what a command says, compared by what it is about.

A number may differ by a share of its scale, the largest number beside it that has the same meaning: noise of 1e-16 in a
list of torques is measured by the torques. All energies and torques of an answer have one scale. Prose may change and
is only noted; so is a pose that attains an extreme, one of several as a rule, while the extreme itself counts.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

EVALUATED = 1e-9  # of a number's scale
DESIGNED = 1e-6  # of the unbalanced torque
PROSE = {"summary", "source", "reasons", "parameters", "reason", "note", "settings", "excluded", "why"}
EXTREMES = {"configuration"}
PHYSICS = {"energy", "torque", "worst", "max_coefficient", "residual", "unbalanced"}  # all have one scale
LEAST = 0.1  # [J, N m or N] of it: what hardware leaves of a balance may all be noise
SHARES = ("share", "gap")  # the ends of names of shares of one
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")

Path = tuple[str, ...]


@dataclass
class Found:
    """What differs, what is new, and what changed without counting."""

    differences: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    new: set[str] = field(default_factory=set)


def compare(rule: str, before: dict[str, Any], after: dict[str, Any]) -> Found:
    """Two answers of `same_side.py` to one command, by the rule for its kind: values, design, simulate or text."""
    found = Found()
    if before["code"] != after["code"]:
        text = after["err"].strip().splitlines()[-1:] or [""]
        found.differences.append(f"exit code {before['code']} -> {after['code']} {text[0]}")
        return found
    if before["err"] != after["err"]:
        found.notes.append(f"message: {_first_change(before['err'], after['err'])}")
    if rule == "text" or not before["out"] or not after["out"]:
        _texts((), before["out"], after["out"], found)
        return found
    a, b = json.loads(before["out"]), json.loads(after["out"])
    _keys((), a, b, found)
    if rule == "values":
        _values(a, b, found)
    elif rule == "design":
        _design(a, b, found)
    return found  # of a simulation the exit code is the verdict; its drifts are a chaotic motion's


def _keys(path: Path, a: Any, b: Any, found: Found) -> None:
    """Keys that are missing, or new."""
    if isinstance(a, dict) and isinstance(b, dict):
        found.differences += [f"{_name((*path, key))}: missing" for key in a.keys() - b.keys()]
        found.new |= {_name((*path, key)) for key in b.keys() - a.keys()}
        for key in a.keys() & b.keys():
            _keys((*path, key), a[key], b[key], found)
    elif isinstance(a, list) and isinstance(b, list):
        for x, y in zip(a, b, strict=False):
            _keys(path, x, y, found)


def _values(a: Any, b: Any, found: Found) -> None:
    scales: dict[Path, float] = {("physics",): LEAST, ("shares",): 1.0}
    for path, value in _leaves((), a):
        if _is_number(value):
            scales[_family(path)] = max(scales.get(_family(path), 0.0), abs(value))
    _same((), a, b, scales, found)


def _same(path: Path, a: Any, b: Any, scales: dict[Path, float], found: Found) -> None:
    if isinstance(a, dict) and isinstance(b, dict):
        a, b = _in_units(a), _in_units(b)
        if path[-1:] == ("worst",):
            a, b = _largest(a), _largest(b)
        for key in sorted(a.keys() & b.keys()):
            _same((*path, key), a[key], b[key], scales, found)
    elif isinstance(a, list) and isinstance(b, list):
        if len(a) != len(b):
            found.differences.append(f"{_name(path)}: {len(a)} -> {len(b)} entries")
            return
        a, b = _matched(a, b)
        for x, y in zip(a, b, strict=True):
            _same(path, x, y, scales, found)
    elif isinstance(a, int | float) and isinstance(b, int | float) and _is_number(a) and _is_number(b):
        scale = max(scales.get(_family(path), 0.0), abs(a))
        if not abs(a - b) <= EVALUATED * scale:
            change = f"{_name(path)}: {a!r} -> {b!r}, {abs(a - b) / scale if scale else float('inf'):.2g} of its scale"
            (found.notes if EXTREMES & set(path) else found.differences).append(change)
    elif isinstance(a, str) and isinstance(b, str):
        _texts(path, a, b, found)
    elif a != b or type(a) is not type(b):
        found.differences.append(f"{_name(path)}: {_short(a)} -> {_short(b)}")


def _design(a: dict[str, Any], b: dict[str, Any], found: Found) -> None:
    """Verdict, pairs and number of springs; bound and residual to a share of the unbalanced torque."""

    def verdict(one: dict[str, Any]) -> dict[str, Any]:
        balance = one["balance"]
        return {
            "method": one["method"],
            "exact": balance["exact"],
            "certificate": balance["certificate"]["kind"],
            "exact_feasible": one["exact_feasible"],
            "number of springs": len(balance["springs"]),
            "pairs": sorted(sorted((s["body_a"], s["body_b"])) for s in balance["springs"] if "body_a" in s),
            "front": [(row["springs"], row["exact"]) for row in one["front"]],
            "parameters": sorted(one["free_parameters"]),
        }

    for (name, x), y in zip(verdict(a).items(), verdict(b).values(), strict=True):
        if x != y:
            found.differences.append(f"{name}: {_short(x)} -> {_short(y)}")
    for at, x, y in zip(range(len(a["front"]) + 1), (a, *a["front"]), (b, *b["front"]), strict=False):
        for name in ("unbalanced", "residual", "bound"):
            p, q = x.get(name), y.get(name)
            if p is None or q is None:
                if p is not q:
                    found.differences.append(f"{name}: {p} -> {q}")
            elif not abs(p - q) <= DESIGNED * abs(a["unbalanced"]):
                where = f"front[{at - 1}].{name}" if at else name
                how = "better" if (q < p) == (name == "residual") else "worse"
                off = abs(p - q) / abs(a["unbalanced"])
                found.differences.append(f"{where}: {p!r} -> {q!r}, {how} by {off:.2g} of the unbalanced torque")
    details = Found()  # other springs may do as well
    _values(a, b, details)
    if details.differences and not found.differences:
        found.notes.append(f"{len(details.differences)} details, first {details.differences[0]}")


def _texts(path: Path, a: str, b: str, found: Found) -> None:
    """Texts with numbers in them: the words are the same, and the numbers nearly."""
    if a == b:
        return
    if PROSE & set(path):
        found.notes.append(f"{_name(path)}: {_first_change(a, b)}")
        return
    near = NUMBER.split(a) == NUMBER.split(b) and all(
        abs(float(x) - float(y)) <= EVALUATED * max(abs(float(x)), 1e-3)
        for x, y in zip(NUMBER.findall(a), NUMBER.findall(b), strict=True)
    )
    if not near:
        found.differences.append(f"{_name(path)}: {_first_change(a, b)}")


def _matched(a: list[Any], b: list[Any]) -> tuple[list[Any], list[Any]]:
    """Rows that have names of their own are found by them: where two are equally large, either may come first."""
    names = [[str(row["name"]) if isinstance(row, dict) and "name" in row else "" for row in rows] for rows in (a, b)]
    if "" in names[0] or len(set(names[0])) < len(a) or sorted(names[0]) != sorted(names[1]):
        return a, b
    return a, [b[names[1].index(name)] for name in names[0]]


def _family(path: Path) -> Path:
    if path and path[-1].endswith(SHARES):
        return ("shares",)
    return ("physics",) if PHYSICS & set(path) else path


def _largest(worst: dict[str, Any]) -> dict[str, Any]:
    """Of the torques at the worst pose only the largest counts: other poses may be as bad."""
    return worst | {"torque": max(map(abs, worst["torque"]), default=0.0)} if "torque" in worst else worst


def _in_units(value: dict[str, Any]) -> dict[str, Any]:
    """Rows of a table have units of their own: a number's name has it too."""
    if not isinstance(value.get("unit"), str):
        return value
    return {f"{key} [{value['unit']}]" if _is_number(one) else key: one for key, one in value.items()}


def _leaves(path: Path, value: Any) -> Iterator[tuple[Path, Any]]:
    if isinstance(value, dict):
        for key, one in _in_units(value).items():
            yield from _leaves((*path, key), one)
    elif isinstance(value, list):
        for one in value:
            yield from _leaves(path, one)
    else:
        yield path, value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _name(path: Path) -> str:
    return ".".join(path) or "output"


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 100 else text[:97] + "..."


def _first_change(a: str, b: str) -> str:
    for x, y in zip(a.splitlines(), b.splitlines(), strict=False):
        if x != y:
            return f"{_short(x.strip())} -> {_short(y.strip())}"
    return f"{len(a.splitlines())} -> {len(b.splitlines())} lines"
