"""The method `no-auxiliary`: exact on random arms with the fewest springs, the layouts, and what is refused and why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_mechanisms import random_chain
from robots import robot
from zoo import H1, H2, L1, M1, M2, G, exact_pendulum, lenzo_revolute, lenzo_spherical

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.model.errors import InfeasibleError, InputError, UnsupportedError
from equipoise.synthesis.arms.chain import chain
from equipoise.synthesis.no_auxiliary.from_ground import fewest_springs

LIFT = G * (M1 * H1 / L1 + M2)  # [N] k2 a2 of the arm of the zoo
BALL, ANY, HINGE = ("spherical",), ("spherical", "revolute"), ("revolute",)


def arm(h1: float = H1, h2: float = H2, off: float = 0.0) -> eq.Mechanism:
    """The paper's arm, mass centre 1 off the line by `off` [m]."""
    m = lenzo_spherical().mechanism
    bodies = (eq.Body("upper arm", M1, (h1, 0.0, off)), eq.Body("forearm", M2, (h2, 0.0, 0.0)))
    return replace(m.with_springs(()), bodies=bodies)


def balance(m: eq.Mechanism, **options):
    """Design by the method under test."""
    return eq.design(m, "no-auxiliary", **options)


def assert_exact(design) -> None:
    assert design.balance.exact
    assert design.balance.certificate.kind != "sampled"
    assert design.balance.residual.max.max() < 1e-10 * design.balance.unbalanced.max.max()


@settings(derandomize=True, deadline=None, max_examples=30)
@given(
    seed=st.integers(0, 10**6),
    links=st.integers(1, 4),
    on_line=st.booleans(),
    kinds=st.sampled_from([BALL, ANY, HINGE]),
)
def test_chains_of_any_length_from_the_ground(seed, links, on_line, kinds):
    m = random_chain(seed, links, kinds if links < 4 else HINGE, on_line)
    design = balance(m, layout="ground")
    assert_exact(design)
    springs = design.mechanism.springs
    assert len(springs) == fewest_springs(chain(m))
    assert {spring.body_a for spring in springs} == {"world"}
    assert ("fewest" in design.free_parameters) == all(joint.type != "revolute" for joint in m.joints)
    if on_line:
        assert len(springs) == links


@settings(derandomize=True, deadline=None, max_examples=30)
@given(
    seed=st.integers(0, 10**6),
    kinds=st.sampled_from([BALL, ANY, HINGE]),
    layout=st.sampled_from([None, "a", "b", "c", "d"]),
    on_line=st.booleans(),
)
def test_two_random_links(seed, kinds, layout, on_line):
    """By default as few springs as do; spring k1 lifts the sign conditions."""
    m = random_chain(seed, 2, kinds, on_line)
    design = balance(m, layout=layout, springs=None if layout is None else 3)
    assert_exact(design)
    found = design.free_parameters
    if layout is None:
        upper = chain(m).links[0]
        assert found["springs"] == len(design.mechanism.springs) == (3 if upper.off_line(chain(m).near) else 2)
    else:
        assert found["layout"] == layout
    assert all(spring.stiffness > 0 for spring in design.mechanism.springs)


@pytest.mark.parametrize("springs", [2, 3])
@pytest.mark.parametrize(
    ("layout", "a12", "past", "b2"), [("a", -1, -1, 1), ("b", 1, 1, 1), ("c", 1, -1, -1), ("d", -1, 1, -1)]
)
def test_layouts(layout, a12, past, b2, springs):
    """Fig. 5, all from one set of masses and lengths but for the sign of h2."""
    design = balance(arm(h2=b2 * H2), layout=layout, springs=springs, direction=(1, 0, 0))
    assert_exact(design)
    found = design.free_parameters
    assert [np.sign(found[name]) for name in ("a12", "b2", "a2")] == [a12, b2, 1]
    assert np.sign(found["b12"] - L1) == past
    if springs == 2:
        assert found["k2"] * found["a2"] == pytest.approx(LIFT)
        assert found["k2"] * found["a2"] * found["b2"] == pytest.approx(M2 * G * b2 * H2)
    else:
        rest = G * (M1 * H1 + M2 * L1) - found["k2"] * found["a2"] * L1
        assert found["k1"] * found["a1"] * found["b1"] == pytest.approx(rest)
    assert found["k2"] * found["b2"] * L1 == pytest.approx(found["k12"] * found["a12"] * (found["b12"] - L1))


def test_the_default_layout_follows_the_sign_of_h2():
    assert balance(arm()).free_parameters["layout"] == "b"
    assert balance(arm(h2=-H2)).free_parameters["layout"] == "c"  # behind the elbow, along -x
    assert balance(arm(), a12=-0.05).free_parameters["layout"] == "a"


def test_where_link_2_is():
    """A hand says which side is ahead; else the positive axis; else what is asked for."""
    m = arm(h2=-H2)
    hand = eq.Joint("wrist", "fixed", "forearm", "hand", (-0.3, 0, 0))
    handed = replace(m, bodies=(*m.bodies, eq.Body("hand")), joints=(*m.joints, hand))
    assert balance(handed).free_parameters["direction"] == pytest.approx([-1, 0, 0])
    assert balance(handed).free_parameters["layout"] == "b"
    assert balance(m, direction=(-2, 0, 0)).free_parameters["layout"] == "b"


@pytest.mark.parametrize("known", [lenzo_spherical, lenzo_revolute])
def test_golden_layout_b(known):
    """The springs of the zoo, written there from Eq. (15) by hand."""
    expected = known().mechanism
    design = balance(replace(expected, workspace=eq.Workspace(2000)), k2=400, a12=0.05, b12=0.36)
    assert design.balance.residual.max.max() < 1e-13
    assert_exact(design)
    for found, spring in zip(design.mechanism.springs, expected.springs, strict=True):
        assert (found.name, found.body_a, found.body_b) == (spring.name, spring.body_a, spring.body_b)
        assert found.stiffness == pytest.approx(spring.stiffness, rel=1e-12)
        np.testing.assert_allclose([*found.p_a, *found.p_b], [*spring.p_a, *spring.p_b], atol=1e-15)


@pytest.mark.parametrize(
    "given",
    [
        {"k2": 300},
        {"a2": 0.08},
        {"k12": 500, "a12": 0.04},
        {"k12": 500, "b12": 0.2},
        {"a12": -0.03, "b12": 0.1, "a2": 0.05},
        {"k12": 2000, "a12": 0.05, "b12": 0.36},  # all three fix k2
        {"k1": 100},
        {"k1": 100, "b1": 0.2, "k2": 200, "b2": 0.1},
        {"springs": 3, "a2": -0.1, "a12": 0.05},
        {"springs": 3, "k12": 2000, "a12": 0.05, "b12": 0.36, "b2": 0.05},
        {"layout": "ground", "k": 100, "height": 0.2},
        {"layout": "ground", "b": 0.03},
    ],
)
def test_what_is_given_is_kept(given):
    design = balance(arm(), **given)
    assert_exact(design)
    for name, value in given.items():
        expected = value if isinstance(value, str) else pytest.approx(value, rel=1e-12)
        assert design.free_parameters[name] == expected
    again = balance(arm(), **{**given, "layout": design.free_parameters["layout"]})
    assert again.mechanism.springs == design.mechanism.springs


@pytest.mark.parametrize(
    ("mechanism", "given", "message"),
    [
        (arm(), {"layout": "c"}, "layout c needs h2 < 0, .* k2 a2 b2 = m2 g h2 = 1.41264 N m"),
        (arm(), {"layout": "d"}, "layout d needs h2 < 0"),
        (arm(h2=-H2), {"layout": "a"}, "layout a needs h2 > 0"),
        (arm(h2=-H2), {"layout": "b"}, "layout b needs h2 > 0"),
        (arm(h2=0.0), {"layout": "c"}, "layout c needs h2 < 0: .* one spring balances it"),
        (arm(), {"a2": -0.05}, r"a2 > 0 is needed, found -50 mm: .* = 21.582 N \(15\) .* pulls the arm down"),
        (arm(), {"k2": 400, "a2": 0.06}, "must be 21.582 N, but it is 24 N with k2 = 400 N/m, a2 = 60 mm"),
        (arm(), {"b2": 0.08}, "b2 = m2 g h2 / .* must be 0.0654545 m, but it is 0.08 m"),
        (arm(), {"k2": 400, "k12": 2e3, "a12": 0.05, "b12": 0.36}, r"k12 a12 \(b12 - l1\) / .* = l1 must be 0.3 m"),
        (arm(), {"a12": 0.05, "b12": 0.2}, "b12 - l1 = -100 mm: the signs are not those of layout b .* or layout a"),
        (arm(), {"layout": "b", "a12": -0.05}, "a12 = -50 mm: the signs are not those of layout b"),
        (arm(), {"layout": "b", "b2": -0.05}, "b2 = -50 mm: the signs"),
        (arm(), {"b12": L1}, "b12 = l1 = 300 mm is the elbow itself"),
        (arm(off=0.02), {"springs": 2}, "needs? the mass centre of 'upper arm' on the line .* 20 mm off"),
        (arm(h1=-M2 * L1 / M1), {"springs": 2}, "the moment of 'upper arm' is zero, so that k2 a2 = 0"),
        (arm(), {"a1": -0.1, "b1": 0.1}, "change the sign of one of its lengths"),
        (arm(), {"springs": 3, "k2": LIFT / 0.1, "a2": 0.1}, "springs=2 does"),
        (arm(), {"layout": "ground", "k": 1, "b": 0.1, "height": 0.1}, "must be 1.41264 N m"),
    ],
)  # fmt: skip
def test_refused(mechanism, given, message):
    with pytest.raises(InfeasibleError, match=message):
        balance(mechanism, **given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"layout": "e"}, "no layout 'e'"),
        ({"k2": 0}, "k2: must be a finite number of more than 0"),
        ({"k2": -5}, "k2: must be a finite number of more than 0"),
        ({"a12": 0}, "a12: must be a finite number other than 0"),
        ({"b12": float("nan")}, "b12: must be a finite number"),
        ({"springs": 1}, "springs: must be 2 or 3"),
        ({"springs": 2, "k1": 10}, "k1: an arm with two springs has no such parameter"),
        ({"direction": (0, 0, 0)}, "direction: must be three numbers"),
        ({"k": 10}, "k: a layout of two links has no such parameter"),
        ({"layout": "ground", "a12": 0.1}, "a12: layout ground has no such parameter"),
        ({"layout": "ground", "share": {"forearm": 0.5}}, "share: no link that takes it"),
    ],
)
def test_bad_input(given, message):
    with pytest.raises(InputError, match=message):
        balance(arm(), **given)


def test_layouts_are_for_two_links():
    with pytest.raises(InputError, match="are for two links with a moment, and it has 3"):
        balance(random_chain(0, 3, HINGE), layout="b")
    with pytest.raises(UnsupportedError, match="it branches"):
        balance(robot("human"))


def test_a_counterweighted_upper_arm_turns_the_signs():
    """m1 h1 + m2 l1 < 0 needs a2 < 0, and b2 has the other sign than h2."""
    m = arm(h1=-0.3)
    found = balance(m)
    assert_exact(found)
    assert found.free_parameters["a2"] < 0
    assert found.free_parameters["layout"] == "c"
    with pytest.raises(InfeasibleError, match="a2 < 0 is needed, found 50 mm"):
        balance(m, a2=0.05)
    with pytest.raises(InfeasibleError, match="layout b needs h2 < 0"):
        balance(m, layout="b")


def test_a_balanced_upper_arm():
    m = arm(h1=-M2 * L1 / M1)
    for options in ({"springs": 3}, {"layout": "ground"}):
        assert_exact(balance(m, **options))


def test_one_link_needs_one_spring():
    """k a b = m g h, Eq. (7); a forearm without a moment is as good as none."""
    for m in (exact_pendulum().mechanism, arm(h2=0.0)):
        design = balance(m, height=0.2)
        assert_exact(design)
        assert len(design.mechanism.springs) == 1


def test_the_springs_stand_on_the_turret_where_it_carries_the_shoulder():
    m = lenzo_revolute().mechanism
    turret = replace(m.bodies[0], mass=3.0, com=(0.1, 0.0, 0.0))
    m = replace(
        m, bodies=(turret, *m.bodies[1:]), joints=(m.joints[0], replace(m.joints[1], xyz=(0.2, 0, 0)), *m.joints[2:])
    )
    design = balance(m)
    assert_exact(design)
    assert [spring.body_a for spring in design.mechanism.springs] == ["turret", "upper arm"]


@pytest.mark.parametrize(("name", "count"), [("ur5", 4), ("ur10", 4)])
def test_robots(name, count):
    design = balance(replace(robot(name), workspace=eq.Workspace(100)))
    assert_exact(design)
    assert len(design.mechanism.springs) == count


# The bound ----------------------------------------------------------------------------------------------------------


@settings(derandomize=True, deadline=None, max_examples=20)
@given(seed=st.integers(0, 10**6), links=st.integers(2, 3), on_line=st.booleans())
def test_the_proof_of_the_bound_in_numbers(seed, links, on_line):
    """V_i of the docstring, from the springs alone: row spaces orthogonal, [S_i, l_i] within, N the sum of ranks."""
    m = random_chain(seed, links, BALL, on_line)
    design, found = balance(m, layout="ground"), chain(m)
    springs = design.mechanism.springs
    tree = Tree.of(m)
    zero = tree.poses(np.zeros((1, tree.n)))
    V = []
    for i, link in enumerate(found.loaded):
        columns = []
        for spring in springs:
            j = next(j for j, other in enumerate(found.loaded) if other.body == spring.body_b)
            body = tree.index[spring.body_b]
            p = zero.p[0, body] + zero.R[0, body] @ spring.p_b - found.loaded[j].centre
            u = link.length if i < j else p if i == j else np.zeros(3)
            columns.append(np.sqrt(spring.stiffness) * np.array(u))
        V.append(np.column_stack(columns))
    ranks = [np.linalg.matrix_rank(v, 1e-9 * np.linalg.norm(v)) for v in V]
    for i, link in enumerate(found.loaded):
        for j in range(i):
            size = np.linalg.norm(V[i]) * np.linalg.norm(V[j])
            np.testing.assert_allclose(V[i] @ V[j].T / size, 0, atol=1e-12)
        if i + 1 < len(found.loaded):
            assert link.length is not None
            both = np.column_stack([V[i], link.moment, link.length])
            assert np.linalg.matrix_rank(both, 1e-9 * np.linalg.norm(both)) == ranks[i]
    assert sum(ranks) == len(springs) == fewest_springs(found)


@pytest.mark.parametrize(("off", "fewest"), [(0.0, 2), (0.05, 3)])
def test_fewer_springs_do_not_balance_links_that_turn_freely(off, fewest):
    """The convex method, from any body to any other, with large regions: exact with the bound's number, not below."""
    m = arm(off=off)
    m = replace(m, joints=(m.joints[0], replace(m.joints[1], type="spherical")))
    assert balance(m, layout="ground").free_parameters["fewest"] == fewest
    designs = {n: eq.design(m, "convex", span=2, radius=1.0, springs=n) for n in (fewest - 1, fewest)}
    assert not designs[fewest - 1].balance.exact
    assert designs[fewest - 1].residual > 1e-3 * designs[fewest].unbalanced
    assert designs[fewest].balance.exact


# The command line ---------------------------------------------------------------------------------------------------


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "arm.yaml"
    eq.save(arm(), path)
    return path


def test_command_line(run, file, tmp_path):
    out = tmp_path / "out.yaml"
    chosen = [part for text in ("layout=b", "k2=400 N/m", "a12=50mm", "b12=36cm") for part in ("--set", text)]
    code, text, _ = run("design", file, "--method", "no-auxiliary", *chosen, "-o", out)
    assert code == 0
    for shown in ("EXACT", "layout      b", "a2          0.053955 m", "k12         2618.18 N/m"):
        assert shown in text
    assert run("check", out)[0] == 0
    assert eq.load(out).provenance["method"] == "no-auxiliary"


@pytest.mark.parametrize(
    ("option", "code", "message"),
    [
        ("layout=c", 1, "layout c needs h2 < 0"),
        ("a2=-50mm", 1, "a2 > 0 is needed, found -50 mm"),
        ("layout=e", 2, "unknown value 'e'"),
        ("k2=5 kg", 2, "--set k2"),
        ("k2=-1", 2, "k2: must be a finite number of more than 0"),
        ("direction=1,2", 2, "direction: must be three numbers"),
    ],
)
def test_command_line_refuses(run, file, tmp_path, option, code, message):
    out = tmp_path / "out.yaml"
    found, text, error = run("design", file, "--method", "no-auxiliary", "--set", option, "-o", out)
    assert (found, text) == (code, "")
    assert message in error
    assert not out.exists()
