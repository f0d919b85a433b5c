"""What varies: values of parameters as factors of a product, so that any design of a billion is found by its number."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.errors import Fault, InputError, nearest
from ..model.units import USUAL, to_si

Values = Sequence[Any]

RANDOM = {"uniform": ("low", "high"), "log-uniform": ("low", "high"), "normal": ("mean", "deviation")}
"""Distributions and what their two numbers are."""
RANGE = ("from", "to", "count", "scale")
DRAW = ("count", "seed", "points")
SCALES = ("linear", "log")
POINTS = ("random", "low-discrepancy")
MOST = 10_000_000  # values of one parameter


@dataclass(frozen=True)
class Axis:
    """Parameters whose values go together: the number of a value gives one for each."""

    values: Mapping[str, Values]

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))


def axes(vary: Mapping[str, Any]) -> tuple[Axis, ...]:
    """The factors of ``vary:``; parameters drawn with the same count, seed and kind of points share one.

    Raises:
        InputError: with a fault for every value that is no list, range or distribution; paths begin at the name.
    """
    faults: list[Fault] = []
    found: list[Axis] = []
    drawn: dict[tuple[Any, ...], dict[str, tuple[str, float, float]]] = {}
    for name, given in vary.items():
        try:
            if isinstance(given, Mapping) and any(law in given for law in RANDOM):
                key, law = _draw(given)
                if key not in drawn:
                    drawn[key] = {}
                    found.append(Axis({name: ()}))  # its place in the product
                drawn[key][name] = law
            else:
                found.append(Axis({name: _listed(given)}))
        except InputError as error:
            faults += [Fault((name, *fault.path), fault.message, fault.choices) for fault in error.faults]
    if faults:
        raise InputError(faults)
    together = {next(iter(laws)): _points(key, laws) for key, laws in drawn.items()}
    return tuple(Axis(together.get(next(iter(axis.values)), axis.values)) for axis in found)


def plain(value: Any) -> Any:
    """A text that is a number with a unit in SI, or a share; anything else as it is."""
    if not isinstance(value, str):
        return value
    text = value.strip()
    if text.endswith("%"):
        try:
            return float(text[:-1]) / 100
        except ValueError:
            return value
    head = text.rstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZµ°*/^ ")
    unit = text[len(head) :].strip()
    for dimension, units in USUAL.items():
        if head and unit in units:
            try:
                return to_si(text, dimension)
            except InputError:
                return value
    return value


def _listed(given: Any) -> Values:
    """The values of a list or a range."""
    if isinstance(given, Mapping):
        return _range(given)
    if isinstance(given, (list, tuple)):
        if not given:
            raise InputError("has no values")
        return tuple(plain(value) for value in given)
    raise InputError(Fault((), "expected a list, a range or a distribution", ("[1, 2]", "{from, to, count}", *RANDOM)))


def _range(given: Mapping[str, Any]) -> Values:
    _keys(given, RANGE, ("from", "to", "count"), (*RANGE, *RANDOM))
    low, high, count = _number(given, "from"), _number(given, "to"), _count(given)
    scale = given.get("scale", "linear")
    if scale not in SCALES:
        raise InputError(Fault(("scale",), f"no scale {nearest(scale, SCALES)}", SCALES))
    if scale == "log":
        if not 0 < low <= high:
            raise InputError(Fault(("from",), f"a log scale needs 0 < from <= to, found {low:g} and {high:g}"))
        return np.geomspace(low, high, count).tolist()
    whole = isinstance(given["from"], int) and isinstance(given["to"], int)
    if whole and (count == 1 or (given["to"] - given["from"]) % (count - 1) == 0):
        return np.linspace(given["from"], given["to"], count).astype(int).tolist()
    # rounded, so that a fifth of 1 is 0.2 and not its neighbour
    return [float(f"{value:.14g}") for value in np.linspace(low, high, count)]


def _draw(given: Mapping[str, Any]) -> tuple[tuple[Any, ...], tuple[str, float, float]]:
    """What parameters that are drawn together have in common, and the distribution."""
    law, *others = (name for name in RANDOM if name in given)
    _keys(given, (law, *DRAW), ("count",), (law, *DRAW))
    if others:
        raise InputError(Fault((others[0],), f"give either '{law}' or '{others[0]}'"))
    pair, names = given[law], RANDOM[law]
    if not isinstance(pair, (list, tuple)) or len(pair) != 2:
        raise InputError(Fault((law,), f"expected [{names[0]}, {names[1]}]"))
    a, b = (_number(dict(enumerate(pair)), i, law) for i in range(2))
    if law == "normal" and b < 0:
        raise InputError(Fault((law,), f"the deviation must be at least 0, found {b:g}"))
    if law != "normal" and not (0 if law == "log-uniform" else -math.inf) < a <= b:
        raise InputError(Fault((law,), f"needs {'0 < ' * (law != 'uniform')}low <= high, found {a:g} and {b:g}"))
    seed, points = given.get("seed", 0), given.get("points", "random")
    if not isinstance(seed, int) or isinstance(seed, bool) or seed < 0:
        raise InputError(Fault(("seed",), f"expected a whole number of at least 0, found {seed}"))
    if points not in POINTS:
        raise InputError(Fault(("points",), f"no points {nearest(points, POINTS)}", POINTS))
    return (_count(given), seed, points), (law, a, b)


def _points(key: tuple[Any, ...], laws: Mapping[str, tuple[str, float, float]]) -> dict[str, Values]:
    """Values of parameters that are drawn together."""
    count, seed, points = key
    if points == "random":  # a stream for each name, so that another parameter changes none
        streams = ([seed, zlib.crc32(name.encode())] for name in laws)
        unit = np.stack([np.random.default_rng(stream).random(count) for stream in streams], axis=1)
    else:
        from scipy.stats import qmc

        unit = qmc.Halton(len(laws), scramble=True, rng=np.random.default_rng(seed)).random(count)
    return {name: _spread(unit[:, i], *law).tolist() for i, (name, law) in enumerate(laws.items())}


def _spread(unit: np.ndarray, law: str, a: float, b: float) -> np.ndarray:
    """Numbers from 0 to 1 as draws of a distribution."""
    if law == "uniform":
        return a + (b - a) * unit
    if law == "log-uniform":
        return np.exp(np.log(a) + np.log(b / a) * unit)
    from scipy.special import ndtri

    return a + b * ndtri(np.clip(unit, 1e-16, 1 - 1e-16))


def _number(given: Mapping[Any, Any], key: Any, name: str = "") -> float:
    value = plain(given[key])
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        path = (name, key) if name else (key,)
        raise InputError(Fault(path, f"expected a number, or a number with a unit, found {given[key]}"))
    return float(value)


def _count(given: Mapping[str, Any]) -> int:
    count = given["count"]
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST:
        raise InputError(Fault(("count",), f"expected a whole number from 1 to {MOST:,}, found {count}"))
    return count


def _keys(given: Mapping[str, Any], valid: Sequence[str], needed: Sequence[str], choices: Sequence[str]) -> None:
    faults = [Fault((key,), f"unknown key {nearest(key, choices)}", tuple(choices)) for key in _unknown(given, valid)]
    faults += [Fault((), f"'{key}' is missing", tuple(choices)) for key in needed if key not in given and not faults]
    if faults:
        raise InputError(faults)


def _unknown(given: Mapping[str, Any], valid: Sequence[str]) -> Iterator[str]:
    return (key for key in given if key not in valid)
