"""Helical springs: the golden case of EN 13906-2, the formulas against each other, and how they scale."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from equipoise.hardware import WIRES, CompressionSpring, ExtensionSpring, Limits
from equipoise.hardware.sizing.compression import least_free_length
from equipoise.hardware.sizing.extension import LOOP
from equipoise.hardware.sizing.helical import Helical, coils_for
from equipoise.hardware.sizing.limits import SOURCES
from equipoise.hardware.sizing.wire import wire
from equipoise.model.errors import InputError

MM, MPA = 1e-3, 1e6
sizes = st.tuples(st.floats(0.5, 8), st.floats(4, 20), st.floats(3, 100))  # d [mm], w, n


def golden(strength: float | None = None) -> ExtensionSpring:
    return ExtensionSpring(wire("1.4310", strength), 1.6 * MM, 11.1 * MM, 21, 175 * MPA, LOOP * 9.5 * MM)


def test_golden_extension_spring() -> None:
    s = golden()
    assert s.rate / 1000 == pytest.approx(1.997, abs=5e-4)
    assert s.initial_tension == pytest.approx(25.4, abs=0.05)
    assert s.body == pytest.approx(22 * 1.6 * MM)
    assert s.free_length == pytest.approx(s.body + 2 * 0.8 * 9.5 * MM)


def test_golden_initial_stress_follows_from_the_strength_given() -> None:
    # 175 MPa is the guide line's value for 1910 MPa; EN 10270-3's own 1900 MPa gives 174 MPa
    s = golden(1910 * MPA)
    assert Limits().initial_stress(s.index, s.strength) / MPA == pytest.approx(175, abs=0.5)
    assert golden().strength == 1900 * MPA


@pytest.mark.parametrize(
    ("grade", "d", "strength"),
    [
        ("SL", 1.0, 1720), ("SL", 2.0, 1520), ("SL", 10.0, 1060), ("SM", 1.0, 1980), ("DM", 2.0, 1760),
        ("SH", 1.0, 2230), ("DH", 2.0, 1980), ("DH", 0.5, 2480), ("DH", 10.0, 1410), ("1.4310", 1.6, 1900),
        ("1.4310-NS", 1.6, 1750), ("1.4310-NS", 1.5, 1800), ("1.4310-NS", 2.0, 1700), ("1.4310-NS", 10.0, 1250),
        ("1.4310", 2.25, 1750),
    ],
)  # fmt: skip
def test_strengths_of_the_standards(grade: str, d: float, strength: float) -> None:
    assert WIRES[grade].strength(d * MM) == strength * MPA


def test_strength_outside_the_standard_and_given() -> None:
    assert math.isnan(WIRES["SL"].strength(0.5 * MM))
    assert wire("DH", 1500 * MPA).strength(3 * MM) == 1500 * MPA
    assert wire("oil-hardened", 1600 * MPA).shear_modulus == 79.5e9
    with pytest.raises(InputError, match="must be given"):
        wire("oil-hardened")
    with pytest.raises(InputError, match="did you mean 'DH'"):
        wire("DHH")
    with pytest.raises(InputError, match="more than 0"):
        wire("DH", -1.0)


def test_moduli() -> None:
    assert {w.standard: w.shear_modulus for w in WIRES.values()} == {
        "EN 10270-1": 81.5e9,
        "EN 10270-2": 79.5e9,
        "EN 10270-3": 70e9,
    }
    for grade in ("DH", "SL", "1.4310"):
        d = WIRES[grade].preferred
        assert np.isfinite(WIRES[grade].strength(d)).all()
        assert (np.diff(d) > 0).all()


@given(sizes, st.floats(0.5, 3))
def test_rate_scales(size: tuple[float, float, float], factor: float) -> None:
    d, w, n = size[0] * MM, size[1], size[2]
    one = Helical(WIRES["DH"], d, w * d, n)
    # the same shape, larger: rate, force at a stress and mass go with the size, its square and its cube
    large = Helical(WIRES["DH"], factor * d, factor * w * d, n)
    assert large.rate == pytest.approx(factor * one.rate, rel=1e-12)
    assert large.force_at(5e8) == pytest.approx(factor**2 * one.force_at(5e8), rel=1e-12)
    assert large.coil_mass(n) == pytest.approx(factor**3 * one.coil_mass(n), rel=1e-12)
    assert replace(one, n=2 * n).rate == pytest.approx(one.rate / 2, rel=1e-12)
    assert coils_for(one.wire, d, w * d, one.rate) == pytest.approx(n, rel=1e-12)
    assert one.stress(one.force_at(5e8)) == pytest.approx(5e8, rel=1e-12)


@given(sizes)
def test_frequency_is_that_of_a_rod_held_at_both_ends(size: tuple[float, float, float]) -> None:
    d, w, n = size[0] * MM, size[1], size[2]
    s = Helical(WIRES["DH"], d, w * d, n)
    assert s.frequency == pytest.approx(0.5 * math.sqrt(s.rate / s.coil_mass(n)), rel=1e-12)


@given(sizes, st.floats(0, 200), st.floats(0, 1000))
def test_extension_spring_is_a_line_of_some_free_length(
    size: tuple[float, float, float], stress: float, more: float
) -> None:
    d, w, n = size[0] * MM, size[1], size[2]
    s = ExtensionSpring(WIRES["DH"], d, w * d, n, stress * MPA, LOOP * (w - 1) * d)
    force = s.initial_tension + more
    assert s.rate * (s.length(force) - s.left_over) == pytest.approx(force, rel=1e-9, abs=1e-9)
    assert s.length(0) == s.length(s.initial_tension) == s.free_length


@given(sizes, st.floats(10, 500))
def test_compression_spring_has_the_stroke_asked_for(size: tuple[float, float, float], stroke: float) -> None:
    d, w, n = size[0] * MM, size[1], size[2]
    coils = Helical(WIRES["DH"], d, w * d, n)
    s = CompressionSpring(coils.wire, d, w * d, n, float(least_free_length(coils, stroke * MM)))
    assert stroke * MM - 1e-9 <= s.stroke <= stroke * MM + 0.5 * MM + 1e-9
    assert s.length(s.stroke * s.rate) == pytest.approx(s.solid_length + s.gaps, rel=1e-9)


def test_buckling() -> None:
    # between parallel plates, nu = 1/2, a steel spring never buckles below L0/D = 5.16
    coils = Helical(WIRES["DH"], 2 * MM, 16 * MM, 10)
    stocky, slender = (CompressionSpring(coils.wire, coils.d, coils.D, coils.n, x * coils.D) for x in (5.1, 5.2))
    assert stocky.buckling_stroke() == math.inf
    assert slender.buckling_stroke() < slender.free_length
    # and a long one soon: s/L0 tends to pi^2 (D / nu L0)^2 / 2 / (1/2 + G/E)
    long = replace(coils, D=16 * MM)
    s = CompressionSpring(long.wire, long.d, long.D, long.n, 100 * long.D)
    ratio = long.wire.shear_modulus / long.wire.youngs_modulus
    expected = 0.25 * (math.pi / (0.5 * 100)) ** 2 / (0.5 + ratio)
    assert s.buckling_stroke() / s.free_length == pytest.approx(expected, rel=1e-3)
    # the softer the ends are held, the sooner
    strokes = [CompressionSpring(long.wire, long.d, long.D, long.n, 0.2).buckling_stroke(nu) for nu in (0.5, 0.7, 1, 2)]
    assert strokes == sorted(strokes, reverse=True)


def test_correction_is_between_the_other_ones_in_use() -> None:
    for w in (4.0, 8.0, 15.0):
        s = Helical(WIRES["DH"], MM, w * MM, 10)
        wahl = (4 * w - 1) / (4 * w - 4) + 0.615 / w
        assert s.correction == pytest.approx(wahl, rel=0.02)


@given(st.floats(50, 900), st.floats(0, 1))
def test_goodman(top: float, share: float) -> None:
    limits, s = Limits(cycles=1e6), golden()
    force = s.force_at(top * MPA) / s.correction  # corrected stress is `top`
    margin = s.fatigue_margin(share * force, force, limits)
    # on the line itself the margin is one
    ultimate = limits.shear_strength * s.strength
    endured = limits.amplitude / (1 - limits.mean / ultimate)
    a, m = (1 - share) / 2 * top * MPA, (1 + share) / 2 * top * MPA
    assert margin * (a / endured + m / ultimate) == pytest.approx(1, rel=1e-12)
    assume(share < 0.99)
    assert s.fatigue_margin(force, force, limits) > margin  # a force that stands still is borne best


def test_goodman_passes_through_zimmerlis_point() -> None:
    limits, s = Limits(cycles=1e7), golden()
    low, high = (limits.mean - limits.amplitude, limits.mean + limits.amplitude)
    least, most = (s.force_at(x) / s.correction for x in (low, high))
    assert s.fatigue_margin(least, most, limits) == pytest.approx(1, rel=1e-12)


def test_fewer_cycles_are_a_straight_line_in_both_logarithms() -> None:
    ultimate = 1000e6
    few, between, many = (Limits(cycles=cycles).endured(ultimate) for cycles in (1e3, 10**4.5, 1e6))
    assert few == pytest.approx(900e6)
    assert many == pytest.approx(241e6 / (1 - 0.379))
    assert between == pytest.approx((few * many) ** 0.5)
    assert Limits(cycles=10).endured(ultimate) == few
    assert Limits(cycles=1e9).endured(ultimate) == many


def test_every_limit_has_a_source_and_can_be_replaced() -> None:
    assert SOURCES.keys() == vars(Limits()).keys()
    changed = Limits.changed({"extension": "0.4", "index": "5:15"})
    assert (changed.extension, changed.index) == (0.4, (5.0, 15.0))
    assert golden().static_margin(50.0, changed) == pytest.approx(golden().static_margin(50.0, Limits()) * 0.4 / 0.45)
    for bad in ({"extnsion": "1"}, {"extension": "x"}, {"extension": "-1"}, {"index": "4"}, {"extension": "nan"}):
        with pytest.raises(InputError):
            Limits.changed(bad)
