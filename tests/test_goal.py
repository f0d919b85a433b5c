"""What a design is for, as a value and in a file: nothing is lost, and what is wrong is said with its line."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from robots import planar_arm, robot

import equipoise as eq
from equipoise.io import mjcf, urdf, yaml
from equipoise.model.errors import InputError
from equipoise.model.goal import Count, Goal, Gravity, Loads, Tool
from equipoise.model.motion import Box, Listed, Motion, Where

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
TOOL: Any = Tool  # texts with units and a single mass are read too
TILT: Any = "5 deg"
TOOLS = (TOOL("cup", "link3", ("0", "800 g"), (0.3, 0, 0), 3.0), TOOL("plate", "link3", 1.0))
FULL = Goal(Loads(TOOLS, (Gravity((0, 0, -9.81)), Gravity((9.81, 0, 0), 2.0)), TILT),
            count=Count("peak", {"joint2": 2.0}, ("joint2", "joint3"), "effort"))  # fmt: skip


CYCLE = Motion(("joint2", "joint3"), (0, 1, 2.5), ((0, 0.1), (1, 0.3), (0, 0.1)), stops=True, share=2.0)
WHERES = [
    Where((CYCLE, Motion(("joint3",), (0, 1, 2), ((0,), (1,), (0.5,))))),
    Where(listed=Listed(("joint2",), ((0.5,), (1.0,)), (1.0, 3.0))),
    Where(box=Box("link3", (0, -1, 0), (0.5, 1, 0.5), (0.3, 0, 0)), samples=200, seed=4),
    Where(whole_turns=True),
]


@pytest.mark.parametrize("where", WHERES)
def test_a_file_loses_no_pose(tmp_path, where):
    arm = replace(ARM, goal=Goal(poses=where))
    eq.save(arm, tmp_path / "arm.yaml")
    assert eq.load(tmp_path / "arm.yaml") == arm


def test_motions_and_poses_come_from_tables(tmp_path):
    (tmp_path / "arm.yaml").write_text(f"{FILE}  poses: {{motions: [{{file: pick.csv, stops: true}}, go.csv]}}\n")
    (tmp_path / "pick.csv").write_text("time [ms],shoulder [deg]\n0,0\n500,90\n")
    (tmp_path / "go.csv").write_text("time,shoulder\n0,0\n1,2\n2,0\n")
    pick, go = eq.load(tmp_path / "arm.yaml").goal.poses.motions
    assert pick == Motion(("shoulder",), (0, 0.5), ((0,), (np.pi / 2,)), stops=True)
    assert (go.cyclic, pick.cyclic) == (True, False)
    (tmp_path / "arm.yaml").write_text(f"{FILE}  poses: {{list: here.csv}}\n")
    (tmp_path / "here.csv").write_text("shoulder [deg],share\n0,1\n180,3\n")
    assert eq.load(tmp_path / "arm.yaml").goal.poses.listed == Listed(("shoulder",), ((0,), (np.pi,)), (1, 3))
    (tmp_path / "here.csv").write_text("shoulder [deg],share\n0,1\n180,x\n")
    with pytest.raises(InputError) as caught:
        eq.load(tmp_path / "arm.yaml")
    assert f"{tmp_path / 'arm.yaml'}:6:17: goal.poses.list: cannot be used" in str(caught.value)
    assert "here.csv:3: expected 2 numbers, found '180,x'" in str(caught.value)


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
        (
            "poses: {motion: {time: [0, 1], joints: {shoulder: [0, 1]}}}",
            "goal.poses.motion.time: a motion has at least 3",
        ),
        ("poses: {motion: no.csv}", "goal.poses.motion: cannot be used"),
        ("poses: {motion: {joint: 1}}", "goal.poses.motion.joint: unknown key 'joint'; did you mean 'joints'?"),
        ("poses: {list: {joints: {elbow: [0]}}}", "goal.poses.list: no coordinate 'elbow' (valid: shoulder)"),
        ("poses: {box: {body: arm, low: [0, 0, 1], high: [0, 0, 0]}}", "goal.poses.box.low: must be at most 'high'"),
        ("poses: {box: {body: hand, low: [0, 0, 0], high: [0, 0, 0]}}", "goal.poses.box.body: there is no body 'hand'"),
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
