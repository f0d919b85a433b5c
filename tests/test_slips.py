"""What looks like a slip is said once, whatever the mechanism; real robots and our own examples have none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from robots import robot

import equipoise as eq
from equipoise import io
from equipoise.model.elements import Spring, TorsionSpring
from equipoise.model.errors import SlipWarning
from equipoise.model.mechanism import Body, Joint, Loop, Mechanism, PointMass
from equipoise.model.slips import far, slips, twice, weightless

EXAMPLES = sorted(
    path for path in (Path(__file__).parents[1] / "examples").rglob("*.yaml") if path.parent.name != "studies"
)


def arm(**joint: object) -> Mechanism:
    """A shoulder and an elbow, 0.4 and 0.3 m."""
    bodies = (Body("upper", 2.0, (0.2, 0, 0)), Body("fore", 1.0, (0.15, 0, 0)))
    shoulder = replace(Joint("shoulder", "revolute", "world", "upper", (0, 0, 0.3), axis=(0, -1, 0)), **joint)
    elbow = Joint("elbow", "revolute", "upper", "fore", (0.4, 0, 0), axis=(0, -1, 0))
    return Mechanism("arm", bodies, (shoulder, elbow))


SLIPS = {
    "degrees in a range": (arm(range=(-90, 90)), "joint 'shoulder': the angles look like degrees"),
    "degrees beyond a turn": (arm(range=(0, 540)), "joint 'shoulder': the angles look like degrees"),
    "degrees in rpy": (arm(rpy=(0, 90, 0)), "joint 'shoulder': the angles look like degrees"),
    "one value": (arm(range=(0.5, 0.5)), "joint 'shoulder': its range is a single value, 0.5 rad: it does not move"),
    "a joint in mm": (arm(xyz=(0, 0, 300)), "joint 'shoulder': its length of 300 m is out of scale"),
    "a com in mm": (replace(arm(), bodies=(Body("upper", 2, (200, 0, 0)), arm().bodies[1])),
                    "body 'upper': its length"),
    "a spring in mm": (
        arm().with_springs([Spring("s", "world", (0, 0, 0.2), "upper", (150, 0, 0), 100)]),
        "spring 's': its length of 150 m"
    ),
    "a free length in mm": (
        arm().with_springs([Spring("s", "world", (0, 0, 0.2), "upper", (0.15, 0, 0), 100, 80)]),
        "spring 's': its length of 80"
    ),
    "a mass in mm": (arm().with_masses([PointMass("tool", "fore", 1, (0, 0, 300))]),
                     "mass 'tool': its length of 300 m"),
    "an end without mass": (
        replace(arm(), bodies=(arm().bodies[0], Body("fore"))),
        "body 'fore': it moves at the end of a chain, but has no mass"
    ),
    "no mass at all": (replace(arm(), bodies=(Body("upper"), Body("fore"))), "nothing that moves: it has no mass"),
    "no gravity": (replace(arm(), gravity=(0, 0, 0)), "gravity is 0 m/s^2: nothing has weight"),
    "another gravity": (replace(arm(), gravity=(0, 0, -981)), "gravity is 981 m/s^2"),
}  # fmt: skip


@pytest.mark.parametrize(("m", "message"), SLIPS.values(), ids=SLIPS.keys())
def test_a_slip_is_said_once(m, message):
    found = slips(m)
    assert len(found) == 1
    assert found[0].startswith(message)


MEANT = {
    "an arm": arm(range=(-2 * np.pi, 2 * np.pi)),
    "several turns": arm(range=(-4 * np.pi, 4 * np.pi)),
    "a link that a spring holds": replace(arm(), bodies=(arm().bodies[0], Body("fore"))).with_springs(
        [Spring("s", "world", (0, 0, 0.2), "fore", (0.1, 0, 0), 100)]
    ),
    "a link that a torsion spring holds": replace(arm(), bodies=(arm().bodies[0], Body("fore"))).with_springs(
        [TorsionSpring("s", (("elbow", 1.0),), 3.0)]
    ),
    "a link that a loop holds": replace(
        arm(), bodies=(arm().bodies[0], Body("fore")), loops=(Loop("fore", (0.3, 0, 0), "world", (0.3, 0, 0.3)),)
    ),
    "a mass on a massless link": replace(arm(), bodies=(Body("upper"), Body("fore"))).with_masses(
        [PointMass("tool", "fore", 1, (0.1, 0, 0))]
    ),
    "a massless frame on a link": replace(
        arm(), bodies=(*arm().bodies, Body("tip")), joints=(*arm().joints, Joint("flange", "fixed", "fore", "tip"))
    ),
    "one short offset": arm(xyz=(0, 0, 1e-4)),
    "nothing that moves": Mechanism("post", (Body("post"),), (Joint("foot", "fixed", "world", "post"),)),
}


@pytest.mark.parametrize("m", MEANT.values(), ids=MEANT.keys())
def test_what_is_meant_is_not_called_a_slip(m):
    assert slips(m) == []


@pytest.mark.parametrize("name", ["ur5", "ur10", "panda", "xarm7", "human"])
def test_robots_have_no_slips(name):
    assert slips(robot(name)) == []


@pytest.mark.filterwarnings("ignore::equipoise.model.errors.EquipoiseWarning")
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_have_no_slips(path):
    assert slips(io.read(path, None)) == []


def test_many_are_listed_in_one_message():
    joints = tuple(Joint(f"j{i}", "revolute", "world", f"b{i}", (0.1, 0, 0), range=(-90, 90)) for i in range(10))
    m = Mechanism("m", tuple(Body(f"b{i}", 1, (0.1, 0, 0)) for i in range(10)), joints)
    (message,) = slips(m)
    assert "joint 'j5' and 4 more: the angles look like degrees" in message


def test_weightless_is_what_moves_without_a_mass():
    foot = Joint("foot", "fixed", "world", "base")
    bare = replace(arm(), bodies=(Body("upper"), Body("fore"), Body("base", 5)), joints=(*arm().joints, foot))
    assert weightless(bare)
    assert not weightless(arm())
    spring = Spring("s", "world", (0, 0, 0.2), "upper", (0.15, 0, 0), 100, mass=0.1)
    assert not weightless(bare.with_springs([spring]))
    assert weightless(bare.with_springs([replace(spring, mass_split=1.0)]))  # all of it on the ground


def test_a_radius_far_beyond_the_reach():
    assert far(arm(), 0.5, "--radius") == []
    assert far(arm(), 150, "--radius")[0].startswith("--radius: 150 m is far beyond the mechanism")


def test_a_payload_that_stands_in_the_file():
    m = arm().with_masses([PointMass("tool", "fore", 1.5, (0.3, 0, 0))])
    assert twice(m, "fore", (0.3, 0, 0)) == ["mass 'tool' of the file, 1.5 kg, is where the payload is: both count"]
    assert twice(m, "fore", (0.1, 0, 0)) == twice(m, "upper", (0.3, 0, 0)) == []


def test_loading_warns(tmp_path):
    eq.save(arm(range=(-90, 90)), tmp_path / "arm.yaml")
    with pytest.warns(SlipWarning, match=r"arm.yaml: joint 'shoulder': the angles look like degrees"):
        eq.load(tmp_path / "arm.yaml")


# The command line ---------------------------------------------------------------------------------------------------


def test_strict_makes_bad_input_of_a_slip(run, tmp_path):
    path = tmp_path / "arm.yaml"
    eq.save(arm(range=(-90, 90)), path)
    code, out, err = run("check", path, "--samples", 50)
    assert code == 1  # as before
    assert "no springs: shoulder holds up to" in out
    assert err.count("warning:") == 1
    code, out, err = run("check", path, "--samples", 50, "--strict")
    assert (code, out) == (2, "")
    assert "1 warning, and --strict" in err
    eq.save(arm(), path)
    code, _, err = run("check", path, "--samples", 50, "--strict")
    assert (code, err) == (1, "")


def test_nothing_that_moves_has_a_mass(run, tmp_path):
    path = tmp_path / "arm.yaml"
    eq.save(replace(arm(), bodies=(Body("upper"), Body("fore"))), path)
    for command in ("check", "design", "methods", "hardware"):
        code, out, err = run(command, path)
        assert (code, out) == (2, "")
        assert "nothing that moves has a mass" in err
    assert run("export", path, "--to", "yaml")[0] == 0
    payload = ("--payload", "1,2", "--payload-on", "fore", "--payload-at", "0.3,0,0")
    assert run("check", path, "--samples", 50, *payload)[0] == 1


def test_a_payload_twice_and_a_radius_too_far_are_said(run, tmp_path):
    path = tmp_path / "arm.yaml"
    eq.save(arm().with_masses([PointMass("tool", "fore", 1.5, (0.3, 0, 0))]), path)
    payload = ("--payload", "1,2", "--payload-on", "fore", "--payload-at", "0.3,0,0")
    code, _, err = run("check", path, "--samples", 50, *payload)
    assert code == 1
    assert "mass 'tool' of the file, 1.5 kg, is where the payload is" in err
    assert run("check", path, "--samples", 50, "--strict", *payload)[0] == 2
    for options in (("--radius", "150"), ("--region", "fore=150")):
        code, out, err = run("design", path, "--strict", *options)
        assert (code, out) == (2, "")
        assert "150 m is far beyond the mechanism" in err


def test_an_option_holds_or_frees_the_base(run, tmp_path):
    path = tmp_path / "robot.urdf"
    inertial = '<inertial><origin xyz="0.2 0 0"/><mass value="1"/></inertial>'
    limit = '<axis xyz="0 1 0"/>'
    path.write_text(
        f"""<robot name="r"><link name="base"/><link name="trunk">{inertial}</link><link name="leg">{inertial}</link>
        <joint name="float" type="floating"><parent link="base"/><child link="trunk"/></joint>
        <joint name="hip" type="continuous"><parent link="trunk"/><child link="leg"/>{limit}</joint></robot>"""
    )
    code, _, err = run("check", path)
    assert code == 2
    assert "--base fixed" in err
    assert "hip" in run("check", path, "--base", "fixed", "--samples", 50)[1]
    assert "float.x" in run("check", path, "--base", "free", "--samples", 50)[1]
    code, _, err = run("check", path, "--base", "welded")
    assert code == 2
    assert "valid: fixed, free" in err


def test_a_base_in_the_world_is_freed(tmp_path):
    eq.save(arm(), tmp_path / "arm.yaml")
    shoulder, elbow = arm().joints
    joints = (Joint("foot", "fixed", "world", "base"), replace(shoulder, parent="base"), elbow)
    m = replace(arm(), bodies=(Body("base", 1), *arm().bodies), joints=joints)
    eq.save(m, tmp_path / "based.yaml")
    assert eq.load(tmp_path / "based.yaml", base="free").coordinates[:6] == tuple(
        f"foot{s}{letter}" for s in (" ", ".") for letter in "xyz"
    )
    assert eq.load(tmp_path / "arm.yaml", base="free").coordinates == ("shoulder", "elbow")  # nothing is fixed there
