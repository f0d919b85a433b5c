"""The best set of stock springs: against brute force by closed form, the proof, and a list of 2,000 springs."""

import itertools
import os
from dataclasses import replace

import numpy as np
import pytest
from campaign import some
from robots import lee_chen_springs

import equipoise as eq
from equipoise.cli.terminal import solver_aside
from equipoise.hardware import Stock, choose
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.hardware.stock.movable import Movable, Travel
from equipoise.hardware.stock.selection import shortest
from equipoise.model.errors import InfeasibleError, InputError, UnsupportedError

R2 = R3 = 0.180
G2, G3, G4 = ((0.5 * 0.848 + 0.848 + 1.330) * 9.81, (0.5 * 0.848 + 1.330) * 9.81, 0.060 * 1.330 * 9.81)
STEPS = 4000
SEEDS = 12
TRAVELS = (Travel(0.3, 3.0), Travel(0.8, 1.25))  # of even and odd seeds


def stock(rates, forces, masses) -> tuple[Stock, ...]:
    rows = enumerate(zip(rates, forces, masses, strict=True))
    return tuple(Stock(f"part {i}", "extension", k, f, 0.1, 0.02, 0.001, m, 0.0, 10 * m) for i, (k, f, m) in rows)


def random_stock(seed: int, count: int) -> tuple[Stock, ...]:
    rng = np.random.default_rng(seed)
    rates = np.exp(rng.uniform(np.log(25), np.log(1200), count))
    # what each must bear at the design's longest spring, more or less
    forces = rates * rng.uniform(0.25, 0.8, count)
    return stock(rates, forces, rng.uniform(0.02, 0.2, count))


def distances(k13, k1, k2, apart):
    """(a, b) of the three springs by lee2014's Eqs. (39)-(43); `apart` is what they leave free."""
    b13 = R3 * (k1 + k2) / k13
    a13 = (G2 - G3) / (k13 * (1 + b13 / R3))
    a2 = (G3 + k13 * a13 * b13 / R3 - k1 * apart) / (k1 + k2)
    c = G4 / apart
    return (a13, b13), (a2 + apart, c / k1), (a2, c / k2)


def brute_force(catalogue: tuple[Stock, ...], travel: Travel) -> float:
    """Least mass of all triples, with the free distance on a grid; the design is that of `lee_chen_springs`."""
    now = distances(590.0, 78.0, 160.0, 0.16)
    apart = np.geomspace(0.005, 2.0, STEPS)
    best = np.inf
    for three in itertools.product(catalogue, repeat=3):
        mass = sum(one.mass for one in three)
        if mass >= best:
            continue
        good = np.ones(STEPS, bool)
        found = distances(three[0].rate, three[1].rate, three[2].rate, apart)
        for (a, b), (a0, b0), one, links in zip(found, now, three, (R2, R2 + R3, R2 + R3), strict=True):
            for x, x0 in ((a, a0), (b, b0)):
                good &= (x >= travel.low * x0) & (x <= travel.high * x0)
            good &= one.rate * (a + b + links) <= one.max_force
        if good.any():
            best = mass
    return best


@pytest.mark.parametrize("seed", range(SEEDS))
def test_never_worse_than_brute_force(seed: int) -> None:
    catalogue, travel = random_stock(seed, 12), TRAVELS[seed % 2]
    least = brute_force(catalogue, travel)
    balance = eq.check(lee_chen_springs())
    if np.isinf(least):
        with pytest.raises(InfeasibleError):
            choose(balance, catalogue, travel=travel)
        return
    found = choose(balance, catalogue, travel=travel)
    assert found.proven
    assert found.cost == pytest.approx(least, rel=1e-9)
    verdict = eq.check(found.mechanism)
    assert verdict.exact
    for use, one, spring in zip(verdict.use, found.stock, found.mechanism.springs, strict=True):
        assert spring.stiffness == one.rate
        assert use.max_force <= one.max_force * (1 + 1e-6)


def test_brute_force_finds_some_and_misses_some() -> None:
    # the comparison above means something only if both happen
    least = [brute_force(random_stock(seed, 12), TRAVELS[seed % 2]) for seed in range(SEEDS)]
    assert 2 <= np.isfinite(least).sum() <= SEEDS - 2


@pytest.mark.deep
@pytest.mark.parametrize(("seed", "count"), some(((0, 2000), (7, 2000)), here=((7, 300),)))
def test_two_thousand_springs(seed: int, count: int) -> None:  # of seed 7, one set is only just impossible
    found = choose(eq.check(lee_chen_springs()), made_up_catalogue(count, seed), seconds=600)
    assert found.proven
    assert found.gap < 1e-9
    assert eq.check(found.mechanism).exact


def test_goal() -> None:
    balance = eq.check(lee_chen_springs())
    rates, forces = (590, 78, 160, 590, 78, 160), (200, 60, 80, 200, 60, 80)
    catalogue = stock(rates, forces, (0.1, 0.1, 0.1, 0.2, 0.2, 0.2))
    dear = tuple(replace(one, price=1.0 / one.mass) for one in catalogue)
    light, cheap = (choose(balance, dear, goal=goal) for goal in ("mass", "price"))
    assert light.cost == pytest.approx(0.3)
    assert cheap.cost == pytest.approx(15.0)
    with pytest.raises(InputError, match="unknown goal"):
        choose(balance, dear, goal="beauty")  # type: ignore[arg-type]


def test_design_itself_is_found_when_it_is_in_stock() -> None:
    balance = eq.check(lee_chen_springs())
    found = choose(balance, stock((590, 78, 160), (156, 48, 68), (1, 1, 1)), travel=Travel(0.99, 1.01))
    assert [s.rate for s in found.stock] == [590, 78, 160]
    assert found.to_dict()["proven"]


def test_why_not() -> None:
    balance = eq.check(lee_chen_springs())
    with pytest.raises(InfeasibleError, match=r"spring 2 \(1-4\).*bears the force"):
        choose(balance, stock((590.0,), (160.0,), (1.0,)))
    # strong enough, but of a rate that no attachments fit
    with pytest.raises(InfeasibleError, match="no set of these springs"):
        choose(balance, stock((590.0,), (1e4,), (1.0,)), travel=Travel(0.9, 1.1))
    # initial tension would keep them closed where the attachments meet
    with pytest.raises(InfeasibleError, match="stays open"):
        choose(balance, tuple(replace(one, initial_tension=1.0) for one in stock((590,), (1e4,), (1,))))
    with pytest.raises(InfeasibleError, match="none was found in 1e-09 s"):
        choose(balance, stock((590, 78, 160), (156, 48, 68), (1, 1, 1)), seconds=1e-9)
    long = tuple(replace(s, free_length=0.01) for s in lee_chen_springs().springs)
    with pytest.raises(UnsupportedError, match="has a free length"):
        choose(eq.check(lee_chen_springs().with_springs(long)), made_up_catalogue(10))
    with pytest.raises(InputError, match="low <= 1 <= high"):
        Travel(2, 3)


def test_moved_attachments_do_the_same() -> None:
    m = lee_chen_springs()
    movable = Movable(m)
    assert movable.rows.shape == (5, 3, 4)  # the five equations (39)-(43)
    k = np.array([1.4, 0.7, 1.2])
    shares = movable.solve(k, np.ones((3, 2)))
    assert shares is not None
    moved = movable.moved(k * [s.stiffness for s in m.springs], shares)
    assert eq.check(moved).exact
    assert movable.moved(np.array([s.stiffness for s in m.springs]), np.ones((3, 2))).springs[0].p_a == pytest.approx(
        m.springs[0].p_a
    )


def test_of_one_link_only_the_product_counts() -> None:
    one = eq.Mechanism(
        "pendulum",
        bodies=(eq.Body("arm", 2.0, (0.3, 0, 0)),),
        joints=(eq.Joint("shoulder", "revolute", "world", "arm", axis=(0, -1, 0)),),
        springs=(eq.Spring("s", "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2),),
    )
    found = choose(eq.check(one), stock((400.0, 100.0), (400.0, 50.0), (1.0, 2.0)))
    spring = found.mechanism.springs[0]
    assert spring.stiffness * spring.p_a[2] * spring.p_b[0] == pytest.approx(2 * 9.81 * 0.3)
    assert found.stock[0].rate == 400.0


def test_shortest_lengths_bound_those_of_all_attachments() -> None:
    movable = Movable(lee_chen_springs(), Travel(0.5, 2.0))
    least, most = shortest(movable)
    rng = np.random.default_rng(0)
    t, e_a, e_b = movable.directions(movable.poses)
    lengths = np.array([[ray.length for ray in pair] for pair in movable.rays])
    for _ in range(50):
        a, b = (lengths * rng.uniform(0.5, 2.0, (3, 2))).T
        d = np.linalg.norm(t - a[:, None] * e_a + b[:, None] * e_b, axis=2)
        assert (d.min(axis=0) >= least - 1e-12).all()
        assert (d.max(axis=0) >= most - 1e-12).all()


def test_a_ur5_keeps_its_balance_with_other_rates() -> None:
    """Spatial: neighbours' springs may change their rate, whatever the directions of their attachments."""
    from robots import robot

    design = eq.design(robot("ur5"), span=1, radius=0.15, springs=2)
    m = design.mechanism
    rates = [s.stiffness for s in m.springs]
    catalogue = stock([0.9 * k for k in rates], [1e6] * len(rates), [1.0] * len(rates))
    found = choose(design.balance, catalogue, travel=Travel(0.25, 4.0))
    after = eq.check(found.mechanism)
    assert found.proven
    assert after.residual.max == pytest.approx(design.balance.residual.max, rel=1e-3)


def test_what_the_solver_prints_does_not_spoil_the_answer(capfd) -> None:
    with solver_aside():
        os.write(1, b"a line of the solver")  # as its compiled code does
    print("the answer")
    out, err = capfd.readouterr()
    assert (out, err) == ("the answer\n", "a line of the solver")
