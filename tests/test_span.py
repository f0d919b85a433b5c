"""Exactness without a Fourier form: against means over grids of poses, the Fourier form, and known answers."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import pairwise, product
from math import pi

import numpy as np
import pytest
from campaign import campaign
from exact_mechanisms import exact_mechanism, spoiled
from odd_mechanisms import drum
from random_mechanisms import random_mechanism, with_torsion
from zoo import PENDULUM_K, hinge, pendulum

from equipoise.energy import FourierEnergy, NoFourierForm, Potential, SpanEnergy
from equipoise.energy.certificate import proof_of
from equipoise.energy.exactness import EXACT
from equipoise.energy.span.nodes import reach
from equipoise.kinematics import Tree
from equipoise.model.elements import Spring
from equipoise.model.mechanism import Body, Coupling, Joint, Mechanism, PointMass

GRID = 6  # poses a turn: exact means of what has frequencies below that


def varies(m: Mechanism, turns: int = 1, poses: int = GRID) -> float:
    """[J] over a regular grid, which gives the mean of a trigonometric polynomial exactly."""
    q = list(product(2 * pi * np.arange(poses * turns) / poses, repeat=len(m.coordinates)))
    return float(Potential(m)(np.array(q)).energy.std())


def each_mass(m: Mechanism) -> list[float]:
    """[J] what each mass alone makes the energy vary by."""
    lumps = [(body.name, body.mass, body.com) for body in m.bodies] + [(p.body, p.mass, p.position) for p in m.masses]
    lumps += [lump for spring in m.springs for lump in spring.lumps() if lump[0] != "world"]
    bare = replace(m.with_springs(()), bodies=tuple(replace(body, mass=0.0) for body in m.bodies))
    return [varies(bare.with_masses((PointMass("m", *lump),))) for lump in lumps]


@pytest.mark.parametrize("kinds", [("revolute",), ("revolute", "parallelogram", "fixed"), ("spherical",)])
def test_it_is_the_root_mean_square_over_all_poses(kinds: tuple[str, ...]) -> None:
    for seed in range(10):
        m = replace(random_mechanism(seed, 1 if "spherical" in kinds else 4, kinds, free_lengths=False), couplings=())
        if m.coordinates:
            distance = SpanEnergy(m).distance
            assert distance.varies == pytest.approx(varies(m), rel=1e-10, abs=1e-10)
            alone = float(np.linalg.norm(each_mass(m)))
            assert not alone or distance.scale == pytest.approx(alone, rel=1e-10)


def three(*terms: tuple[str, float]) -> Mechanism:
    """Three links in a row with two springs, the last joint coupled to others."""
    names = ("world", "a", "b", "c")
    joints = tuple(hinge(b, a, b, 0.3) for a, b in pairwise(names))
    springs = (
        Spring("s", "world", (0.0, 0.1, 0.3), "c", (0.2, 0.0, 0.1), 100.0),
        Spring("t", "a", (0.0, 0.0, 0.3), "c", (0.2, 0.0, -0.1), 70.0),
    )
    bodies = tuple(Body(name, 1.0, (0.2, 0.0, 0.05)) for name in names[1:])
    return Mechanism("three", bodies, joints, (Coupling("c", terms, 0.4),), springs=springs)


@pytest.mark.parametrize(
    ("terms", "turns"),
    [
        ((("a", 1.0),), 1),
        ((("a", -1.0), ("b", -1.0)), 1),
        ((("a", 2.0),), 1),
        ((("b", 0.5),), 2),
        ((("a", 0.5), ("b", -2.0)), 2),
    ],
)
def test_coupled_joints_turn_together(terms: tuple[tuple[str, float], ...], turns: int) -> None:
    """Whole and half ratios, sums, and a joint that drives one far from it."""
    assert SpanEnergy(three(*terms)).distance.varies == pytest.approx(varies(three(*terms), turns, 16), rel=1e-10)


def compared(m: Mechanism, max_terms: int = 20_000) -> bool:
    """Whether there was a Fourier form: then both give the same distance, and one verdict."""
    try:
        series = FourierEnergy(m, max_terms)
    except NoFourierForm:
        return False
    span = SpanEnergy(m).distance
    sure = 1e-12 + EXACT / 10 * span.scale  # rounding of what cancels
    assert span.varies == pytest.approx(float(np.linalg.norm(series.amplitude)), rel=1e-8, abs=sure)
    if span.relative >= 1e-9 or not EXACT / 100 < span.relative < EXACT * 100:
        assert span.exact == series.exact
    return True


@campaign(2000)
def test_it_agrees_with_the_fourier_form(seeds: range) -> None:
    """Slides, balls, parallelograms, couplings, torsion springs; and exact ones, off by any share from 1e-14 to 0.1."""
    verdicts, met = [], 0
    for seed in seeds:
        m = random_mechanism(seed, 5, free_lengths=False)
        met += compared(with_torsion(m, seed) if seed % 3 == 0 else m)
        exact = exact_mechanism(seed)
        off = 10 ** float(np.random.default_rng(seed).uniform(-14, -1))
        worse = spoiled(exact, seed, off) if exact.springs or exact.masses else exact
        met += compared(exact, 5000) + compared(worse, 5000)
        assert SpanEnergy(exact).exact
        verdicts.append(SpanEnergy(worse).exact)
    assert met > len(seeds)
    assert 0 < sum(verdicts) < len(verdicts)


def test_a_chain_of_forty_joints_in_no_time() -> None:
    """3^40 terms. What is a millionth off is seen, and the time grows with the length, not with the terms."""
    for seed in range(3):
        m = replace(exact_mechanism(seed, 40), couplings=())
        start = time.process_time()
        assert SpanEnergy(m).exact
        assert time.process_time() - start < 2  # 0.1 s on a quiet machine
        first = m.masses[-1]  # of the joints nearest to the ground, which carry the most
        assert not SpanEnergy(m.with_masses((*m.masses[:-1], replace(first, mass=first.mass * (1 + 1e-6))))).exact


def test_powers_and_exponentials_of_one_coordinate() -> None:
    for limits in (None, (-6.0, 4.0), (0.5, 0.7)):
        assert compared(drum(limits))
        assert not SpanEnergy(drum(limits)).exact


@pytest.mark.parametrize("scale", [1e-150, 1e-12, 1e12, 1e150])
def test_no_unit_is_in_it(scale: float) -> None:
    for k, exact in ((1.0, True), (1 + 1e-8, False)):
        m = pendulum(scale * k * PENDULUM_K)
        assert SpanEnergy(replace(m, bodies=(replace(m.bodies[0], mass=2 * scale),))).exact == exact
    long = pendulum((1 + 1e-5) * PENDULUM_K)
    longer = replace(
        long.with_springs(
            replace(s, p_a=(0, 0, 20), p_b=(15, 0, 0), stiffness=s.stiffness / 100) for s in long.springs
        ),
        bodies=(replace(long.bodies[0], com=(30, 0, 0)),),
    )
    assert SpanEnergy(longer).distance.relative == pytest.approx(SpanEnergy(long).distance.relative, rel=1e-9)


@pytest.mark.parametrize("k", [1e3, 1e6, 1e12])
def test_stiff_springs_that_cancel_hide_nothing(k: float) -> None:
    """Rounding that is left out counts as what it could be at most."""
    m = pendulum()
    ends = [Spring(name, "world", (0, 0, 0.2), "arm", (x, 0, 0), k) for name, x in (("up", 0.15), ("down", -0.15))]
    assert not SpanEnergy(m.with_springs(ends)).exact
    off = ends[0], replace(ends[1], stiffness=k * (1 + 1e-8))
    assert not SpanEnergy(m.with_springs((*m.springs, *off))).exact
    if k == 1e3:  # beyond, rounding may leave too much to call it exact
        assert SpanEnergy(m.with_springs((*m.springs, *ends))).exact


@pytest.mark.parametrize(("ends", "far"), [((-0.3, 0.5), 0.5), ((-0.7, 0.5), 0.7), ((0.0, 0.0), 1.0)])
def test_what_slides_counts_with_the_size_of_its_range(ends: tuple[float, float], far: float) -> None:
    rail = Joint("rail", "prismatic", "world", "cart", axis=(0, 0, 1), range=ends)
    assert reach(Tree.of(Mechanism("cart", (Body("cart", 1.0),), (rail,)))).tolist() == [far]


def test_what_has_no_proof() -> None:
    with pytest.raises(NoFourierForm, match="spring 'shoulder spring' has a free length"):
        _ = SpanEnergy(pendulum(free_length=0.1)).distance
    with pytest.raises(NoFourierForm, match="is not a fraction"):
        SpanEnergy(three(("a", float(np.sqrt(2)))))


def test_couplings_between_two_far_ends_are_refused_in_time() -> None:
    """Twenty joints that drive the twenty beyond them: every combination of frequencies is open at once."""
    names = ["world", *(f"b{i}" for i in range(40))]
    pairs = enumerate(pairwise(names))
    joints = tuple(replace(hinge(b, a, b, 0.2), rpy=(0.3, 0.1 * i, 0.2)) for i, (a, b) in pairs)
    couplings = tuple(Coupling(f"b{i + 20}", ((f"b{i}", 1.0),)) for i in range(20))
    m = Mechanism("far", tuple(Body(name, 1.0, (0.1, 0.0, 0.0)) for name in names[1:]), joints, couplings)
    with pytest.raises(NoFourierForm, match="far from each other"):
        _ = SpanEnergy(m).distance
    assert "far from each other" in (proof_of(m)[1] or "")
