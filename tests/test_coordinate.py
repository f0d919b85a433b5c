"""A coordinate is a value: a name that knows its units, from the file to JSON and to other processes."""

from __future__ import annotations

import ast
import copy
import json
import pickle
from pathlib import Path

import pytest

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.model.coordinate import Coordinate, Slide
from equipoise.model.units import SI_UNITS

SOURCE = Path(eq.__file__).parent


def lift() -> eq.Mechanism:
    """A ball, a slide on it, and a hinge that a coupling turns."""
    names = ("ball", "slide", "hinge")
    bodies = tuple(eq.Body(f"on {name}", 1.0, (0.1, 0.0, 0.0)) for name in names)
    ends = ("world", *(body.name for body in bodies))
    joints = tuple(
        eq.Joint(name, kind, ends[i], ends[i + 1])
        for i, (name, kind) in enumerate(zip(names, ("spherical", "prismatic", "revolute"), strict=True))
    )
    return eq.Mechanism("lift", bodies, joints, (eq.Coupling("hinge", (("slide", 2.0),)),))


def test_every_layer_gives_the_same_coordinates_with_their_units() -> None:
    mechanism = lift()
    names = ("ball.x", "ball.y", "ball.z", "slide")
    tree, balance = Tree.of(mechanism), eq.check(mechanism, samples=8)
    for coordinates in (mechanism.coordinates, tree.coordinates, balance.coordinates):
        assert coordinates == names
        assert [c.unit for c in coordinates] == ["rad", "rad", "rad", "m"]
        assert [c.load_unit for c in coordinates] == ["N m", "N m", "N m", "N"]
    assert balance.units == ("rad", "rad", "rad", "m")
    assert tree.turns.tolist() == [True, True, True, False]
    assert tree.motions == (*names, "hinge")  # what a coupling turns moves, and is no coordinate
    assert json.loads(json.dumps(balance.to_dict()))["coordinates"] == list(names)


@pytest.mark.parametrize("kind", [Coordinate, Slide])
def test_units_are_those_of_the_dimensions(kind: type[Coordinate]) -> None:
    assert (SI_UNITS[kind.dimension], SI_UNITS[kind.load]) == (kind.unit, kind.load_unit)


def test_people_read_degrees_and_millimetres() -> None:
    assert Coordinate("elbow").show(0.5235987755982988) == "elbow 30.0 deg"
    assert Slide("lift").show(-0.0125) == "lift -12.5 mm"


@pytest.mark.parametrize("same", [copy.deepcopy, lambda c: pickle.loads(pickle.dumps(c))])
def test_a_copy_keeps_its_units_and_nothing_can_change_them(same) -> None:
    found: Slide = same(Slide("lift"))
    assert (str(found), type(found), found.unit) == ("lift", Slide, "m")
    with pytest.raises(AttributeError):
        found.unit = "rad"


def test_nobody_else_chooses_between_newtons_and_newton_metres() -> None:
    """A conditional with both units of load in it is a copy of what `Coordinate` knows."""
    copies = [
        f"{path.relative_to(SOURCE)}:{node.lineno}"
        for path in SOURCE.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.IfExp)
        and {"N m", "N"} <= {n.value for n in ast.walk(node) if isinstance(n, ast.Constant)}
    ]
    assert not copies
