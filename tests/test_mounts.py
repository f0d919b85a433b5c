import pytest
from robots import planar_arm, robot

import equipoise as eq
from equipoise.synthesis.mounts import Mounts


def test_fixed_bodies_count_as_one_and_the_ground_is_what_carries_the_arm():
    mounts = Mounts.of(robot("ur5"))
    assert mounts.bodies[0] == "base_link"
    assert len(mounts.bodies) == 7  # ee_link, tool0 and base hang on fixed joints
    assert mounts.bodies[-1] == "wrist_3_link"


@pytest.mark.parametrize(("span", "count"), [(1, 6), (2, 11), (3, 15), (7, 21)])
def test_pairs_of_a_serial_arm(span, count):
    assert len(Mounts.of(robot("ur5")).pairs(span)) == count


def test_massless_bodies_between_the_axes_of_a_compound_joint_are_skipped():
    mounts = Mounts.of(robot("human"))
    assert not [name for name in mounts.bodies if "virtual" in name]
    assert mounts.apart(("middle_pelvis", "left_upperleg")) == 1
    assert mounts.apart(("left_upperleg", "right_upperleg")) == 2


def test_sizes_and_default_radius():
    arm = planar_arm([1, 1], [0.4, 0.3], [0.2, 0.15])
    mounts = Mounts.of(arm)
    assert mounts.bodies == ("world", "link2", "link3")
    assert mounts.size == pytest.approx((0.0, 0.4, 0.15))
    assert mounts.reach == pytest.approx(0.55)
    assert mounts.default_radius("link2") == pytest.approx(0.2)
    assert mounts.default_radius("world") == pytest.approx(0.055)


def test_a_payload_at_the_end_of_a_massless_link_makes_it_mountable():
    arm = eq.Mechanism(
        "payload",
        bodies=(eq.Body("rod"),),
        joints=(eq.Joint("hinge", "revolute", "world", "rod", axis=(0, 1, 0)),),
        masses=(eq.PointMass("load", "rod", 1.0, (0.5, 0, 0)),),
    )
    assert Mounts.of(arm).pairs(1) == (("world", "rod"),)
    assert Mounts.of(arm.with_masses(())).pairs(1) == ()
