"""Values keep their promises: they compare, arrays included, and nothing in them can be changed behind their back."""

from __future__ import annotations

import copy
import inspect
import json
import pickle
import pkgutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from importlib import import_module
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
import pytest
from zoo import pendulum

import equipoise as eq
from equipoise.balance import Loads
from equipoise.io.yaml import to_text
from equipoise.model.arrays import Array, frozen
from equipoise.model.immutable import ImmutableMapping, immutable
from equipoise.synthesis import Design
from equipoise.synthesis.convex.ordinary import Ordinary


def dataclasses() -> Iterator[type]:
    for module in pkgutil.walk_packages(eq.__path__, "equipoise."):
        if not module.name.endswith("__main__"):
            for kind in vars(import_module(module.name)).values():
                if inspect.isclass(kind) and is_dataclass(kind) and kind.__module__ == module.name:
                    yield kind


def holds_arrays(annotation: Any) -> bool:
    return get_origin(annotation) is np.ndarray or any(map(holds_arrays, get_args(annotation)))


def with_arrays() -> list[type]:
    names = {"Ordinary": Ordinary}  # imported for type checkers only
    return [
        kind
        for kind in dict.fromkeys(dataclasses())
        if kind.__eq__ is not object.__eq__ and any(map(holds_arrays, get_type_hints(kind, localns=names).values()))
    ]


def blank(kind: type, changed: str = "") -> Any:
    """An object of the class with small arrays where its fields hold arrays, and one word everywhere else."""
    made, hints = object.__new__(kind), get_type_hints(kind)
    for f in fields(kind):
        array = np.array([1.0, np.nan, 3.0 if f.name == changed else 2.0])
        object.__setattr__(made, f.name, array if holds_arrays(hints[f.name]) else f"same{f.name == changed}")
    return made


@pytest.mark.parametrize("kind", with_arrays(), ids=lambda kind: f"{kind.__module__}.{kind.__qualname__}")
def test_dataclasses_with_arrays_compare(kind: type) -> None:
    assert blank(kind) == blank(kind)
    for f in fields(kind):
        assert (blank(kind) == blank(kind, f.name)) is not f.compare
    assert blank(kind) != "something else"


def test_the_kinds_are_found() -> None:
    assert {eq.Balance, Loads} <= set(with_arrays())

    @dataclass(frozen=True)
    class Careless:
        x: Array

    with pytest.raises(ValueError, match="ambiguous"):
        _ = Careless(np.zeros(2)) == Careless(np.ones(2))


def test_arrays_in_containers_compare() -> None:
    @frozen
    class Nest:
        x: dict[str, tuple[Array, ...]]

    one, same, shorter, other = (
        Nest({"a": tuple(np.full(n, value) for n in sizes)})
        for sizes, value in (((2, 3), 1.0), ((2, 3), 1.0), ((2, 2), 1.0), ((2, 3), 2.0))
    )
    assert one == same
    assert one not in (shorter, other, Nest({}))
    with pytest.raises(TypeError):
        hash(one)


def two_links() -> eq.Mechanism:
    bodies = (eq.Body("upper", 2.0, (0.2, 0.0, 0.0)), eq.Body("fore", 1.0, (0.2, 0.0, 0.0)))
    joints = (
        eq.Joint("shoulder", "revolute", "world", "upper", axis=(0.0, 1.0, 0.0)),
        eq.Joint("elbow", "revolute", "upper", "fore", xyz=(0.4, 0.0, 0.0), axis=(0.0, 1.0, 0.0)),
    )
    spring = eq.Spring("s", "world", (0.0, 0.0, 0.2), "upper", (0.2, 0.0, 0.0), 100.0)
    return eq.Mechanism("two links", bodies, joints, springs=(spring,))


def test_verdicts_of_two_coordinates_compare() -> None:
    one, same = (eq.check(two_links(), samples=32) for _ in range(2))
    assert one == same
    assert one != eq.check(two_links(), samples=33)
    assert replace(one, worst_torque=one.worst_torque + 1) != one
    assert copy.deepcopy(one) == pickle.loads(pickle.dumps(one)) == one


PROVENANCE = {"method": "convex", "exact": True, "pairs": [["world", "gear"]], "steps": [{"gap": 1e-9}, None]}


def test_provenance_cannot_change() -> None:
    given = copy.deepcopy(PROVENANCE)
    mechanism = replace(pendulum(), provenance=given)
    given["steps"][0]["gap"] = 5.0
    given["method"] = "another"
    assert mechanism.provenance["steps"][0]["gap"] == 1e-9
    assert mechanism.provenance["method"] == "convex"
    live: Any = mechanism.provenance
    for change in (
        lambda: live.__setitem__("method", "another"),
        lambda: live["steps"][0].update(gap=1.0),
        lambda: live["pairs"].append("more"),
    ):
        with pytest.raises(AttributeError):
            change()
    with pytest.raises(TypeError):
        live["method"] = "another"


def test_provenance_is_written_copied_and_compared_as_before(tmp_path) -> None:
    mechanism = replace(pendulum(), provenance=PROVENANCE)
    written = "method: convex\n  exact: true\n  pairs: [[world, gear]]\n  steps:\n    - gap: 1e-09\n    - null\n"
    assert to_text(mechanism).endswith(f"provenance:\n  {written}")
    eq.save(mechanism, tmp_path / "arm.yaml")
    for same in (eq.load(tmp_path / "arm.yaml"), copy.deepcopy(mechanism), pickle.loads(pickle.dumps(mechanism))):
        assert same == mechanism
        assert hash(same) == hash(mechanism)
    assert mechanism.provenance == immutable(PROVENANCE)
    assert mechanism.provenance["steps"][0] == {"gap": 1e-9}
    assert hash(mechanism.provenance) == hash(immutable(PROVENANCE))
    assert repr(ImmutableMapping({"a": [1]})) == "{'a': (1,)}"
    assert json.dumps(mechanism.provenance["pairs"]) == '[["world", "gear"]]'


def test_a_design_repeats_a_verdict_only_on_what_was_judged(monkeypatch) -> None:
    judged: list[eq.Mechanism] = []

    def check(mechanism: eq.Mechanism) -> eq.Balance:
        judged.append(mechanism)
        return eq.check(mechanism, samples=32)

    monkeypatch.setattr(sys.modules[Design.__module__], "check", check)
    design = Design.of(pendulum(), "planar", {})
    assert design.balance.mechanism is design.mechanism
    assert design.mechanism.provenance["method"] == "planar"
    assert judged == [pendulum()]
    thicker = design.with_diameter(0.02)
    assert thicker.balance.mechanism is thicker.mechanism
    assert judged[1:] == [thicker.mechanism]
