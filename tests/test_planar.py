"""The method `planar`: exact for every layout of THEORY section 5, crooked arms, stock, limits; what it refuses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from campaign import some
from hypothesis import given, settings
from hypothesis import strategies as st
from planar_arms import crooked
from robots import lee_chen, planar_arm, robot

import equipoise as eq
from equipoise.model.errors import InfeasibleError, InputError, UnsupportedError
from equipoise.synthesis import METHODS
from equipoise.synthesis.planar.arm import PlanarArm
from equipoise.synthesis.planar.layouts import default_layout, example_arm, name

ARM = Path(__file__).parents[1] / "examples" / "mechanisms" / "lee_chen_arm.yaml"
OF_LENGTH = {  # links 2, 3, .. and the end link of Table 4
    3: planar_arm([0.848, 1.33], [0.18, 0.07], [0.09, 0.06]),
    4: lee_chen(),
    5: planar_arm([0.848, 0.848, 0.848, 1.33], [0.18, 0.18, 0.18, 0.07], [0.09, 0.09, 0.09, 0.06]),
}
THEORY_5 = [
    "13,13", "13,23",
    "13,14,14", "13,14,24", "12,14,24,34", "12,14,23,24",
    "13,14,15,15", "13,14,15,25", "12,14,15,23,25", "13,15,23,24,25", "13,15,24,25,34", "12,13,15,24,25",
]  # fmt: skip


@pytest.mark.parametrize("layout", THEORY_5)
def test_every_layout_is_exact(layout):
    n = max(int(pair[1]) for pair in layout.split(","))
    mechanism = OF_LENGTH[n]
    found = eq.design(mechanism, "planar", layout=layout.split(","))
    assert found.balance.exact
    assert found.balance.certificate.kind == "fourier"
    joined = PlanarArm.of(mechanism).installations(found.mechanism)
    assert sorted(f"{one.i}{one.k}" for one in joined) == sorted(layout.split(","))
    assert found.mechanism.with_springs(()).springs == ()


@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_mass_centres_off_the_line_need_no_more_springs(n):
    found = eq.design(crooked(n), "planar")
    assert found.balance.exact
    assert len(found.mechanism.springs) == n - 1


@pytest.mark.slow(reason="searches springs of six links")
def test_six_crooked_links():
    found = eq.design(crooked(6), "planar")
    assert found.balance.exact
    assert len(found.mechanism.springs) == 5


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10**6))
def test_random_arms(seed):
    """Any masses, lengths and mass centres, frames turned, a payload, gravity across."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    base = example_arm(n)
    masses, along, across = (rng.uniform(*limits, n - 1).tolist() for limits in ((0.3, 3), (0.05, 0.15), (-0.05, 0.05)))
    arm = replace(
        base,
        bodies=tuple(
            replace(b, mass=mass, com=(x, 0.1, z))
            for b, mass, x, z in zip(base.bodies, masses, along, across, strict=True)
        ),
        joints=tuple(replace(j, rpy=(0.0, float(rng.uniform(-1, 1)), 0.0)) for j in base.joints),
        masses=(eq.PointMass("payload", base.bodies[-1].name, 0.5, (0.15, 0.0, 0.02)),),
        gravity=(2.0, 3.0, -8.0),
    )
    assert eq.design(arm, "planar").balance.exact


SIX = {  # link lengths, masses and mass centres of arms whose layout the energy-weighted fits alone do not find
    "12,13,15,16,24,26": (
        [0.4966, 1.4904, 1.0904, 1.5927, 0.9637],
        [0.2825, 0.2815, 0.1288, 0.2609, 0.0637],
        [0.0945, 0.092, 0.0412, 0.1062, 0.0637],
    ),
    "12,13,14,16,25,26": (
        [0.6388, 1.7477, 0.3852, 1.0155, 0.6185],
        [0.1733, 0.2975, 0.2215, 0.2594, 0.0581],
        [0.0581, 0.1888, 0.1087, 0.0885, 0.0581],
    ),
}


@pytest.mark.slow(reason="solves layouts of six links")
@pytest.mark.parametrize("layout", SIX)
def test_a_feasible_layout_of_six_links_is_designed(layout):
    found = eq.design(planar_arm(*SIX[layout]), "planar", layout=layout.split(","))
    assert found.balance.exact


@pytest.mark.deep
@pytest.mark.parametrize("seed", some(range(4), here=(3,)))
def test_every_feasible_layout_is_designed_for_random_arms(seed):
    rng = np.random.default_rng(seed)
    for layout in THEORY_5:
        n = max(int(pair[1]) for pair in layout.split(","))
        lengths, shares = rng.uniform(0.1, 0.3, n - 1), rng.uniform(0.2, 0.8, n - 1)
        mechanism = planar_arm(rng.uniform(0.4, 2, n - 1).tolist(), lengths.tolist(), (shares * lengths).tolist())
        assert eq.design(mechanism, "planar", layout=layout.split(",")).balance.exact, layout


@pytest.mark.slow(reason="searches all starts for a design that there is not")
@pytest.mark.parametrize("limits", [None, (0.2, 2.0)])
def test_a_limit_on_elongation(limits):
    """Over the joints' ranges: a shorter limit is possible where they are short."""
    bare = lee_chen()
    longest = 0.5 if limits is None else 0.4
    m = replace(bare, joints=tuple(replace(joint, range=limits) for joint in bare.joints))
    free = max(use.path[1] for use in eq.design(m, "planar").balance.use)
    found = eq.design(m, "planar", longest=longest)
    assert found.balance.exact
    assert max(use.path[1] for use in found.balance.use) <= longest < free
    with pytest.raises(InfeasibleError, match=r"lengths of at most 0.05 m were found"):
        eq.design(m, "planar", longest=0.05)


def test_springs_are_exchanged():
    """Eq. (28a) makes 14 and 24 of two springs 14; (28b) finds none in a balanced arm, where the links between count
    nothing in one mix of the two (43)."""
    found = eq.design(lee_chen(), "planar", layout=["13", "14", "14"], exchange="14:lower")
    assert found.free_parameters["layout"] == ["13", "14", "24"]
    assert found.balance.exact
    with pytest.raises(InfeasibleError, match="no two springs have this effect"):
        eq.design(lee_chen(), "planar", layout=["13", "14", "14"], exchange="14:upper")
    for text in ("14:lower", "13:both", "14"):
        with pytest.raises(InputError, match="exchange: expected two springs of the layout and lower or upper"):
            eq.design(lee_chen(), "planar", exchange=text)


def test_stock_and_given_values():
    stock = [100.0, 150.0, 200.0, 300.0, 500.0]
    found = eq.design(lee_chen(), "planar", layout=["13", "14", "14"], stock=stock)
    assert found.balance.exact
    assert {spring.stiffness for spring in found.mechanism.springs} <= set(stock)
    given_ = eq.design(lee_chen(), "planar", stiffness={"13": 150.0}, a={"13": 0.05})
    assert given_.balance.exact
    assert given_.free_parameters["stiffness"]["13"] == pytest.approx(150.0)
    spring = given_.mechanism.springs[0]
    assert spring.stiffness == pytest.approx(150.0)
    assert spring.p_a == pytest.approx((0, 0, 0.05))


def test_the_papers_stiffnesses():
    """Table 5(a): k = 590, 78, 160 N/m are possible, also with the angles left to the method."""
    stiffness = {"13": 590.0, "14_1": 78.0, "14_2": 160.0}
    found = eq.design(lee_chen(), "planar", layout=["13", "14", "14"], stiffness=stiffness)
    assert found.balance.exact
    assert sorted(s.stiffness for s in found.mechanism.springs) == pytest.approx([78, 160, 590])


def test_limit():
    arm = PlanarArm.of(lee_chen())
    for limit in (0.1, 0.15, 0.2):
        found = eq.design(lee_chen(), "planar", layout=["13", "14", "14"], limit=limit)
        assert found.balance.exact
        for one in arm.installations(found.mechanism):
            assert max(abs(one.a), abs(one.b)) <= limit
    with pytest.raises(InfeasibleError, match=r"within 0\.005 m were found"):
        eq.design(OF_LENGTH[3], "planar", layout=["12", "13", "23"], limit=0.005)


@pytest.mark.parametrize(
    ("layout", "reason"),
    [
        (["13", "24", "34"], "G1 at links 1-4"),
        (["13", "14"], "4 links need 3 springs"),
        (["12", "14", "24"], "proved by the signs"),
        (["12", "13", "14"], "G2 at link 4"),
    ],
)
def test_infeasible_layouts_are_refused_with_the_reason(layout, reason):
    with pytest.raises(InfeasibleError, match=reason):
        eq.design(lee_chen(), "planar", layout=layout)


def test_a_link_without_moment_keeps_the_criteria_away():
    """The last link balanced by a counterweight: two springs do for four links, though the bound asks for three."""
    arm = replace(lee_chen(), masses=(eq.PointMass("counterweight", "link4", 1.33, (-0.06, 0, 0)),))
    found = eq.design(arm, "planar", layout=["13", "23"])
    assert found.balance.exact
    assert len(found.mechanism.springs) == 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"layout": []}, "has no springs"),
        ({"layout": ["15"]}, r"found '15' \(valid: 1 \(world\), 2 \(link2\)"),
        ({"layout": ["11"]}, "expected two links"),
        ({"layout": ["1-2-3"]}, "expected two links"),
        ({"limit": -1.0}, "limit: must be a finite number of more than 0"),
        ({"stiffness": {"99": 1.0}}, "no link that takes it '99'"),
        ({"a": {"13": 0.0}}, "a: must be a finite number other than 0, found 0.0"),
        ({"stock": [0.0]}, "stock: must be"),
        ({"seed": -1}, "seed"),
        ({"gap": 1}, "no such option"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(InputError, match=message):
        eq.design(lee_chen(), "planar", **options)


def test_names_of_links():
    by_name = eq.design(lee_chen(), "planar", layout=["world:link3", "4-1", "link2:link4"])
    by_number = eq.design(lee_chen(), "planar", layout=["13", "14", "24"])
    assert by_name.mechanism.springs == by_number.mechanism.springs
    assert name(default_layout(4)) == "13,14,24"
    assert name(default_layout(11)).startswith("1-3,1-4")


def test_where_it_does_not_apply():
    with pytest.raises(UnsupportedError, match="not parallel"):
        eq.design(robot("ur5"), "planar")
    assert METHODS["planar"].applies(lee_chen()) == []


def test_command(run, tmp_path):
    out = tmp_path / "balanced.yaml"
    code, text, _ = run(
        "design", ARM, "--method", "planar", "--set", "layout=13,14,24", "--set", "limit=300mm", "-o", out
    )
    assert code == 0
    assert "13 " in text
    assert "EXACT" in text
    assert run("check", out)[0] == 0
    code, _, err = run("design", ARM, "--method", "planar", "--set", "layout=12,13,14")
    assert code == 1
    assert "fails G2 at link 4" in err
