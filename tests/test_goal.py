"""What a design is for, as a value and in a file: nothing is lost, and what is wrong is said with its line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from robots import planar_arm, robot

import equipoise as eq
from equipoise.io import mjcf, urdf, yaml
from equipoise.model.errors import InputError
from equipoise.model.goal import Count, Goal, Gravity, Loads, Tool

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
TOOLS = (Tool("cup", "link3", ("0", "800 g"), (0.3, 0, 0), 3.0), Tool("plate", "link3", 1.0))
FULL = Goal(Loads(TOOLS, (Gravity((0, 0, -9.81)), Gravity((9.81, 0, 0), 2.0)), "5 deg"),
            Count("peak", {"joint2": 2.0}, ("joint2", "joint3"), "effort"))  # fmt: skip


@pytest.mark.parametrize("goal", [FULL, Goal(Loads(TOOLS)), Goal(count=Count(share_of="effort")), Goal()])
def test_a_file_loses_nothing(tmp_path, goal):
    arm = replace(ARM, goal=goal, joints=tuple(replace(j, effort=3.0) for j in ARM.joints))
    eq.save(arm, tmp_path / "arm.yaml")
    assert eq.load(tmp_path / "arm.yaml") == arm
    assert bool(goal) == ("goal:" in yaml.to_text(arm))


def test_values_are_si():
    assert FULL.loads.tools[0].payload == (0.0, 0.8)
    assert FULL.loads.tools[1].payload == (1.0, 1.0)
    assert FULL.loads.tilt == pytest.approx(np.radians(5))


FILE = """\
schema: 1
name: arm
bodies: [{name: arm, mass: 1, com: [0.3, 0, 0]}]
joints: [{name: shoulder, type: revolute, parent: world, child: arm, axis: [0, 1, 0], effort: 3 N m}]
goal:
"""


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("loads: [{name: cup, body: hand, payload: 1}]", "goal.loads[0].body: there is no body 'hand'"),
        ("loads: [{name: cup, body: arm, payload: [2, 1]}]", "goal.loads[0].payload: the smallest comes first"),
        ("loads: [{name: cup, body: arm}]", "goal.loads[0].payload: missing: a load needs it"),
        ("loads: [{name: a, body: arm, payload: 1, share: 0}]", "goal.loads[0].share: must be a finite number of more"),
        ("loads: [{name: a, body: arm, payload: 1, mass: 0}]", "goal.loads[0].mass: unknown key 'mass' (valid: name,"),
        ("gravity: [{vector: [0, 0]}]", "goal.gravity[0].vector: expected a list of 3 numbers"),
        ("tilt: 100 deg", "goal.tilt: must be at most a quarter turn"),
        ("count: {torque: mean}", "goal.count.torque: no torque that counts 'mean' (valid: rms, peak)"),
        ("count: {share_of: efort}", "goal.count.share_of: no share 'efort'; did you mean 'effort'?"),
        ("count: {joints: {sholder: 2}}", "there is no joint 'sholder'; did you mean 'shoulder'?"),
        ("load: 1", "goal.load: unknown key 'load'; did you mean 'loads'?"),
    ],
)
def test_what_is_wrong_is_said_at_its_line(tmp_path, line, message):
    path = tmp_path / "arm.yaml"
    path.write_text(f"{FILE}  {line}\n")
    with pytest.raises(InputError) as caught:
        eq.load(path)
    assert message in str(caught.value)
    assert f"{path}:6:" in str(caught.value)


@pytest.mark.filterwarnings("ignore:links with identical inertials")
def test_efforts_are_kept_from_urdf_and_mjcf(tmp_path):
    arm = robot("ur5")
    efforts = {j.name: j.effort for j in arm.joints if j.effort}
    assert efforts["elbow_joint"] == 150.0
    assert efforts["wrist_1_joint"] == 28.0
    for name, module in (("arm.urdf", urdf), ("arm.xml", mjcf)):
        (tmp_path / name).write_text(module.to_text(arm))
        again = eq.load(tmp_path / name)
        assert {j.name: j.effort for j in again.joints if j.effort} == efforts


def test_the_limits_of_actuators_are_efforts(tmp_path):
    (tmp_path / "arm.xml").write_text("""
<mujoco><worldbody><body name="a"><joint name="h" axis="0 1 0"/><geom size=".1"/>
<body name="b" pos="1 0 0"><joint name="k" axis="0 1 0" actuatorfrcrange="-3 3"/><geom size=".1"/>
<body name="c" pos="1 0 0"><joint name="l" axis="0 1 0"/><geom size=".1"/></body></body></body></worldbody>
<actuator><motor joint="h" gear="50" ctrlrange="-2 2"/><position joint="k" kp="10" forcerange="-7 7"/><motor joint="l"/>
</actuator></mujoco>""")
    assert [j.effort for j in eq.load(tmp_path / "arm.xml").joints] == [100.0, 3.0, None]


def test_a_motor_that_counts_is_known():
    with pytest.raises(InputError, match="share_of: needs the effort of joint2, joint3"):
        eq.design(ARM, radius=0.2, goal=Goal(count=Count(share_of="effort")))
    one = replace(ARM, joints=tuple(replace(j, effort=5.0) if j.name == "joint3" else j for j in ARM.joints))
    assert (
        eq.design(one, radius=0.2, springs=1, goal=Goal(count=Count(only=("joint3",), share_of="effort"))).residual < 1
    )
