"""The Fourier form against the reference, its bound, its verdict, and when there is none."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from odd_mechanisms import drum, turret
from random_mechanisms import random_mechanism, random_poses
from rewritten import in_another_world, relabelled, swapped_ends
from scipy.spatial.transform import Rotation
from zoo import EXACT, LIFT, PENDULUM_K, ZOO, geared_pair, hinge, pendulum, to_ground, vertical_slide

from equipoise.energy import FourierEnergy, NoFourierForm, Potential
from equipoise.kinematics import Tree
from equipoise.kinematics.sampling import bounds
from equipoise.model.elements import Spring
from equipoise.model.mechanism import Body, Coupling, Joint, Mechanism


def agrees(m: Mechanism, seed: int, max_terms: int = 20_000) -> bool:
    """Whether there was a form to compare: energy and torque as the reference's, to 1e-12 of their parts."""
    try:
        series = FourierEnergy(m, max_terms)
    except NoFourierForm:
        return False
    q = random_poses(m, 20, seed)
    state = Potential(m)(q)
    size = np.abs(state.gravity).max() + state.springs.sum(axis=1).max() + 1e-3
    np.testing.assert_allclose(series.energy(q), state.energy, rtol=0, atol=1e-12 * size)
    size += max(np.abs(part).max(initial=0) for part in (state.gravity_torque, state.spring_torque))
    np.testing.assert_allclose(series.torque(q), state.torque, rtol=0, atol=1e-12 * size)
    return True


def test_random_mechanisms() -> None:
    """Energy and torque: slides, balls, parallelograms, couplings with whole and fractional ratios."""
    met = {"prismatic": 0, "spherical": 0, "parallelogram": 0, "coupling": 0, "fraction": 0}
    for seed in range(350):
        m = random_mechanism(seed, 5, free_lengths=False)
        if agrees(m, seed):
            for kind in {joint.type for joint in m.joints} & met.keys():
                met[kind] += 1
            met["coupling"] += bool(m.couplings)
            met["fraction"] += any(ratio % 1 for coupling in m.couplings for _, ratio in coupling.terms)
    assert min(met.values()) > 15, met


@pytest.mark.slow(reason="150 mechanisms of eight joints")
def test_large_random_mechanisms() -> None:
    assert sum(agrees(random_mechanism(seed, 8, free_lengths=False), seed) for seed in range(1000, 1150)) > 100


@pytest.mark.parametrize("seed", range(100))
def test_the_bound_bounds(seed: int) -> None:
    """|tau_j| <= sum |k_j| |c_k|, anywhere within the joint ranges (a slide without one: +-1 m)."""
    m = random_mechanism(seed, 4, free_lengths=False)
    series = FourierEnergy(m)
    lower, upper = bounds(Tree.of(m))
    q = np.random.default_rng(seed).uniform(lower, upper, (2000, len(lower)))
    torque = np.abs(Potential(m)(q).torque).max(axis=0)
    assert (torque <= series.torque_bound() * (1 + 1e-12) + 1e-11).all()


def test_the_bound_is_reached_where_there_is_one_term() -> None:
    for m, bound in ((pendulum(0.5 * PENDULUM_K), 2.943), (vertical_slide().mechanism, 9.81)):
        np.testing.assert_allclose(FourierEnergy(m).torque_bound(), [bound], rtol=1e-14)


@pytest.mark.parametrize(("limits", "turn"), [(None, pi), ((-6.0, 4.0), 6.0), ((0.5, 0.7), 0.7)])
def test_an_angle_that_slides_something(limits: tuple[float, float] | None, turn: float) -> None:
    """The energy has powers of an angle: k s^2 / 2 with s = 0.1 q, so the torque is 0.01 k q, bounded by its range."""
    m = drum(limits)
    assert agrees(m, 0)
    series = FourierEnergy(m)
    np.testing.assert_allclose(series.torque_bound(), [0.981 * turn], rtol=1e-13)
    assert not series.exact


def test_a_rack_and_pinion() -> None:
    """A slide that turns a link: powers and exponentials of the same coordinate."""
    m = pendulum()
    rack = Joint("rack", "prismatic", "world", "rack", axis=(0.0, 0.0, 1.0))
    coupling = Coupling("shoulder", (("rack", 100 / 3),), 0.3)
    m = replace(m, bodies=(*m.bodies, Body("rack", 0.5)), joints=(*m.joints, rack), couplings=(coupling,))
    assert agrees(m, 0)
    series = FourierEnergy(m)
    assert not series.exact
    np.testing.assert_allclose(series.torque_bound(), [0.5 * 9.81], atol=1e-12)  # the link is balanced, the rack not


# The verdict ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ZOO)
def test_the_zoo(name: str) -> None:
    known = ZOO[name]()
    if not known.proved:
        with pytest.raises(NoFourierForm):
            FourierEnergy(known.mechanism)
        return
    series = FourierEnergy(known.mechanism)
    assert series.exact == known.exact
    if known.energy is not None:
        assert series.constant == pytest.approx(known.energy, rel=1e-13, abs=1e-13)


def spoiled(m: Mechanism) -> list[Mechanism]:
    """One spring, or where there is none one mass, off by 1e-8."""
    result = []
    for i, spring in enumerate(m.springs):
        worse = replace(spring, stiffness=spring.stiffness * (1 + 1e-8))
        result.append(m.with_springs((*m.springs[:i], worse, *m.springs[i + 1 :])))
    return result or [m.with_masses(replace(mass, mass=mass.mass * (1 + 1e-8)) for mass in m.masses)]


def disguises(m: Mechanism) -> list[Mechanism]:
    """The same mechanism, written differently, gravity off the axes, some bodies far from their frames."""
    rng = np.random.default_rng(5)
    result = [m, swapped_ends(m), in_another_world(m, Rotation.random(rng=rng).as_matrix(), rng.uniform(-9, 9, 3))]
    for body in m.bodies:
        result.append(relabelled(result[-1], body.name, rng))
    return result


@pytest.mark.parametrize("name", EXACT)
def test_exact_however_it_is_written_and_not_when_off_by_1e_8(name: str) -> None:
    for m in disguises(EXACT[name]().mechanism):
        assert FourierEnergy(m).exact
        for worse in spoiled(m):
            assert not FourierEnergy(worse).exact


def far_away(k: float) -> Mechanism:
    """The pendulum on a base that is bolted to another one 10,000 km away."""
    m = pendulum(k)
    return replace(
        m,
        bodies=(Body("here"), Body("there"), *m.bodies),
        joints=(
            Joint("bolt 1", "fixed", "world", "here"),
            Joint("bolt 2", "fixed", "here", "there", (1e7, 0.0, 0.0)),
            replace(m.joints[0], parent="there"),
        ),
        springs=(replace(m.springs[0], body_a="there"),),
    )


def test_weight_that_gravity_does_not_move_makes_nothing_exact() -> None:
    """What is compared with 1e-10 is what gravity does, not what there is of mass and distance."""
    assert FourierEnergy(far_away(PENDULUM_K)).exact
    assert not FourierEnergy(far_away(PENDULUM_K * (1 + 1e-8))).exact
    assert FourierEnergy(turret()).exact
    assert FourierEnergy(turret(rpy=(0.1, 0.2, 0.3))).exact  # gravity's work is rounding here, and is taken as none
    assert not FourierEnergy(turret(arm=1e-6)).exact
    weak = Spring("weak", "world", (1.0, 0.0, 0.0), "turret", (1.0, 0.0, 0.0), 1e-6)
    assert not FourierEnergy(turret(weak)).exact
    assert not FourierEnergy(turret(weak, rpy=(0.1, 0.2, 0.3))).exact


@pytest.mark.parametrize("scale", [1e-150, 1e-12, 1e-3, 1e3, 1e12, 1e150])
def test_the_verdict_does_not_depend_on_units(scale: float) -> None:
    """Masses and stiffnesses times any number."""
    for k, exact in ((1.0, True), (1 + 1e-8, False)):
        m = pendulum(scale * k * PENDULUM_K)
        assert FourierEnergy(replace(m, bodies=(replace(m.bodies[0], mass=2 * scale),))).exact == exact


@pytest.mark.parametrize("k", [1e3, 1e6, 1e12])
def test_stiff_springs_that_cancel_hide_nothing(k: float) -> None:
    """Two opposed springs, each far stiffer than the weight asks for: their difference counts."""
    ends = to_ground("up", "arm", 0.2, 0.15, k), to_ground("down", "arm", 0.2, -0.15, k)
    m = pendulum()
    assert not FourierEnergy(m.with_springs(ends)).exact
    assert not FourierEnergy(m.with_springs((*m.springs, ends[0], replace(ends[1], stiffness=k * (1 + 1e-8))))).exact
    if k == 1e3:  # beyond, rounding leaves too much to call it exact
        assert FourierEnergy(m.with_springs((*m.springs, *ends))).exact


def test_numbers_out_of_range_are_never_exact() -> None:
    m = pendulum()
    heavy = replace(m, bodies=(Body("arm", 1e308, (1e5, 0.0, 0.0)),))
    with np.errstate(over="ignore", invalid="ignore"):
        assert not FourierEnergy(heavy).exact
        assert not FourierEnergy(pendulum(1e308)).exact


def test_what_is_exact_has_no_torque_whatever_the_numbers() -> None:
    """Masses, stiffnesses and lengths over 28 orders of magnitude: exact is never said of what is not balanced."""
    exact = 0
    for seed in range(1200):
        m = random_mechanism(seed, 3, free_lengths=False)
        rng = np.random.default_rng(seed)

        def size(rng: np.random.Generator = rng) -> float:
            return 10 ** float(rng.uniform(-14, 14))

        if seed % 2:
            m = m.with_springs(())
        if seed % 3:
            m = replace(m, bodies=tuple(replace(body, mass=body.mass * size()) for body in m.bodies))
        if seed % 5:
            m = replace(m, joints=tuple(replace(j, xyz=tuple(x * size() for x in j.xyz)) for j in m.joints))  # type: ignore[arg-type]
        m = m.with_springs(replace(s, stiffness=s.stiffness * size()) for s in m.springs)
        try:
            series = FourierEnergy(m, 5000)
        except NoFourierForm:
            continue
        if series.exact:
            exact += 1
            state = Potential(m)(random_poses(m, 30, seed))
            parts = [np.abs(part).max(initial=0) for part in (state.gravity_torque, state.spring_torque)]
            # rounding aside: of weights whose lever arms turn about the vertical, or cancel
            weight = np.abs(state.gravity).max() + np.abs(state.springs).max(initial=0)
            assert np.abs(state.torque).max(initial=0) <= 1e-9 * max(parts) + 1e-12 * weight + 1e-30, seed
    assert exact > 100


@pytest.mark.parametrize("limits", [None, (-0.1, 0.1), (0.0, 1e-12), (0.0, 0.0), (10.0, 10.1)])
def test_a_slide_without_balance_is_not_exact_however_short(limits: tuple[float, float] | None) -> None:
    m = vertical_slide().mechanism
    spring = replace(m.springs[0], stiffness=1e-3)
    assert not FourierEnergy(replace(m, joints=(replace(m.joints[0], range=limits),), springs=(spring,))).exact
    assert not FourierEnergy(replace(m, joints=(replace(m.joints[0], range=limits),), springs=())).exact


def test_without_gravity_the_springs_are_compared_with_each_other() -> None:
    nothing = replace(pendulum().with_springs(()), gravity=(0.0, 0.0, 0.0))
    assert FourierEnergy(nothing).exact
    pair = to_ground("up", "arm", 0.2, 0.15, 100.0), to_ground("down", "arm", 0.2, -0.15, 100.0)
    assert not FourierEnergy(nothing.with_springs(pair[:1])).exact
    assert FourierEnergy(nothing.with_springs(pair)).exact
    assert not FourierEnergy(nothing.with_springs((pair[0], replace(pair[1], stiffness=100 * (1 + 1e-8))))).exact
    # a spring from the axis never changes its length, but for rounding
    tilted = replace(
        nothing, joints=(Joint("j", "revolute", "world", "arm", (0.1, 0.2, 0.3), (0.3, 0.2, 0.1), (1.0, 2.0, 3.0)),)
    )
    spring = Spring("s", "world", (0.1, 0.2, 0.3), "arm", (0.15, 0.1, -0.2), 100.0)
    assert FourierEnergy(tilted.with_springs((spring,))).exact


def test_nothing_to_move() -> None:
    spring = Spring("s", "world", (0.0, 0.0, 1.0), "a", (0.0, 0.0, 0.0), 5.0)
    fixed = Mechanism("m", (Body("a", 1.0),), (Joint("j", "fixed", "world", "a"),), springs=(spring,))
    for m, energy in ((Mechanism("m"), 0.0), (fixed, 2.5)):
        series = FourierEnergy(m)
        assert series.exact
        assert series.constant == energy
        assert series.torque_bound().shape == (0,)


# When there is none --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [sqrt(2), pi, 1 / 1001, 1 + 1e-12, 1e-10])
def test_ratios_that_are_no_fractions(ratio: float) -> None:
    with pytest.raises(NoFourierForm, match="is not a fraction"):
        FourierEnergy(geared_pair(ratio))


@pytest.mark.parametrize("ratio", [1 / 3, 0.1, 0.1 + 0.2, 22 / 7, 997 / 998, 1e3, -5 / 7])
def test_ratios_that_are_fractions(ratio: float) -> None:
    assert agrees(geared_pair(ratio, 0.3), 0)
    assert not FourierEnergy(geared_pair(ratio, 0.3)).exact


def gears(*ratios: float) -> Mechanism:
    """Links on the ground, all driven by the first joint."""
    names = [f"link {i}" for i in range(len(ratios) + 1)]
    return Mechanism(
        "gears",
        tuple(Body(name, 1.0, (0.3, 0.0, 0.0)) for name in names),
        tuple(hinge(name, "world", name) for name in names),
        tuple(Coupling(name, ((names[0], ratio),)) for name, ratio in zip(names[1:], ratios, strict=True)),
    )


def test_frequencies_that_no_integer_holds_are_refused() -> None:
    """Each ratio is a fraction, but the common denominator, or a sum of frequencies, is beyond 32 bits."""
    assert agrees(gears(1 / 997, 1 / 991), 0)
    for ratios in ((1 / 997, 1 / 991, 1 / 983, 1 / 977), (2.0**31,), (2.0**32,), (2.0**30, 2.0**30)):
        with pytest.raises(NoFourierForm, match="no common denominator"):
            FourierEnergy(gears(*ratios))
    # two joints of 2^31 in a row made a frequency of zero, and an unbalanced arm exact
    motor, a, b = hinge("motor", "world", "motor"), hinge("a", "world", "a"), hinge("b", "a", "b")
    couplings = Coupling("a", (("motor", 2.0**31),)), Coupling("b", (("motor", 2.0**31),))
    m = Mechanism("m", (Body("motor"), Body("a"), Body("b", 1.0, (0.3, 0.0, 0.0))), (motor, a, b), couplings)
    with pytest.raises(NoFourierForm, match="no common denominator"):
        FourierEnergy(m)
    overflowing = replace(m, couplings=(Coupling("a", (("motor", 1e200),)), Coupling("b", (("a", 1e200),))))
    with np.errstate(over="ignore"), pytest.raises(NoFourierForm, match="overflows"):
        FourierEnergy(overflowing)


def test_a_free_length() -> None:
    with pytest.raises(NoFourierForm, match="spring 'shoulder spring' has a free length"):
        FourierEnergy(pendulum(free_length=1e-300))


def test_too_many_terms() -> None:
    m = ZOO["lenzo_spherical"]().mechanism
    assert FourierEnergy(m).exact
    with pytest.raises(NoFourierForm, match="more than 20 terms"):
        FourierEnergy(m, 20)
    links = [f"b{i}" for i in range(25)]
    joints = [hinge(b, a, b, 0.1) for a, b in zip(["world", *links], links, strict=False)]
    long = Mechanism("m", tuple(Body(b, 1.0) for b in links), tuple(replace(j, axis=LIFT) for j in joints))
    turned = replace(long, joints=tuple(replace(j, rpy=(0.5, 0.1, 0.2)) for j in joints))
    with pytest.raises(NoFourierForm, match="more than 5,000 terms"):
        FourierEnergy(turned, 5000)
