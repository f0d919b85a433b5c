"""Springs that are real already: parts, hooked, gas and torsion springs, cables, each with margins."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.hardware import WIRES, Choice, Limits, Options, Stock, choose_parts
from equipoise.hardware.realise.held import kit
from equipoise.hardware.sizing.limits import BENDING
from equipoise.hardware.sizing.torsion import TorsionCoil, torsion
from equipoise.model.elements import LineElement, Pulley, TorsionSpring
from equipoise.model.elements.laws import Extension, Gas
from equipoise.model.errors import InputError


def arm(*springs) -> eq.Mechanism:
    return eq.Mechanism(
        name="arm",
        bodies=(eq.Body("arm", 1.0, (0.2, 0.0, 0.0)),),
        joints=(
            eq.Joint("pivot", "revolute", "world", "arm", axis=(0.0, -1.0, 0.0), range=(-radians(40), radians(40))),
        ),
        springs=springs,
        workspace=eq.Workspace(200),
    )


def only(*springs, limits: Limits | None = None):
    return kit(eq.check(arm(*springs)), Options(limits=limits or Limits()))


def test_rate_and_stress_of_a_torsion_spring_are_those_of_its_bent_wire() -> None:
    s = TorsionCoil(WIRES["DH"], 2e-3, 16e-3, 5.0)
    inertia, length = pi * s.d**4 / 64, pi * s.D * s.n
    assert s.rate == pytest.approx(206e9 * inertia / length, rel=1e-12)
    per_degree = 206e9 * s.d**4 / (3667 * s.D * s.n)
    assert s.rate == pytest.approx(per_degree * 180 / pi, rel=1e-4)
    assert s.bending(1.5) == pytest.approx(1.5 * s.d / 2 / inertia, rel=1e-12)
    # the mean stress alone breaks it at its strength, an amplitude alone at the endured one
    moment = s.strength * pi * s.d**3 / 32 / s.bending_correction
    assert s.fatigue_margin(moment, moment, Limits()) == pytest.approx(1, rel=1e-12)
    swing = Limits(cycles=1e7).endured(s.strength, BENDING) * pi * s.d**3 / 32 / s.bending_correction
    assert s.fatigue_margin(-swing, swing, Limits(cycles=1e7)) == pytest.approx(1, rel=1e-12)
    assert s.mandrel(pi) < s.mandrel(0.0) < s.inner
    assert s.body(2 * pi) == pytest.approx(s.body(0.0) + s.d)


def test_the_lightest_torsion_spring_has_its_margins() -> None:
    limits = Limits()
    found = torsion(1.0, 0.3, 1.8, (WIRES["DH"],), limits)
    assert found.feasible
    assert found.spring.rate == pytest.approx(1.0, rel=1e-9)
    assert min(found.static / limits.safety, found.fatigue) >= 1 - 1e-9
    more = torsion(1.0, 0.3, 1.8, (WIRES["DH"],), replace(limits, safety=2.5))
    assert more.spring.mass > found.spring.mass
    assert not torsion(1.0, 0.3, 1.8, (WIRES["DH"],), limits, outer=0.007).feasible
    with pytest.raises(InputError, match="needs a rate"):
        torsion(0.0, 0.3, 1.8, (WIRES["DH"],), limits)


def test_a_torsion_spring_is_wound_up_and_never_let_go() -> None:
    found = only(TorsionSpring("coil", (("pivot", 1.0),), 1.0, radians(60)))
    assert found.complete
    assert "mandrel" in found.items[0].order
    through = only(TorsionSpring("coil", (("pivot", 1.0),), 1.0, radians(10)))
    assert not through.complete
    assert "two against each other" in through.warnings[0]


def test_warmth_moves_the_torque_of_a_gas_spring_as_the_engine_says() -> None:
    def strut(temperature: float) -> LineElement:
        law = Gas(100.0, 0.36, 0.18, progression=1.3, temperature=temperature)
        return LineElement("strut", "world", (0.0, 0.0, -0.25), "arm", (0.1, 0.0, 0.0), law)

    note = only(strut(293.15)).items[0].notes[0]
    q = np.linspace(-radians(40), radians(40), 2001)[:, None]
    cold, warm = (Potential(arm(strut(t)))(q).spring_torque[:, 0] for t in (293.15, 313.15))
    said = float(note.split("by up to pivot ")[1].split()[0])
    assert said == pytest.approx(np.abs(warm - cold).max(), rel=0.02)
    assert "106.8 % at 40 degC" in note


def test_a_part_keeps_what_its_list_says() -> None:
    part = Stock("P-2", "extension", 2500.0, 300.0, 0.06, 0.02, 0.0028, 0.05, 10.0)
    found = choose_parts(arm(), (part,), Choice(realise=("pulley",), seconds=1.5, pulley=0.004), radius=0.15)
    item = kit(eq.check(found.mechanism), Options()).items[0]
    assert item.order == "part P-2"
    assert item.static == pytest.approx(300.0 / item.force[1], rel=1e-9)
    assert item.static is not None
    assert item.static >= 1.2 - 1e-6
    assert any("pulley's error" in note for note in item.notes)
    strict = kit(eq.check(found.mechanism), Options(limits=Limits(safety=item.static + 0.1)))
    assert not strict.complete
    assert "static margin" in strict.warnings[0]


def test_a_hooked_spring_is_wound_to_its_line_and_length() -> None:
    law = Extension(30.0, 0.1, 1.0)
    hooked = LineElement("hooked", "world", (0.0, 0.0, 0.2), "arm", (0.05, 0.0, 0.0), law)
    found = only(hooked)
    assert found.complete
    assert found.items[0].order.startswith("wind DH")
    short = only(LineElement("hooked", "world", (0.0, 0.0, 0.2), "arm", (0.05, 0.0, 0.0), replace(law, longest=0.12)))
    assert not short.complete
    assert "over-stretched" in short.warnings[0]


def test_the_pulleys_error_is_of_the_order_of_its_radius() -> None:
    def cabled(radius: float) -> str:
        pulley = Pulley("world", (0.0, 0.0, 0.15), radius, (0.0, 1.0, 0.0), (0.0, 0.0, 0.15 + 3 * radius))
        law = Extension(100.0, 0.08, 1.0, np.inf, 0.02)
        spring = LineElement("s", "world", (-0.3, 0.0, 0.15), "arm", (0.05, 0.0, 0.0), law, (pulley,))
        return next(note for note in only(spring).items[0].notes if "error" in note)

    errors = [float(cabled(r).split("within ")[1].split()[0]) for r in (0.004, 0.008)]
    assert 1.5 < errors[1] / errors[0] < 2.6


def test_from_the_command_line(run, tmp_path) -> None:
    eq.save(arm(TorsionSpring("coil", (("pivot", 1.0),), 1.0, radians(60))), tmp_path / "arm.yaml")
    code, out, _ = run("hardware", tmp_path / "arm.yaml", "-o", tmp_path / "bill.csv")
    assert code == 0
    assert "fatigue margin" in out
    assert "coil,torsion" in (tmp_path / "bill.csv").read_text()
    code, _, err = run("hardware", tmp_path / "arm.yaml", "--realise", "eyelet")
    assert code == 2
    assert "real already" in err
