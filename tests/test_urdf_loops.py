"""<loop_joint> of URDF is a loop."""

from __future__ import annotations

from dataclasses import replace

import pytest
from test_urdf import TWO, faults, joint, quiet, read

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.kinematics.linkage import Linkage
from equipoise.model.mechanism import Loop

FOUR_BAR = """<link name="frame"/>
<link name="crank"><inertial><origin xyz=".16 0 .01"/><mass value="4.2"/></inertial></link>
<link name="coupler"><inertial><origin xyz=".12 0 .2"/><mass value="6.8"/></inertial></link>
<link name="rocker"><inertial><origin xyz=".12 0 0"/><mass value="1.8"/></inertial></link>
<joint name="drive" type="revolute"><parent link="frame"/><child link="crank"/><axis xyz="0 -1 0"/>
<limit lower="-.6" upper=".6"/></joint>
<joint name="pin" type="continuous"><parent link="crank"/><child link="coupler"/><origin xyz=".3 0 0"/>
<axis xyz="0 -1 0"/></joint>
<joint name="upper" type="continuous"><parent link="frame"/><child link="rocker"/><origin xyz=".05 0 .4"/>
<axis xyz="0 -1 0"/></joint>
<loop_joint name="close" type="{}"><link1 link="coupler" rpy="0 0 .5" xyz="0 0 .4"/>
<link2 link="rocker" rpy="0 0 .5" xyz=".25 0 0"/><axis xyz="0.479425538604203 0.8775825618903728 0"/></loop_joint>"""


@quiet
@pytest.mark.parametrize("kind", ["spherical", "revolute"])
def test_a_loop_joint_is_a_loop(kind: str) -> None:
    balance = eq.check(read(FOUR_BAR.format(kind)), samples=500)
    assert balance.coordinates == ("drive",)
    # the same four-bar in a mechanism file, by hand: a point loop between (0, 0, 0.4) and (0.25, 0, 0)
    joints = tuple(replace(j, range=None) if j.name != "drive" else j for j in read(FOUR_BAR.format(kind)).joints)
    by_hand = replace(
        read(FOUR_BAR.format(kind)), joints=joints, loops=(Loop("coupler", (0, 0, 0.4), "rocker", (0.25, 0, 0)),)
    )
    assert balance.unbalanced.max == pytest.approx(eq.check(by_hand, samples=500).unbalanced.max, rel=1e-6)
    assert balance.unbalanced.max == pytest.approx([29.158], abs=1e-3)


@quiet
def test_a_fixed_loop_joint_leaves_nothing_to_move() -> None:
    tree = Tree.of(read(FOUR_BAR.format("fixed")))  # a triangle: crank, ground, and coupler and rocker in one
    assert isinstance(tree, Linkage)
    assert (tree.coordinates, tree.mobility.numerical) == ((), 0)


@pytest.mark.parametrize(
    ("loop", "message"),
    [
        ("<loop_joint name='l' type='gear'><link1 link='a'/><link2 link='b'/></loop_joint>",
         "r.urdf:3: loop_joint 'l' is of no type that is known, 'gear'; valid: spherical"),
        ("<loop_joint name='l'><link1 link='a'/></loop_joint>", "loop_joint 'l' needs <link2 link='...'/>"),
        ("<loop_joint name='l'><link1 link='a' xyz='0 x 0'/><link2 link='b'/></loop_joint>",
         "needs 3 numbers as xyz, found '0 x 0'"),
        ("<loop_joint name='l'><link1 link='a'/><link2 link='c'/></loop_joint>", "there is no body 'c'"),
    ],
)  # fmt: skip
def test_bad_loop_joints(loop: str, message: str) -> None:
    assert message in "\n".join(faults(f"<robot name='r'>\n{TWO}{loop}{joint('continuous')}</robot>"))
