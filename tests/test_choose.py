"""Parts chosen with their attachments: closed forms against the elements, the whole against an exhaustive search."""

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.hardware import Choice, Limits, Stock, choose_parts
from equipoise.hardware.choose.field import Field
from equipoise.hardware.choose.mount import Mount
from equipoise.hardware.choose.score import leading, score
from equipoise.hardware.choose.slots import Judge, Slot
from equipoise.hardware.choose.table import Table
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.hardware.stock.part import endurance
from equipoise.model.errors import InfeasibleError, InputError
from equipoise.synthesis import Region

M, L, TURN, LEVER, FRAME = 0.3, 0.3, np.radians(70), 0.02, 0.25
WHERE = {"pairs": [("world", "arm")], "regions": {"arm": LEVER, "world": FRAME}}
PARTS = made_up_catalogue(1300, 0, "extension")


def arm() -> eq.Mechanism:
    """0.3 kg at 0.3 m over +-70 deg about level."""
    return eq.Mechanism(
        name="arm",
        bodies=(eq.Body("arm", M, (L, 0.0, 0.0)),),
        joints=(eq.Joint("pivot", "revolute", "world", "arm", axis=(0.0, -1.0, 0.0), range=(-TURN, TURN)),),
    )


def judge(mechanism: eq.Mechanism, parts: tuple[Stock, ...], limits: Limits | None = None) -> Judge:
    field = Field(mechanism, np.ones(1), 50, 0)
    return Judge(field, Table.of(parts, limits or Limits()), parts, FRAME, 1e-3)


def mount(realise: str) -> Mount:
    return Mount("world", "arm", Region.ball(FRAME), Region.ball(LEVER), realise, 0.004 * (realise == "pulley"))  # type: ignore[arg-type]


@pytest.mark.parametrize("realise", ["direct", "eyelet", "pulley"])
def test_what_a_slot_does_is_what_its_element_does(realise: str) -> None:
    own, part = judge(arm(), PARTS), replace(PARTS[900], mass=0.0)
    own.catalogue = (part,)
    own.table = Table.of((part,), Limits())
    x = np.array([0.1, -0.3, 0.9, 0.2, 0.5, -0.6, 0.02])
    made = mount(realise).element(own.field, x[:6], x[6], part, "spring")
    state = Potential(arm().with_springs([made]))(own.field.q)
    doing = own.doing(mount(realise), 0, x[None])
    law: Any = made.law
    length = state.path[:, 0] - (law.cable if realise != "direct" else 0.0)
    assert doing.length[0] == pytest.approx(length, abs=1e-12)
    pulls = length > part.free_length
    assert doing.torque[0][pulls] == pytest.approx(state.spring_torque[pulls, 0], abs=1e-9)
    if realise != "direct":
        assert pulls.all()
        assert law.body_length == part.free_length
        at = np.linalg.norm(np.subtract(made.p_a, made.via[0].point))
        assert at >= length.max() - 1e-9  # the spring stays behind its eyelet


@pytest.mark.parametrize("realise", ["direct", "eyelet"])
def test_scores_are_what_is_left(realise: str) -> None:
    parts = tuple(replace(part, mass=0.0) for part in PARTS[::40])
    own, place = judge(arm(), parts), mount(realise)
    u = np.random.default_rng(0).uniform(-0.57, 0.57, (400, 6))
    found = score(own.field, place, own.table, own.field.load, u)
    best = leading(found, 8)
    assert len(best) == 8
    for row in best:
        slot = Slot(place, int(row), found.x[row])
        assert own.may(slot)
        left = own.field.load + own.torque(slot)
        assert float(left @ left) == pytest.approx(found.left[row], rel=1e-9, abs=1e-12)


def test_no_worse_than_an_exhaustive_search_of_its_own() -> None:
    parts = tuple(PARTS[i] for i in (440, 620, 1000, 1154, 1199))
    found = choose_parts(arm(), parts, Choice(seconds=3.0), **WHERE)
    assert not found.balance.passed
    assert found.left == pytest.approx(found.residual / found.unbalanced, rel=2e-2)
    q, rng, best = np.linspace(-TURN, TURN, 61), np.random.default_rng(1), np.inf
    limits = Limits()

    def peak(x: np.ndarray, part: Stock) -> float:
        r, h, phi = LEVER * np.tanh(x[0]), FRAME * np.tanh(x[1]), x[2]
        s = np.sqrt(r**2 + h**2 - 2 * r * h * np.cos(phi - q))
        force = part.initial_tension + part.rate * (s - part.free_length)
        torque = M * 9.81 * L * np.cos(q) - force * r * h * np.sin(phi - q) / s
        top, bottom = endurance(part, limits)
        over = max(0, part.free_length - s.min()) * part.rate + max(0, force.max() - part.max_force / limits.safety)
        over += max(0, top * force.max() - bottom * force.min() - 1)
        return float(np.abs(torque).max() + 10 * over) / (M * 9.81 * L)

    for part in parts:
        for _ in range(4):
            start = [rng.uniform(-1, 1), rng.uniform(0.3, 2), rng.uniform(-np.pi, np.pi)]
            best = min(best, minimize(peak, start, (part,), "Nelder-Mead", options={"maxiter": 400}).fun)
    assert found.left <= best * 1.05 + 1e-3
    assert found.left < 0.02


def test_the_file_holds_the_part_and_says_the_same(tmp_path) -> None:
    parts = (Stock("P-2", "extension", 1400.0, 85.0, 0.045, 0.014, 0.0015, 0.012, 6.0, 2.5),)
    found = choose_parts(arm(), parts, Choice(realise=("eyelet",), seconds=2.0), pairs=[("world", "arm")], radius=0.1)
    eq.save(found.mechanism, tmp_path / "built.yaml")
    again = eq.load(tmp_path / "built.yaml")
    (spring,) = again.springs
    assert (spring.part, spring.realisation, spring.mass, spring.law.kind) == ("P-2", "eyelet", 0.012, "extension")
    assert (spring.law.body_length, spring.law.initial_tension) == (0.045, 6.0)
    assert again.provenance["parts"][0]["part"] == "P-2"
    assert eq.check(again).relative == found.left
    assert not found.balance.use[0].reached  # neither slack nor over-stretched anywhere


def test_margins_are_kept_and_more_of_them_costs() -> None:
    parts = PARTS[700:1300:20]
    for limits in (Limits(safety=1.0, fatigue=0.0), Limits(safety=2.0)):
        found = choose_parts(arm(), parts, Choice(limits=limits, seconds=1.5), **WHERE)
        (part,), (use,) = found.parts, found.balance.use
        least, most = use.force
        assert part.max_force / most >= limits.safety - 1e-6
        top, bottom = endurance(part, limits)
        assert top * most - bottom * least <= 1 + 1e-6


def test_gas_springs_and_compression_springs_push() -> None:
    strut = Stock("G-1", "gas", 300.0, 130.0, 0.25, mass=0.1, min_length=0.15, force=100.0, progression=1.3)
    coil = Stock("C-1", "compression", 800.0, 120.0, 0.25, 0.03, 0.0028, 0.1)
    for part in (strut, coil):
        found = choose_parts(arm(), (part,), Choice(seconds=2.0), pairs=[("world", "arm")], radius=0.25)
        (spring,), (use,) = found.mechanism.springs, found.balance.use
        assert spring.law.kind == part.kind
        assert not found.balance.passed
        assert use.force[1] <= 0  # it pushes
        assert found.left < 0.3


def test_what_cannot_be_is_said() -> None:
    with pytest.raises(InfeasibleError, match="What would help"):
        choose_parts(arm(), PARTS[:20], Choice(seconds=0.5), pairs=[("world", "arm")], radius=0.005)
    with pytest.raises(InputError, match="the list has no part 'MADE-UP-0001'"):
        choose_parts(arm(), PARTS[:20], Choice(without=("MADE-UP-0001",)), **WHERE)
    with pytest.raises(InputError, match="unknown realisation"):
        Choice(realise=("rope",))  # type: ignore[arg-type]


def test_a_part_that_is_sold_out_is_not_taken() -> None:
    parts = PARTS[1100:1200:10]
    first = choose_parts(arm(), parts, Choice(seconds=0.8), **WHERE).parts[0].part
    assert choose_parts(arm(), parts, Choice(seconds=0.8, without=(first,)), **WHERE).parts[0].part != first


def test_several_side_by_side_are_several_springs() -> None:
    weak = tuple(part for part in PARTS if part.max_force < 60)[::30]
    alone = choose_parts(arm(), weak, Choice(seconds=1.0, limits=Limits(fatigue=0)), **WHERE)
    both = choose_parts(arm(), weak, Choice(seconds=1.0, parallel=3, limits=Limits(fatigue=0)), **WHERE)
    assert both.left <= alone.left + 0.05
    assert len(both.mechanism.springs) == len(both.parts) <= 3


def test_design_with_springs_that_can_be_wound(run, tmp_path) -> None:
    eq.save(arm(), tmp_path / "arm.yaml")
    out, made = ("-o", tmp_path / "built.yaml"), ("--max-length", "300mm", "--max-force", "200N", "--seconds", "2")
    where = ("--pairs", "world:arm", "--region", "arm=20mm", "--region", "world=250mm")
    code, text, _ = run("design", tmp_path / "arm.yaml", "--realise", "direct", *where, *made, *out)
    assert code == 0
    assert "reality costs" in " ".join(text.split())
    (spring,), (use,) = (found := eq.load(tmp_path / "built.yaml")).springs, eq.check(found).use
    assert spring.part.startswith("DH ")
    assert use.path[1] <= 0.3
    assert use.force[1] <= 200
    code, _, err = run("design", tmp_path / "arm.yaml", "--max-length", "300mm")
    assert code == 2
    assert "--max-length: needs --realise" in err


def test_a_torsion_spring_on_the_joint() -> None:
    coil = Stock("T-1", "torsion", mass=0.02, torsional_rate=0.4, max_torque=2.0)
    found = choose_parts(arm(), (coil, replace(coil, part="T-2", torsional_rate=0.15)), Choice(seconds=1.0), **WHERE)
    (spring,), (use,) = found.mechanism.springs, found.balance.use
    assert spring.kind == "torsion"
    assert spring.part in ("T-1", "T-2")
    assert min(use.force) * max(use.force) >= 0  # only ever wound up
    assert max(map(abs, use.force)) <= 2.0 / 1.2 + 1e-9
    # of all rests and both parts none leaves less, by the root mean square
    q = np.linspace(-TURN, TURN, 121)
    rms = {}
    for k in (0.4, 0.15):
        for rest in np.linspace(-15, 15, 3001):
            moment = k * (q - rest)
            if (moment.min() >= 0 or moment.max() <= 0) and np.abs(moment).max() <= 2.0 / 1.2:
                rms[k, rest] = np.mean((M * 9.81 * L * np.cos(q) + moment) ** 2)
    (k, rest), _ = min(rms.items(), key=lambda item: item[1])
    assert spring.stiffness == k
    assert spring.rest == pytest.approx(rest, abs=0.05)


def test_what_is_asked_holds_between_the_poses_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four poses of a full turn: the spring is longest and shortest 30 degrees away from them."""
    monkeypatch.setattr(sys.modules[Field.__module__], "ALONG", 4)
    whole = replace(arm(), joints=(replace(arm().joints[0], range=(-np.pi, np.pi)),))
    limits = Limits(safety=3.0)
    found = choose_parts(whole, PARTS[700::20], Choice(limits=limits, seconds=0.6), **WHERE)
    (part,), (use,) = found.parts, found.balance.use
    top, bottom = endurance(part, limits)
    assert part.max_force / use.force[1] >= limits.safety - 1e-6
    assert top * use.force[1] - bottom * use.force[0] <= 1 + 1e-6


def test_a_spring_that_stays_may_pass_its_own_limits() -> None:
    strut = eq.LineElement(
        "strut", "world", (0.0, 0.0, -0.3), "arm", (0.1, 0.0, 0.0), eq.laws.Gas(1.0, 0.33, 0.3, progression=1.3)
    )
    kept = arm().with_springs([strut])
    found = choose_parts(kept, PARTS[700::40], Choice(seconds=0.5), keep=True, **WHERE)
    assert {name for name, _ in found.balance.passed} == {"strut"}
    assert len(found.parts) == len(found.mechanism.springs) - 1
