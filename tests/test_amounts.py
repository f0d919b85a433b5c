"""Functions take what the command line takes: paths for mechanisms, text with units for numbers."""

from __future__ import annotations

from dataclasses import asdict, replace
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest
from zoo import pendulum

import equipoise as eq
from equipoise.clearance import clearance
from equipoise.hardware import Envelope, Options, choose
from equipoise.hardware.realise.bill import bill
from equipoise.hardware.sizing.wire import wire
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.hardware.stock.movable import Travel
from equipoise.io import loaded
from equipoise.model.errors import InputError
from equipoise.model.payload import Payload
from equipoise.model.units import SI_UNITS, USUAL, to_si
from equipoise.report.page.make import make
from equipoise.robust import Scatter, adjust, sweep, tolerance
from equipoise.simulate import play, release
from equipoise.synthesis import Problem, Region
from equipoise.synthesis.convex.ordinary import ordinary

PENDULUM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"
FEW: dict[str, Any] = {"samples": 32}


@pytest.fixture(scope="module")
def arm() -> eq.Mechanism:
    return eq.load(PENDULUM)


# Paths --------------------------------------------------------------------------------------------------------------

MOTION = (np.linspace(0, 1, 5), np.linspace(0, 0.5, 5)[:, None])
FRONT_DOORS = {
    "check": lambda source: eq.check(source, **FEW),
    "clearance": lambda source: clearance(source, **FEW),
    "tolerance": lambda source: tolerance(source, builds=10, poses=5),
    "adjust": lambda source: adjust(source, Payload.at(loaded(source), ["0", "2 kg"], "arm", [0.6, 0, 0])).best.share,
    "sweep": lambda source: sweep(source, Payload.at(loaded(source), "1 kg", "arm"), steps=2),
    "release": lambda source: release(source, seconds="0.05 s", poses=2, radius="50mm"),
    "play": lambda source: play(source, *MOTION, radius="50mm"),
    "ordinary": lambda source: ordinary(source, "20 mm", poses=10).balance,
    "bill": lambda source: bill(source).to_dict(),
    "choose": lambda source: replace(choose(source, made_up_catalogue(300, 0), seconds="20 s"), seconds=0.0),
    "make": lambda source: make(source, extras=()).verdict,
    "problem": lambda source: Problem.of(source, radius="80 mm"),
    "design": lambda source: eq.design(source, radius="80 mm"),
}


@pytest.mark.parametrize("name", FRONT_DOORS)
def test_a_path_stands_for_its_mechanism(name: str, arm: eq.Mechanism) -> None:
    assert FRONT_DOORS[name](arm) == FRONT_DOORS[name](str(PENDULUM))


def test_what_is_neither_is_said(arm: eq.Mechanism) -> None:
    assert loaded(arm) is arm
    assert loaded(PENDULUM) == arm
    with pytest.raises(InputError, match="expected a mechanism or the path of its file, found a int"):
        eq.check(5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"arm\.txt: a mechanism file cannot be '\.txt'"):
        eq.check("arm.txt")
    with pytest.raises(InputError, match=r"nowhere\.yaml: cannot be read"):
        eq.design("nowhere.yaml")


def test_a_file_is_saved_as_another(tmp_path: Path, arm: eq.Mechanism) -> None:
    eq.save(PENDULUM, tmp_path / "copy.yaml")
    assert eq.load(tmp_path / "copy.yaml") == arm


# Units --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "number"),
    [
        (lambda: Scatter("5%", "0.5 mm", "1 %", "500 um"), lambda: Scatter(0.05, 0.5e-3, 0.01, 0.5e-3)),
        (lambda: Envelope(outer="40mm", length="0.6"), lambda: Envelope(0.04, 0.6)),
        (lambda: Options(pulley="12mm"), lambda: Options(pulley=0.012)),
        (lambda: Options(friction={"case": "3%"}), lambda: Options(friction={"case": 0.03})),
        (lambda: Travel(0.5, 2.0, "300 mm"), lambda: Travel(0.5, 2.0, 0.3)),
        (lambda: wire("DH", "1900 MPa"), lambda: wire("DH", 1.9e9)),
        (lambda: Region.ball("80 mm", ("1 cm", 0, 0)), lambda: Region.ball(0.08, (0.01, 0, 0))),
        (lambda: Region.box(["80 mm", 0.1, 0]), lambda: Region.box((0.08, 0.1, 0.0))),
        (lambda: Region.box("80 mm"), lambda: Region.box(0.08)),
        (
            lambda: Problem.of(pendulum(), regions={"arm": "80 mm"}, shape="box").regions["arm"],
            lambda: (Region.box(0.08),),
        ),
        (
            lambda: Payload.at(pendulum(), ("500 g", "2 kg"), "arm", ("60 cm", 0, 0)),
            lambda: Payload.at(pendulum(), (0.5, 2), "arm", (0.6, 0, 0)),
        ),
        (
            lambda: tolerance(pendulum(), builds=10, poses=5, friction="500 N mm").friction,
            lambda: {"shoulder": 0.5},
        ),
        (lambda: ordinary(pendulum(), {"shoulder spring": "20 mm"}, preload="50%", poses=10).free_length,
         lambda: {"shoulder spring": 0.02}),
    ],
)  # fmt: skip
def test_text_with_a_unit_is_the_number(text, number) -> None:
    assert text() == number()


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: Scatter(attachment="5%"), "attachment"),
        (lambda: Scatter(stiffness="a lot"), "stiffness"),
        (lambda: Envelope(outer="4 kg"), "outer"),
        (lambda: Options(friction={"pulley": "3 mm"}), "friction.pulley"),
        (lambda: Travel(reach=""), "reach"),
        (lambda: wire("DH", "1900 mm"), "strength"),
        (lambda: Region.ball("5 kg"), "radius"),
        (lambda: Problem.of(pendulum(), regions={"arm": "80 kg"}), "regions.arm"),
        (lambda: Payload.at(pendulum(), "2 m", "arm"), "payload"),
        (lambda: Payload.at(pendulum(), 2.0, "arm", ("2 kg", 0, 0)), "payload_at.arm"),
        (lambda: tolerance(pendulum(), friction={"shoulder": "2 N"}), "friction.shoulder"),
        (lambda: adjust(pendulum(), Payload.at(pendulum(), (0, 1), "arm"), tolerance="1 mm"), "tolerance"),
        (lambda: release(pendulum(), radius="50 g"), "radius"),
        (lambda: release(pendulum(), seconds="50 g"), "seconds"),
        (lambda: release(pendulum(), tolerance="1 mm"), "tolerance"),
        (lambda: ordinary(pendulum(), "20 g"), "free_length"),
        (lambda: ordinary(pendulum(), clearance="5 g"), "clearance"),
        (lambda: eq.check(pendulum(), **FEW).balanced("1 kg"), "tolerance"),
        (lambda: eq.check(pendulum(), **FEW).balanced(torque="1 kg"), "torque"),
        (lambda: eq.design(pendulum(), radius="150 g"), "radius"),
    ],
)
def test_another_unit_is_an_error_that_names_the_field(call, field: str) -> None:
    with pytest.raises(InputError) as error:
        call()
    assert [fault.field for fault in error.value.faults] == [field]


def test_usual_units_are_what_pint_makes_of_them() -> None:
    registry = pint.UnitRegistry(cache_folder=None)
    for dimension, known in USUAL.items():
        for unit, factor in known.items():
            si = registry.Quantity(1.0, registry.parse_units(unit)).m_as(SI_UNITS[dimension].replace(" ", "*"))
            assert factor == si, f"{unit} as {dimension}"
            assert to_si(f"3.7 {unit}", dimension) == 3.7 * factor


def test_fields_made_from_amounts_are_fields_like_others() -> None:
    scatter = Scatter(attachment="1 mm")
    assert asdict(scatter) == {"stiffness": 0.05, "attachment": 1e-3, "mass": 0.01, "length": 0.5e-3, "shape": "normal"}
    assert replace(scatter, attachment=0.5e-3) == Scatter()
    assert hash(replace(scatter)) == hash(scatter)
    assert (Envelope().outer, Envelope(outer=inf).outer) == (inf, inf)
    with pytest.raises(AttributeError):
        scatter.mass = 0.5  # type: ignore[misc]


def test_a_verdict_is_asked_for_a_share_or_a_torque() -> None:
    balance = eq.check(pendulum(190.0), **FEW)
    peak, share = float(balance.residual.max[0]), balance.relative
    assert balance.balanced(f"{101 * share} %")
    assert not balance.balanced(f"{99 * share} %")
    assert balance.balanced(torque=f"{1010 * peak} N mm")
    assert not balance.balanced(torque=f"{990 * peak} N mm")


def test_a_design_remembers_numbers() -> None:
    design = eq.design(pendulum(), radius="200 mm").with_diameter("12 mm")
    assert design.mechanism.springs[0].diameter == 0.012  # type: ignore[attr-defined]
    bought = design.with_ordinary_springs("10 mm", preload="20%", poses=20)
    assert bought.free_parameters["preload"] == 0.2
    assert set(bought.free_parameters["free_length"].values()) == {0.01}
