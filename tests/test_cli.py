"""The command line as a user or a script meets it: output, exit codes, and nothing half-written."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from robots import ROBOTS, lee_chen

import equipoise as eq
from equipoise.synthesis import METHODS

PENDULUM = """\
schema: 1
name: one-link arm
bodies:
  - {name: arm, mass: 2 kg, com: [300 mm, 0, 0]}
joints:
  - {name: shoulder, type: revolute, parent: world, child: arm, axis: [0, -1, 0]}
springs:
  - name: balancer
    body_a: world
    p_a: [0, 0, 0.2]
    body_b: arm
    p_b: [0.15, 0, 0]
    stiffness: STIFFNESS N/m
    free_length: FREE mm
"""
CHECK_KEYS = {"mechanism", "coordinates", "exact", "certificate", "energy", "torque", "worst", "springs"}


@pytest.fixture
def pendulum(tmp_path):
    def write(stiffness: float = 196.2, free: float = 0.0) -> Path:
        path = tmp_path / "pendulum.yaml"
        path.write_text(PENDULUM.replace("STIFFNESS", str(stiffness)).replace("FREE", str(free)))
        return path

    return write


def test_check_exact(run, pendulum):
    code, out, _ = run("check", pendulum(), "--json")
    verdict = json.loads(out)
    assert code == 0
    assert set(verdict) >= CHECK_KEYS
    assert verdict["exact"] is True
    assert verdict["certificate"]["kind"] == "fourier"
    assert verdict["torque"]["residual"]["max"][0] < 1e-12
    assert verdict["torque"]["unbalanced"]["max"][0] == pytest.approx(5.886, rel=1e-9)


def test_check_soft_spring(run, pendulum):
    code, out, _ = run("check", pendulum(0.99 * 196.2), "--json")
    verdict = json.loads(out)
    assert code == 1
    assert verdict["exact"] is False
    assert verdict["torque"]["residual"]["max"][0] == pytest.approx(0.05886, rel=1e-6)
    assert verdict["torque"]["bound"][0] == pytest.approx(0.05886, rel=1e-6)


def test_check_free_length(run, pendulum):
    code, out, _ = run("check", pendulum(free=25), "--json")
    verdict = json.loads(out)
    assert code == 1
    assert verdict["certificate"]["kind"] == "sampled"
    assert "free length" in verdict["certificate"]["reason"]
    assert verdict["torque"]["bound"] == [None]
    assert verdict["torque"]["residual"]["max"][0] / 5.886 == pytest.approx(0.125, abs=5e-5)


@pytest.mark.parametrize(
    ("tolerance", "code"), [("1e-3", 1), ("0.011", 0), ("0.5%", 1), ("1.1%", 0), ("0.05 N m", 1), ("60 N*mm", 0)]
)
def test_check_tolerance(run, pendulum, tolerance, code):
    found, out, _ = run("check", pendulum(0.99 * 196.2), "--tolerance", tolerance)
    assert found == code
    assert f"{'within' if code == 0 else 'not within'} the tolerance of {tolerance}" in out


@pytest.mark.parametrize("tolerance", ["-1", "0", "five", "3 kg", "nan"])
def test_check_bad_tolerance(run, pendulum, tolerance):
    code, out, err = run("check", pendulum(), "--tolerance", tolerance)
    assert (code, out) == (2, "")
    assert "--tolerance" in err


def test_check_text_has_units_and_the_verdict(run, pendulum):
    code, out, _ = run("check", pendulum())
    assert code == 0
    for text in ("EXACT: balanced in every pose", "equipoise hardware", "196.2 N/m", "5.8860", "N m", " J", "mm"):
        assert text in out


def test_methods(run):
    code, out, _ = run("methods", ROBOTS / "ur5.urdf", "--json")
    assert code == 0
    rows = {row["method"]: row for row in json.loads(out)}
    assert set(rows) == set(METHODS)
    assert (rows["convex"]["applies"], rows["convex"]["reasons"]) == (True, [])
    assert run("methods", ROBOTS / "ur5.urdf")[0] == 0


def test_design_writes_a_mechanism_file_that_check_proves(run, tmp_path):
    arm = tmp_path / "arm.yaml"
    eq.save(lee_chen(), arm)
    out_file, plot = tmp_path / "balanced.yaml", tmp_path / "balanced.svg"
    code, out, err = run("design", arm, "--span", 3, "--radius", "200mm", "-o", out_file, "--plot", plot, "--json")
    answer = json.loads(out)
    assert code == 0
    assert set(answer) >= {"method", "certified_gap", "bound", "free_parameters", "balance"}
    assert set(answer["balance"]) >= CHECK_KEYS
    assert answer["balance"]["exact"] is True
    assert f"wrote {out_file}" in err
    assert "<svg" in plot.read_text()
    code, out, _ = run("check", out_file, "--json")
    assert code == 0
    assert json.loads(out) == answer["balance"]


def test_design_text_names_bound_gap_and_infeasibility(run, tmp_path):
    arm = tmp_path / "arm.yaml"
    eq.save(lee_chen(), arm)
    pairs = "world:link2,world:link3,link2:link3,link2:link4,link3:link4"
    code, out, _ = run("design", arm, "--pairs", pairs, "--radius", "0.3", "--springs", "2", "--front")
    assert code == 0
    for text in (
        "bound",
        "so these are the best possible",
        "infeasible with springs on world:link2",
        "world:link4",
        "of unbalanced",
    ):
        assert text in out
    code, out, err = run("design", arm, "--pairs", pairs, "--radius", "0.3", "--exact", "-o", tmp_path / "no.yaml")
    assert (code, out) == (1, "")
    assert err.startswith("error: exact balance is infeasible")
    assert not (tmp_path / "no.yaml").exists()


def test_design_set_and_regions(run, tmp_path):
    arm = tmp_path / "arm.yaml"
    eq.save(lee_chen(), arm)
    code, out, _ = run(
        "design",
        arm,
        "--set",
        "span=3",
        "--set",
        "radius=0.1",
        "--set",
        "springs=1",
        "--region",
        "link4=50mm",
        "--json",
    )
    options = json.loads(out)["free_parameters"]
    assert code == 0
    assert (options["span"], options["springs"]) == (3, 1)
    assert options["regions"]["link4"]["half"] == [0.05] * 3
    assert options["regions"]["link3"]["half"] == [0.1] * 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--method", "convx"], "did you mean 'convex'"),
        (["--pairs", "world-link2"], "expected A:B"),
        (["--pairs", "world:lnk2"], "did you mean 'link2'"),
        (["--radius", "3 kg"], "length"),
        (["--radius", "-1"], "more than 0 m"),
        (["--region", "link2"], "BODY=RADIUS"),
        (["--region", "lnk2=0.1"], "did you mean 'link2'"),
        (["--region", "link2=0"], "more than 0 m"),
        (["--set", "spam=3"], "no parameter"),
        (["--set", "span"], "NAME=VALUE"),
        (["--set", "span=x"], "whole number"),
        (["--set", "span=0"], "span"),
        (["--span", "1", "--set", "span=3"], "--span and --set span both give 'span'"),
        (["--set", "span=1", "--set", "span=3"], "--set.span: is given twice, the second time by 'span=3'"),
        (["--set", "weights.joint9=2"], "no independent joint 'joint9'"),
        (["--springs", "0"], "springs"),
        (["--objective", "min"], "unknown objective"),
        (["--plot", "picture.gif"], ".svg"),
        (["-o", "missing/folder/x.yaml"], "no such file or folder"),
        (["-o", "design.txt"], ".yaml"),
    ],
)
def test_design_bad_options(run, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    eq.save(lee_chen(), tmp_path / "arm.yaml")
    code, out, err = run("design", "arm.yaml", *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert [path.name for path in tmp_path.iterdir()] == ["arm.yaml"]


@pytest.mark.parametrize(
    "arguments", [["check"], ["design", "-o", "out.yaml"], ["export", "--to", "yaml", "-o", "out.yaml"]]
)
def test_a_broken_file_is_one_clear_error(run, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.yaml").write_text(PENDULUM.replace("STIFFNESS", "2 kg").replace("FREE", "0"))
    code, out, err = run(arguments[0], "broken.yaml", *arguments[1:])
    assert (code, out) == (2, "")
    assert "broken.yaml:13" in err
    assert "stiffness" in err
    assert [path.name for path in tmp_path.iterdir()] == ["broken.yaml"]


def test_missing_file_and_wrong_suffix(run, tmp_path):
    assert run("check", tmp_path / "no.yaml")[0] == 2
    (tmp_path / "robot.step").write_text("x")
    code, _, err = run("check", tmp_path / "robot.step")
    assert code == 2
    assert ".urdf" in err


@pytest.mark.parametrize("to", ["yaml", "urdf", "mjcf"])
def test_export(run, pendulum, tmp_path, to):
    code, out, err = run("export", pendulum(), "--to", to)
    assert code == 0
    target = tmp_path / "out.txt"
    assert run("export", pendulum(), "--to", to, "-o", target)[0] == 0
    assert target.read_text() == out
    assert ("springs" in err) == (to == "urdf")  # what URDF cannot hold is said
    if to == "mjcf":
        assert 'springlength="0 0"' in out


def test_export_unknown_format(run, pendulum):
    code, out, err = run("export", pendulum(), "--to", "sdf")
    assert (code, out) == (2, "")
    assert "urdf" in err


def test_demo_end_to_end(run, tmp_path):
    code, out, _ = run("demo", "-o", tmp_path / "demo")
    assert code == 0
    assert "EXACT" in out
    assert "so these are the best possible" in out
    assert {path.name for path in (tmp_path / "demo").iterdir()} == {
        "ur5-balanced.yaml",
        "ur5-balanced.svg",
        "ur5-balanced.png",
    }
    assert run("check", tmp_path / "demo" / "ur5-balanced.yaml")[0] == 0


def test_an_internal_error_is_one_line(run, pendulum, monkeypatch):
    monkeypatch.setattr("equipoise.balance.sample", lambda *_: 1 / 0)
    monkeypatch.delenv("EQUIPOISE_DEBUG", raising=False)
    code, _, err = run("check", pendulum())
    assert code == 2
    assert "internal error: ZeroDivisionError" in err


def test_help_of_every_command_has_an_example(run):
    for command in ("check", "methods", "design", "layouts", "export", "report", "reproduce", "demo"):
        code, out, _ = run(command, "--help")
        assert code == 0
        assert "Example:" in out


def test_importing_the_package_imports_nothing_heavy():
    heavy = ("numpy", "scipy", "pydantic", "pint", "clarabel", "matplotlib", "mujoco", "typer", "ruamel")
    code = f"import sys, equipoise; print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_a_verdict_waits_for_no_solver_and_no_rare_unit(pendulum):
    heavy = ("scipy", "numba", "pint", "clarabel", "rich.progress", "equipoise.synthesis")
    code = f"""
import atexit, runpy, sys
atexit.register(lambda: print([name for name in {heavy} if name in sys.modules]))
sys.argv = ["equipoise", "check", {str(pendulum())!r}, "--samples", "100"]
runpy.run_module("equipoise", run_name="__main__")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "EXACT" in done.stdout
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_torque_as_tolerance_needs_joints_that_turn(run, tmp_path):
    path = tmp_path / "lift.yaml"
    path.write_text(
        "schema: 1\nname: lift\nbodies: [{name: cage, mass: 2}]\n"
        "joints: [{name: slide, type: prismatic, parent: world, child: cage, axis: [0, 0, 1], range: [0, 1]}]\n"
    )
    code, _, err = run("check", path, "--tolerance", "30 N m")
    assert code == 2
    assert "sliding" in err
    assert run("check", path, "--tolerance", "2")[0] == 0


def test_export_into_a_pipe():
    command = f"{sys.executable} -m equipoise export {ROBOTS / 'ur5.urdf'} --to yaml -o /dev/stdout | head -1"
    shell = ["bash", "-o", "pipefail", "-c", command]
    assert subprocess.run(shell, capture_output=True, text=True).stdout == "schema: 1\n"


def test_a_full_disk_is_one_line(pendulum):
    command = [sys.executable, "-m", "equipoise", "check", str(pendulum())]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr == "error: no space left on device\n"


@pytest.mark.parametrize("name", ["\\e[31mred", "two\\nlines", "\\ud800"])
def test_names_that_would_reach_the_terminal_are_refused(run, tmp_path, name):
    path = tmp_path / "name.yaml"
    path.write_text(f'schema: 1\nname: "{name}"\nbodies: []\n')
    code, _, err = run("check", path)
    assert code == 2
    assert "cannot be printed" in err or "not" in err
    assert "\x1b" not in err


# The DELTA -----------------------------------------------------------------------------------------------------------

DELTA = Path(__file__).parents[1] / "examples" / "mechanisms" / "delta.yaml"


def test_methods_know_which_robots_are_deltas(run):
    rows = {row["method"]: row for row in json.loads(run("methods", DELTA, "--json")[1])}
    assert rows["delta"]["applies"] is True
    assert rows["convex"]["applies"] is True
    assert rows["pseudobase"]["applies"] is False
    rows = {row["method"]: row for row in json.loads(run("methods", ROBOTS / "ur5.urdf", "--json")[1])}
    assert rows["delta"]["applies"] is False
    assert "no loops" in rows["delta"]["reasons"][0]


@pytest.mark.slow(reason="the whole DELTA method with its guide")
def test_design_delta_full(run, tmp_path):
    out_file = tmp_path / "balanced.yaml"
    options = ("--set", "BF=120mm", "--set", "CS=100mm", "--set", "spring_7=1.8kg", "--set", "share_7=60%")
    code, out, _ = run("design", DELTA, "--method", "delta", *options, "-o", out_file, "--json")
    assert code == 0
    answer = json.loads(out)
    assert answer["balance"]["exact"] is True
    assert answer["bound"] == 0
    assert answer["certified_gap"] < 1e-10
    free = answer["free_parameters"]
    assert (free["variant"], free["BF"], free["spring_7"], free["share_7"]) == ("full", 0.12, 1.8, 0.6)
    springs = eq.load(out_file).springs
    assert len(springs) == 9
    assert {spring.mass for spring in springs if spring.name.startswith("spring 7")} == {1.8}


@pytest.mark.slow(reason="searches a workspace")
def test_design_delta_optimum_prints_how_much_better_it_is(run):
    options = ("--set", "variant=optimum", "--set", "heights=0.5,800mm", "--set", "reach=5cm", "--set", "samples=200")
    code, out, _ = run("design", DELTA, "--method", "delta", *options, "--json")
    assert code == 0
    free = json.loads(out)["free_parameters"]
    assert free["heights"] == [0.5, 0.8]
    assert free["reach"] == 0.05
    assert free["times_better"] == pytest.approx(free["axis_formula_peak"] / free["residual_peak"])
    assert free["times_better"] > 1


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("variant=half", "unknown value 'half'"),
        ("BF=3kg", "--set BF"),
        ("BF=0", "BF: must be more than 0 m"),
        ("heights=0.8,0.5", "variant 'full' has no such option|must be two lengths|the smaller first"),
        ("samples=many", "expected a whole number"),
        ("share_7=a", "expected a share"),
        ("equation_10=perhaps", "unknown value"),
        ("BG=1", "no parameter 'BG'"),
        ("AV.leg=1", "is one value for the whole mechanism"),
    ],
)
def test_design_delta_refusals(run, setting, message):
    more = ("--set", "variant=axis") if "heights" in setting else ()
    code, out, err = run("design", DELTA, "--method", "delta", *more, "--set", setting)
    assert (code, out) == (2, "")
    assert re.search(message, err)


def test_design_delta_needs_a_delta(run, pendulum):
    code, out, err = run("design", pendulum(), "--method", "delta")
    assert (code, out) == (2, "")
    assert "method 'delta' does not apply to 'one-link arm': it has no loops" in err.replace("\n", " ")


def test_check_reports_mobility_and_what_cannot_be_assembled(run, tmp_path):
    lamp = DELTA.with_name("desk_lamp.yaml")
    code, out, _ = run("check", lamp, "--json", "--samples", 50)
    assert code == 0
    assert json.loads(out)["mobility"] == {"gruebler": -4, "numerical": 2, "redundant": 6}
    assert json.loads(out)["coordinates"] == ["base", "middle"]
    broken = tmp_path / "broken.yaml"
    eq.save(replace(eq.load(lamp), independent=("base",)), broken)
    code, out, err = run("check", broken)
    assert (code, out) == (2, "")
    assert "2 coordinates are independent, found 1: base" in err
