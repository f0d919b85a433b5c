"""`certify` and what it writes; the command line of it and of `verify`."""

from __future__ import annotations

import json
import subprocess
import sys
import warnings
from fractions import Fraction
from pathlib import Path

import pytest
from campaign import some
from certified import EXACT, bounded, certificate, document, mixed
from example_files import FOLDER
from peers import robot_files

import equipoise as eq
from equipoise.model.errors import EquipoiseWarning, NoFourierForm
from equipoise.proof.certificate import Refused
from equipoise.proof.statement import rounded

ALONE = Path(eq.__file__).parent / "proof" / "verify.py"


@pytest.mark.parametrize("name", EXACT)
def test_examples_are_proved_exact(name):
    found = document(name)
    assert eq.verify(found)
    assert all(0 <= float(x) < 1e-13 for x in found["claims"]["torque"]["at_most"].values())


def test_every_kind_of_joint_and_spring_is_covered():
    found = document("mixed")
    claim = found["claims"]["torque"]
    assert {*claim["within"]} == {"rail", "hinge"}
    assert eq.verify(found)
    balance = eq.check(mixed(), samples=500)
    peak = dict(zip(balance.coordinates, balance.residual.max, strict=True))
    assert all(peak[name] <= float(most) for name, most in claim["at_most"].items())


@pytest.mark.parametrize("name", ["pantograph", "four_bar"])
def test_loops_are_held_by_forces_across_them(name):
    """With relations between the joints, and with a force that shares the coupler's weight."""
    found = document(name)
    assert eq.verify(found) == ("closed",)
    assert float(found["claims"]["closed"]["energy"]) < 1e-12
    found["mechanism"]["masses"][0]["mass"] = "3/2"
    with pytest.raises(Refused, match="where the loops close"):
        eq.verify(found)


def test_the_bound_is_that_of_the_design():
    """The design reaches it, so the certificate cannot claim more; it claims nearly as much."""
    found = document("bounded")
    provenance = bounded().provenance
    least = float(found["claims"]["bound"]["at_least"])
    assert eq.verify(found) == ("torque", "bound", "fewest")
    assert 0.999 * provenance["bound"] < least <= provenance["residual"]
    assert least == pytest.approx(provenance["bound"], rel=1e-4)


def test_the_bound_covers_a_union_of_regions():
    arm, one = bounded(), eq.Region.box((0.1, 0.05, 0.0), (0.05, 0, 0))
    regions = {"fore": [one, eq.Region.ball(0.05, (0.1, 0, 0))]}
    pairs = [("world", "upper"), ("upper", "fore")]
    found = eq.design(arm, pairs=pairs, radius=0.1, regions=regions, springs=2).mechanism
    assert [one["shape"] for one in found.provenance["options"]["regions"]["fore"]] == ["box", "ball"]
    bound = eq.certify(found).claims["bound"]
    assert [pair["region_b"]["shape"] for pair in bound["pairs"]] == ["ball", "box", "ball"]
    assert float(bound["at_least"]) == pytest.approx(found.provenance["bound"], rel=1e-3)
    assert eq.verify(eq.certify(found))


def test_stiffer_springs_are_bounded_by_less():
    some = [float(eq.certify(bounded(), stiffness=k).claims["bound"]["at_least"]) for k in ("100 kN/m", "1e9 N/m")]
    assert some[0] > some[1] > 0.9 * some[0]


def test_claims_are_rounded_outward():
    x = Fraction(2, 3)
    assert Fraction(rounded(x, up=True)) > x > Fraction(rounded(x, up=False))
    assert rounded(x, up=True) == "6.66666667e-1"
    assert rounded(Fraction(0), up=True) == "0"


def test_what_has_no_finite_form_has_no_certificate():
    pendulum = eq.load(FOLDER / "pendulum.yaml")
    free = pendulum.with_springs(spring.changed(free_length=0.01) for spring in pendulum.springs)
    with pytest.raises(NoFourierForm, match="no finite sum"):
        eq.certify(free)


def test_a_problem_that_is_not_covered_is_left_out():
    pairs = [("world", "upper")]
    kept = eq.Problem.of(bounded(), pairs=pairs, keep=True)
    assert "springs that stay" in eq.certify(bounded(), problem=kept).left_out["bound"]


def test_what_is_left_out_is_said():
    assert "designed" in eq.certify(FOLDER / "pendulum.yaml").left_out["bound"]


def test_the_verifier_stands_alone(tmp_path):
    """As one file, in another folder, without site-packages."""
    copy, cert = tmp_path / "verify.py", tmp_path / "cert.json"
    copy.write_text(ALONE.read_text(encoding="utf-8"), encoding="utf-8")
    cert.write_text(certificate("bounded"), encoding="utf-8")
    asked = [sys.executable, "-I", "-S", str(copy), str(cert)]
    found = subprocess.run(asked, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert (found.returncode, found.stdout) == (0, "accepted: torque bound fewest\n"), found.stderr
    false = document("bounded")
    false["claims"]["fewest"]["springs"] = 7
    cert.write_text(json.dumps(false), encoding="utf-8")
    found = subprocess.run(asked, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert (found.returncode, found.stdout) == (1, "")
    assert found.stderr == "refused: 7 springs are not proved to be needed\n"


def test_command_line(run, tmp_path):
    cert = tmp_path / "cert.json"
    code, out, err = run("certify", FOLDER / "pendulum.yaml", "-o", cert)
    assert (code, err) == (0, f"wrote {cert}\n")
    assert "the torque is at most" in out
    assert "fewer than 1 springs cannot be exact" in " ".join(out.split())
    assert run("verify", cert)[:2] == (0, "accepted: torque, fewest\n")
    assert json.loads(run("verify", cert, "--json")[1]) == {
        "accepted": True, "claims": ["torque", "fewest"], "reason": None,
    }  # fmt: skip
    cert.write_text(cert.read_text().replace('"springs": 1', '"springs": 2'))
    code, out, _ = run("verify", cert)
    assert (code, out) == (1, "refused: 2 springs are not proved to be needed\n")
    code, out, _ = run("certify", FOLDER / "pendulum.yaml", "-o", cert, "--json")
    assert (code, [*json.loads(out)]) == (0, ["mechanism", "claims", "left_out"])


def test_the_answer_no(run, tmp_path):
    cert = tmp_path / "cert.json"
    code, _, err = run("certify", FOLDER / "telescope.yaml", "-o", cert)
    assert (code, err.startswith("no certificate: ")) == (1, True)
    assert not cert.exists()
    code, _, err = run("certify", FOLDER / "pendulum.yaml", "-o", cert, "--stiffness", "0")
    assert (code, "must be more than 0 N/m" in err) == (2, True)
    cert.write_text("{")
    assert run("verify", cert)[0] == 1
    assert run("verify", tmp_path / "none.json")[0] == 2
    with pytest.raises(Refused):
        eq.verify({})


ROBOTS = (
    "ur3_robot", "ur5_robot", "ur10_robot", "ur3_joint_limited_robot", "ur5_joint_limited_robot", "xarm7", "panda",
    "kinova", "so100", "so101", "z1", "talos_left_arm", "finger_edu", "double_pendulum", "double_pendulum_continuous",
    "solo", "solo12", "bolt", "hyq_no_sensors", "allegro_left_hand",
)  # fmt: skip


@pytest.mark.deep
@pytest.mark.parametrize("name", some(ROBOTS, here=["double_pendulum"]))
def test_designs_of_robots_are_certified(name):
    """Two springs between neighbours, whatever they leave: the torque is bounded, and more springs are needed."""
    (path,) = (path for path in robot_files("example-robot-data", ".urdf") if path.stem == name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EquipoiseWarning)
        mechanism = eq.load(path)
    design = eq.design(mechanism, span=1, springs=2, radius=0.15, unlimited=True)
    found = eq.certify(design.mechanism)
    assert eq.verify(found) == tuple(found.claims)
    assert "torque" in found.claims
