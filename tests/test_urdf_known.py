"""What a URDF holds beside what is read: named where it may act, skipped in silence where it cannot."""

from __future__ import annotations

import pytest
from test_urdf import TWO, joint, read

from equipoise.model.errors import EquipoiseWarning

NONE = "ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'"
M = "<link name='m'><inertial>{}</inertial></link>" + joint("fixed", name="m", child="m") + joint("fixed")

NOTES = {
    "mimic on a fixed joint": (
        joint("continuous", name="k", child="c") + "<link name='c'/>\n" + joint("fixed", "<mimic joint='k'/>"),
        "joint 'j' (line 4): <mimic> on a fixed joint is ignored",
    ),
    "mimic of a fixed joint": (
        joint("fixed", name="k", child="c") + "<link name='c'/>\n" + joint("continuous", "<mimic joint='k'/>"),
        "joint 'j' (line 4): it moves by itself, for <mimic> names a fixed joint, 'k'",
    ),
    "mimic of nothing": (
        joint("continuous", "<mimic joint='jj'/>"),
        "joint 'j' (line 3): it moves by itself, for <mimic> names no joint 'jj'; did you mean 'j'?",
    ),
    "no limit": (joint("revolute"), "joint 'j' (line 3): its limits are missing: read as unlimited"),
    "limit without bounds": (joint("prismatic", "\n<limit effort='1'/>"), "joint 'j' (line 4): its limits are missing"),
    "0 to 0": (joint("revolute", "<limit lower='0' upper='0'/>"), "its range is a single value, 0 to 0: read as"),
    "endless limits": (joint("revolute", "<limit lower='-1e16' upper='1e16'/>"),
                       "its limits are beyond all bounds: read as"),
    "no mass": (M.format(f"<inertia {NONE}/>"),
                "link 'm' (line 3): its mass is missing, and taken as 0 kg"),
    "mass without value": (
        M.format(f"<inertia {NONE}/>\n<mass/>"),
        "link 'm' (line 4): its mass is missing",
    ),
    "no inertia": (
        M.format("<mass value='1'/>"),
        "link 'm' (line 3): its inertia is missing: balance does not need it",
    ),
    "part of an inertia": (
        M.format("<mass value='1'/><inertia ixx='1' iyy='1' izz='1'/>"),
        "link 'm' (line 3), link 'm' (line 3), link 'm' (line 3): a part of its inertia is missing",
    ),
    "unknown element": (joint("fixed") + "\n<force_element name='f'/>",
                        "<force_element> in robot 'r' (line 4): it is unknown"),
    "unknown in a joint": (joint("fixed", "<spring stiffness='2'/>"), "<spring> in joint 'j' (line 3): it is unknown"),
    "unknown attribute": (joint("continuous", "<dynamics damping='0' K='7000'/>"),
                          "K of <dynamics> (line 3): it is unknown"),
    "no gravity": (joint("fixed") + "<gazebo reference='b'><turnGravityOff>true</turnGravityOff></gazebo>",
                   "<turnGravityOff> of 'b' (line 3): gravity that is switched off is left out"),
    "no gravity, the new way": (joint("fixed") + "<gazebo reference='b'><gravity>0</gravity></gazebo>",
                                "<gravity> of 'b' (line 3): gravity that is switched off is left out"),
    "a simulator's loop": (joint("fixed") + "<gazebo><joint name='close'/></gazebo>",
                           "<joint> of 'close' (line 3): a simulator's joint is left out: write it as <loop_joint>"),
}  # fmt: skip


@pytest.mark.parametrize(("body", "message"), NOTES.values(), ids=NOTES.keys())
def test_what_is_read_otherwise_than_it_stands_there_is_said_once(body: str, message: str) -> None:
    with pytest.warns(EquipoiseWarning) as caught:
        read(TWO + body)
    assert len(caught) == 1
    assert message in str(caught[0].message)


def test_what_acts_on_nothing_is_skipped_in_silence() -> None:
    settings = (
        "<springStiffness>0</springStiffness><turnGravityOff>false</turnGravityOff><gravity>1</gravity><mu1>3</mu1>"
    )
    quiet_ones = "<plugin><joint name='x'/></plugin><material>Red</material>"
    read(TWO + joint("continuous", "<calibration/><safety_controller/>") + "<transmission/><material name='m'/>"
         + f"<gazebo reference='j'>{settings}{quiet_ones}</gazebo>")  # fmt: skip
