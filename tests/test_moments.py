"""Mass moments: closed forms, the paper's Eqs. (24)-(25) as printed, and gravity's energy of random trees."""

from __future__ import annotations

import numpy as np
import pytest
from random_mechanisms import random_mechanism, random_poses
from robots import robot
from zoo import gantry, planar_two_link, vertical_slide

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.kinematics import Tree
from equipoise.reproduce.lin2010 import TABLE_2, arm
from equipoise.synthesis.arms.moments import moments, segments, slide_faults

UP = (0.0, 0.0, 1.0)
R = {2: (-0.4, 0, 0), 3: (0, 0, 0), 4: (0, 0.5, 0), 5: (0, 0, 0), 6: (0, 0, -0.27)}  # r_i of Table 2 [m]


def gripper(right: float = 0.1, axis: tuple[float, float, float] = (0, -1, 0)) -> eq.Mechanism:
    """A hinged hand with two fingers that move against each other."""
    return eq.Mechanism(
        "gripper",
        (eq.Body("hand", 1.0, (0.1, 0, 0)), eq.Body("left", 0.1), eq.Body("right", right)),
        (
            eq.Joint("wrist", "revolute", "world", "hand", axis=(0, -1, 0)),
            eq.Joint("open", "prismatic", "hand", "left", (0.2, 0, 0), axis=(0, 1, 0)),
            eq.Joint("other", "prismatic", "hand", "right", (0.2, 0, 0), axis=axis),
        ),
        couplings=(eq.Coupling("other", (("open", 1.0),), 0.01),),
    )


def test_two_links():
    """mu counts a link's own mass twice, by Eq. (7); mu sigma is the moment of all it carries."""
    _, upper, fore = moments(segments(planar_two_link().mechanism))
    assert (upper.mass, fore.mass) == pytest.approx((2 + 2 + 1.2, 1.2 + 1.2))
    np.testing.assert_allclose(upper.vector, (2 * 0.15 + 1.2 * 0.3, 0, 0))
    np.testing.assert_allclose(fore.vector, (1.2 * 0.12, 0, 0))
    np.testing.assert_allclose(fore.position, (0.12 / 2, 0, 0))


@pytest.mark.parametrize("seed", range(40))
def test_gravity_of_a_tree_is_the_sum_of_its_moments(seed):
    """Eq. (6): U = -sum g . R mu sigma + constant, on random trees with branches."""
    m = random_mechanism(seed, kinds=("revolute", "fixed", "spherical")).with_springs(())
    links = segments(m)
    tree, q = Tree.of(m), random_poses(m, 20)
    poses = tree.poses(q)
    g = np.array(m.gravity)
    parts = [-poses.R[:, tree.index[x.name]] @ y.vector @ g for x, y in zip(links, moments(links), strict=True)]
    found, expected = np.sum(parts, axis=0), Potential(m)(q).energy
    np.testing.assert_allclose(found - found[0], expected - expected[0], atol=1e-11)


def test_with_auxiliary_links_as_printed():
    """Eqs. (24) and (25) written out with r_i, s_i and c_i from O_i, on Table 2."""
    links = segments(arm())
    assert [link.name for link in links] == ["world", *(f"link {i}" for i in range(1, 7))]
    extra = {
        i: [
            (float(row.m_hat), np.array(row.s_hat, float) - links[i].origin),
            (float(row.m_base), np.array(row.c, float) - links[i].origin),
        ]
        for i, row in TABLE_2.items()
    }
    found = moments(links, extra)
    masses = {i: (float(row.m), float(row.m_hat), float(row.m_base)) for i, row in TABLE_2.items()}
    for i, row in TABLE_2.items():
        m, m_hat, m_base = masses[i]
        mu = m + m_hat + m_base + sum(sum(masses[j]) for j in range(i, 7))
        sigma = m * np.array(row.s, float) + m_hat * np.array(row.s_hat, float) + m_base * np.array(row.c, float)
        sigma = (sigma - sum(sum(masses[j]) for j in range(i, 7)) * np.array(R[i])) / mu
        assert found[i].mass == pytest.approx(mu)
        np.testing.assert_allclose(found[i].position, sigma, atol=1e-15)
        np.testing.assert_allclose(links[i].origin, R[i], atol=1e-15)


def test_what_gravity_does_no_work_on():
    links = {link.name: (link, moment) for link, moment in zip(*_robot("ur10"), strict=True)}
    assert [name for name, (link, _) in links.items() if link.upright] == ["base_link", "shoulder_link"]
    level = {"upper_arm_link", "forearm_link", "wrist_1_link"}
    assert level == {name for name, (link, _) in links.items() if link.level and not link.upright}
    wrist, moment = links["wrist_1_link"]  # its moment is along its own axis, which stays horizontal
    assert np.linalg.norm(moment.vector) > 0.1
    assert not wrist.works(moment.vector, 1.0)
    assert not links["wrist_3_link"][1].vector.any()


def _robot(name: str):
    links = segments(robot(name))
    return links, moments(links)


def test_fingers_that_balance_each_other_do_not_matter():
    m = gripper()
    links = segments(m)
    assert list(slide_faults(m, links)) == []
    assert len(links) == 2
    np.testing.assert_allclose(moments(links)[1].vector, (0.1 + 0.2 * 0.2, 0.1 * -0.01, 0), atol=1e-16)


@pytest.mark.parametrize(("m", "change"), [(gripper(0.2), "0.1"), (gripper(axis=(0, 1, 0)), "0.2")])
def test_fingers_that_do_not_are_named(m, change):
    (fault,) = slide_faults(m, segments(m))
    assert f"sliding 'open', 'other' changes the moment of link 'hand' by {change} kg m per m" in fault


def test_slides_of_upright_links():
    level, lift = gantry().mechanism, vertical_slide().mechanism
    assert list(slide_faults(level, segments(level))) == []
    assert "'lift'" in next(slide_faults(lift, segments(lift)))


def test_a_slide_that_lifts_an_arm():
    m = eq.Mechanism(
        "lifted arm",
        (eq.Body("carriage"), eq.Body("arm", 1.0, (0.2, 0, 0))),
        (
            eq.Joint("lift", "prismatic", "world", "carriage", axis=UP),
            eq.Joint("shoulder", "revolute", "carriage", "arm", axis=(0, 1, 0)),
        ),
    )
    (fault,) = slide_faults(m, segments(m))
    assert fault.startswith("joint 'lift' slides what turns beyond it, and not on the level")
