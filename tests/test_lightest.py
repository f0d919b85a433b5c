"""The least mass: closed forms, published-by-us numbers of real arms, and the front of mass against residual."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from robots import planar_arm, robot

import equipoise as eq
from equipoise.model.errors import InfeasibleError, InputError
from equipoise.synthesis.counterweights import Counterweights

ARM = planar_arm([1, 2], [0.4, 0.3], [0.2, 0.1])
LINK = replace(
    planar_arm([0.0], [0.5], [0.3]),
    masses=(eq.PointMass("shade", "link2", 0.15, (0.3, 0, 0)), eq.PointMass("arm", "link2", 0.04, (0.15, 0, 0))),
)


def weights(design: eq.Design) -> Counterweights:
    assert design.counterweights is not None
    return design.counterweights


def test_one_link_in_closed_form():
    """150 g at 300 mm and 40 g at 150 mm are held by 637.5 g at 80 mm."""
    design = eq.design(LINK, counterweights="80mm", springs=0)
    assert design.balance.exact
    assert weights(design).mass == pytest.approx(0.6375, rel=1e-5)
    assert weights(design).bound == pytest.approx(0.6375, rel=1e-6)
    (weight,) = weights(design).weights
    assert weight.position == pytest.approx((-0.08, 0, 0), abs=1e-6)
    assert design.mechanism.masses == (*LINK.masses, weight)


def test_less_mass_leaves_what_is_asked():
    """Of one link the mass falls with the residual in proportion."""
    design = eq.design(LINK, counterweights=0.08, springs=0, residual="20%", front=True)
    assert weights(design).mass == pytest.approx(0.8 * 0.6375, rel=1e-4)
    assert design.residual == pytest.approx(0.2 * design.unbalanced, rel=1e-4)
    for row in weights(design).front:
        wanted = (1 - row.residual / design.unbalanced) * 0.6375
        assert (row.bound, row.mass) == pytest.approx((wanted, wanted), abs=1e-5)


def test_a_spring_takes_what_it_can():
    """The forearm needs its 1 kg, whatever the springs on the upper arm; these need none."""
    pairs = [("world", "link2")]
    design = eq.design(ARM, pairs=pairs, radius=0.1, counterweights=0.2)
    assert design.balance.exact
    assert weights(design).mass == pytest.approx(1.0, rel=1e-4)
    assert [w.body for w in weights(design).weights] == ["link3"]
    assert len(design.mechanism.springs) == 1
    none = eq.design(ARM, span=2, radius=0.3, counterweights=0.2)
    assert weights(none).weights == ()
    assert none.balance.exact


def test_no_weights_and_springs_leave_less_at_random():
    """The bound against random weights of that mass, with the best of springs by another program."""
    design = eq.design(ARM, pairs=[("world", "link2")], radius=0.1, counterweights=0.2, residual="10%")
    rng = np.random.default_rng(1)
    for _ in range(8):
        shares = rng.dirichlet([1, 1]) * weights(design).bound * 0.98
        places = rng.normal(size=(2, 3))
        places *= 0.2 / np.linalg.norm(places, axis=1)[:, None]
        places[rng.integers(2)] = (-0.2, 0, 0)
        heavy = [
            eq.PointMass(f"w{i}", f"link{i + 2}", float(m), tuple(p.tolist()))
            for i, (m, p) in enumerate(zip(shares, places, strict=True))
        ]
        other = eq.design(ARM.with_masses(heavy), pairs=[("world", "link2")], radius=0.1)
        assert other.bound is not None
        assert other.bound > 0.1 * design.unbalanced


def test_out_of_reach():
    with pytest.raises(InfeasibleError, match=r"every choice leaves at least \d"):
        eq.design(ARM, pairs=[("world", "link2")], radius=0.1, counterweights={"link2": 0.2})
    with pytest.raises(InfeasibleError, match=r"5 % .*out of reach"):
        eq.design(ARM, pairs=[("world", "link2")], radius=0.1, counterweights={"link2": 0.2}, residual=0.05)
    with pytest.raises(InputError, match="counterweights too"):
        eq.design(ARM, residual=0.1)
    with pytest.raises(InputError, match="objective rms"):
        eq.design(ARM, residual=0.1, counterweights=0.2, objective="peak")


def arm(name: str, span: int, radius: float, distance: float) -> eq.Design:
    return eq.design(robot(name), span=span, radius=radius, unlimited=True, counterweights=distance)


def test_mass_against_residual_of_a_ur5():
    """Between neighbours alone: from what springs leave without weights to exact balance, the mass never falls."""
    design = eq.design(robot("ur5"), span=1, radius=0.15, unlimited=True, counterweights=0.3, front=True)
    rows = weights(design).front
    assert design.balance.exact
    assert weights(design).mass == pytest.approx(5.466, rel=1e-3)
    assert (rows[0].residual / design.unbalanced, rows[0].mass) == pytest.approx((0.4544, 0.0), abs=1e-4)
    assert (rows[-1].residual, rows[-1].mass) == pytest.approx((0.0, 5.466), abs=1e-3)
    assert all(a.mass < b.mass and a.residual > b.residual for a, b in pairwise(rows))
    assert all(row.mass == pytest.approx(row.bound, abs=1e-5) for row in rows)


@pytest.mark.slow(reason="three real arms, 3 s each")
@pytest.mark.parametrize(
    ("name", "span", "radius", "distance", "mass"),
    [("ur5", 2, 0.15, 0.3, 0.0593), ("xarm7", 3, 0.15, 0.3, 0.3886), ("ur10", 2, 0.2, 0.4, 0.0584)],
)
def test_real_arms(name, span, radius, distance, mass):
    design = arm(name, span, radius, distance)
    assert design.balance.exact
    assert weights(design).mass == pytest.approx(mass, rel=0.002)
    assert weights(design).mass >= weights(design).bound


def test_command_line(run, tmp_path):
    file, out = tmp_path / "link.yaml", tmp_path / "out.yaml"
    eq.save(LINK, file)
    code, text, _ = run("design", file, "--counterweights", "80mm", "--springs", "0", "-o", out)
    assert code == 0
    assert "637.5 g in all; bound 637.5 g" in text
    assert eq.check(eq.load(out)).exact
    given = ("--counterweights", "link2=80 mm", "--springs", "0", "--residual", "10%", "--front", "--json")
    code, text, _ = run("design", file, *given)
    answer = json.loads(text)["counterweights"]
    assert answer["mass"] == pytest.approx(0.9 * 0.6375, rel=1e-4)
    assert len(answer["front"]) > 5
    code, _, err = run("design", file, "--counterweights", "link2=80 mm, link2=1 mm")
    assert code == 2
    assert "each body once" in err
    eq.save(ARM, file)
    code, _, err = run("design", file, "--pairs", "world:link2", "--counterweights", "link2=200 mm", "--radius", "0.1")
    assert code == 1
    assert "leaves at least" in err
