"""A study laid out: designs by number, fields and options that are set, and what is said of mistakes."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

import equipoise as eq
from equipoise.model.errors import EquipoiseWarning, InputError
from equipoise.study.plan import FAILED, INFEASIBLE, OK, Plan
from equipoise.study.read import read
from equipoise.study.robots import Robot

EXAMPLES = Path(__file__).parents[1] / "examples"
PENDULUM = EXAMPLES / "mechanisms" / "pendulum.yaml"
QUICK = {"tolerance": {"builds": 20, "poses": 8}}


def plan(**given: object) -> Plan:
    return read({"mechanism": str(PENDULUM), "run": QUICK, **given})


def test_designs_are_those_of_nested_loops():
    found = plan(vary={"bodies.arm.mass": [1, 2], "builds": [5, 6, 7], "seed": [0, 1]}, run={"tolerance": {"poses": 2}})
    loops = [dict(zip(found.targets, values, strict=True)) for values in product([1, 2], [5, 6, 7], [0, 1])]
    assert [found.values(number) for number in range(len(found))] == loops


def test_a_field_is_set_as_an_editor_would(tmp_path):
    found = plan(
        vary={"bodies.arm.mass": ["3 kg"], "bodies.arm.com.0": [0.25], "gravity.2": [-1.62]}, run={"check": None}
    )
    text = PENDULUM.read_text().replace("mass: 2 kg", "mass: 3 kg").replace("com: [300 mm", "com: [250 mm")
    edited = tmp_path / "pendulum.yaml"
    edited.write_text(text + "\ngravity: [0, 0, -1.62]\n")
    assert found.mechanism(found.values(0)) == eq.load(edited)
    assert found.row(0)["largest_torque"] == float(eq.check(edited).residual.max[0])


def test_names_may_have_dots_and_items_numbers():
    robot = Robot("r", "schema: 1\nname: r\nbodies:\n  - {name: a.b, mass: 1}\n  - {name: a, mass: 2}\njoints: []\n")
    assert robot.place("bodies.a.b.mass") == ("bodies", 0, "mass")
    assert robot.place("bodies.a.mass") == ("bodies", 1, "mass")
    assert robot.place("bodies.1.com.2") == ("bodies", 1, "com", 2)
    assert robot.place("workspace.samples") == ("workspace", "samples")


def test_a_model_has_the_fields_of_its_mechanism_file():
    ur5 = EXAMPLES / "robots" / "ur5.urdf"
    with pytest.warns(EquipoiseWarning):
        found = read({"mechanism": str(ur5), "vary": {"bodies.forearm_link.mass": [9.0]}, "run": {"check": None}})
    mechanism = found.mechanism(found.values(0))
    assert mechanism is not None
    assert {body.name: body.mass for body in mechanism.bodies}["forearm_link"] == 9.0


def test_several_robots_are_the_first_factor(tmp_path):
    for name, mass in (("b", 1), ("a", 2)):
        (tmp_path / f"{name}.yaml").write_text(PENDULUM.read_text().replace("mass: 2 kg", f"mass: {mass} kg"))
    found = plan(mechanism=str(tmp_path), vary={"seed": [0, 1]})
    assert [found.row(number)["mechanism"] for number in range(len(found))] == ["a", "a", "b", "b"]


def test_what_goes_wrong_is_a_row():
    found = plan(vary={"bodies.arm.mass": [2, -1]}, record=["nominal"])
    good, bad = found.row(0), found.row(1)
    assert (good["status"], good["error"], bad["status"], bad["nominal"]) == (OK, None, FAILED, None)
    assert bad["error"].startswith("bodies[0].mass: must be at least 0 kg, found -1")
    no = plan(
        run={"design": {"exact": True, "pairs": "world:arm"}}, vary={"radius": ["1 mm", "200 mm"]}, record=["exact"]
    )
    assert [no.row(number)["status"] for number in (0, 1)] in ([INFEASIBLE, OK], [OK, OK])


def test_a_bug_is_a_row_too(monkeypatch):
    found = plan(vary={"seed": [0]})
    monkeypatch.setattr(Plan, "results", lambda self, values: 1 / 0)
    row = found.row(0)
    assert (row["status"], row["error"]) == (FAILED, "internal error: ZeroDivisionError: division by zero")


def test_commands_go_on_with_what_the_one_before_made():
    found = plan(
        run={"design": {"springs": 1}, **QUICK}, vary={"span": [1]}, record=["residual", "nominal", "design.springs"]
    )
    row = found.row(0)
    assert row["nominal"] == pytest.approx(row["residual"], abs=1e-6)
    assert found.design(0).springs
    assert row["nominal"] < 1e-6


def test_values_of_the_json_object_are_recorded_by_their_path():
    found = plan(
        run={"check": {"samples": 16}}, record=["torque.residual.max.0", "energy.gravity", "springs.7.name", "exact"]
    )
    row, balance = found.row(0), eq.check(PENDULUM, samples=16).to_dict()
    assert row["torque.residual.max.0"] == balance["torque"]["residual"]["max"][0]
    assert row["energy.gravity"] == str(balance["energy"]["gravity"])
    assert row["springs.7.name"] is None
    assert row["exact"] is True


@pytest.mark.parametrize(
    ("vary", "more", "line", "message"),
    [
        ("bodies.arn.mass: [1]", "", 3, "there is no 'arn'; did you mean 'arm'? in 'bodies' (valid: arm)"),
        ("bodies.arm.mas: [1]", "", 3, "there is no 'mas'; did you mean 'mass'? in 'bodies.0' (valid: name, mass"),
        ("bodies.arm.mass.x: [1]", "", 3, "'bodies.0.mass' is a value"),
        ("bulids: [5]", "", 3, "no option 'bulids'; did you mean 'builds'?"),
        ("poses: [5]", "", 3, "'run: tolerance' gives 'poses' too"),
        ("seed: [5]", "run: {tolerance: {builds: 5, psoes: 2}}", 4, "no option 'psoes'; did you mean 'poses'?"),
        ("seed: [5]", "run: {desing: {}}", 4, "no command 'desing'; did you mean 'design'? (valid: check, design"),
        ("seed: [5]", "run: {check: {}, tolerance: {}}", 3, "is an option of check and tolerance: say of which"),
        ("span: [1]", "run: {design: {method: convx}}", 4, "there is no method 'convx'; did you mean 'convex'?"),
        ("springs: [one]", "run: {design: {}}", 3, "expected a whole number, found one"),
        ("objective: [rms, peek]", "run: {design: {}}", 3, "unknown value 'peek'; did you mean 'peak'?"),
        ("radius: [5 kg]", "run: {design: {}}", 3, "expected a number [m] or text with a unit of length"),
        ("span: [0]", "run: {design: {}}", 3, "must be a whole number of at least 1"),
        ("seed: [1]", "run: {check: {}}\nrecord: [residul]", 5, "no quantity 'residul'; did you mean 'residual'?"),
        ("seed: [1]", "run: {check: {}}\nrecord: [energy.gravty]", 5, "there is no 'gravty'; did you mean 'gravity'?"),
        ("seed: [1]", "run: {check: {}}\nrecord: [status]", 5, "there is a column 'status' already"),
        ("seed: [1]", "run: {check: {}}\nrecrod: [exact]", 5, "unknown key 'recrod'; did you mean 'record'?"),
    ],
)
def test_mistakes_give_their_line(tmp_path, run, vary, more, line, message):
    file = tmp_path / "s.yaml"
    file.write_text(f"mechanism: {PENDULUM}\nvary:\n  {vary}\n{more or 'run: {tolerance: {builds: 5, poses: 2}}'}\n")
    code, _, err = run("study", file, "--dry-run")
    assert code == 2
    assert f"error: {file}:{line}:" in err
    assert message in err


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"mechanism": "nowhere.yaml"}, "no such file"),
        ({"mechanism": {"generator": "planar"}}, "no generator 'planar'"),
        ({"mechanism": {"generator": "planar-arm", "lenght": 1}}, "did you mean 'length'?"),
        ({"mechanism": 3}, "expected a file"),
        ({"run": None}, "'run' needs a command"),
        ({"vary": [1]}, "expected a mapping of parameters"),
        ({"vary": {"mechanism": [1]}}, "no option 'mechanism'"),
    ],
)
def test_mistakes_of_a_mapping(given, message):
    with pytest.raises(InputError, match=message.replace("?", r"\?").replace("(", r"\(")):
        plan(**given)


def test_generators_take_options_that_vary():
    found = read({
        "mechanism": {"generator": "planar-arm", "length": "100 mm"}, "vary": {"links": [3, 5], "mass": [2]},
        "run": {"check": None}, "record": ["exact"],
    })  # fmt: skip
    arms = [found.mechanism(found.values(number)) for number in range(2)]
    assert [len(arm.bodies) for arm in arms if arm] == [2, 4]
    assert {(body.mass, body.com) for arm in arms if arm for body in arm.bodies} == {(2, (0.05, 0, 0))}


def test_the_same_study_has_the_same_hash_and_another_has_not():
    one, same, other = (plan(vary={"seed": seeds}) for seeds in ([0, 1], [0, 1], [0, 2]))
    assert one.hash == same.hash != other.hash
