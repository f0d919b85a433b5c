"""Inverse design: the enumeration against a plain loop, and the springs of two papers sized."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from equipoise.hardware import WIRES, Envelope, ExtensionSpring, Limits, Need
from equipoise.hardware.sizing.extension import LOOP
from equipoise.hardware.sizing.helical import coils_for
from equipoise.hardware.sizing.winding import STEP, compression, extension, side_by_side
from equipoise.model.errors import InputError

MM = 1e-3
DH = (WIRES["DH"],)


@pytest.mark.parametrize(("rate", "least", "most", "outer"), [(590, 57, 155, 20), (2000, 10, 120, 15), (80, 2, 20, 40)])
def test_lightest_is_that_of_a_plain_loop(rate: float, least: float, most: float, outer: float) -> None:
    limits, best, count = Limits(), math.inf, 0
    for d in DH[0].preferred:
        for step in range(1, 4000):
            D = step * STEP
            if not limits.index[0] - 1e-9 <= D / d <= limits.index[1] + 1e-9 or D + d > outer * MM + 1e-12:
                continue
            count += 1
            n = coils_for(DH[0], d, D, rate)
            rm = DH[0].strength(d)
            stress = min((0.135 - 0.00625 * D / d) * rm, 8 * D * least / math.pi / d**3)
            hook = LOOP * (D - d)
            hook = max(hook, (math.pi * d**3 * stress / 8 / D / rate - (n + 1) * d) / 2)
            s = ExtensionSpring(DH[0], d, D, n, stress, hook)
            if n < 3 or min(s.static_margin(most, limits), s.hook_margin(most, limits)) < limits.safety:
                continue
            if s.fatigue_margin(least, most, limits) < limits.fatigue:
                continue
            if s.length(most) > 0.8:
                continue
            best = min(best, float(s.mass))
    found = extension(Need(rate, least, most), DH, limits, Envelope(outer * MM, 0.8))
    assert found.tried == count
    assert found.feasible == math.isfinite(best)
    assert found.spring.mass == pytest.approx(best, rel=1e-9)


@given(st.floats(50, 20_000), st.floats(0.01, 0.3), st.floats(0, 0.9))
@settings(max_examples=40, deadline=None)
def test_a_feasible_spring_does_what_is_asked(rate: float, stroke: float, share: float) -> None:
    need = Need(rate, share * rate * stroke, rate * stroke)
    limits, room = Limits(), Envelope(0.06, 1.0)
    for wind in (extension, compression):
        found = wind(need, DH, limits, room)
        s = found.spring
        assert s.rate == pytest.approx(rate, rel=1e-9)
        if not found.feasible:
            assert "reaches of what is needed" in found.reason
            continue
        assert found.reason == ""
        assert s.outer <= room.outer * (1 + 1e-9)
        assert limits.index[0] <= s.index * (1 + 1e-9)
        assert s.static_margin(need.most, limits) >= limits.safety - 1e-9
        assert min(DH[0].preferred, key=lambda d: abs(d - s.d)) == s.d
        if isinstance(s, ExtensionSpring):
            assert s.initial_tension <= need.least * (1 + 1e-9)  # open at every force
            assert s.length(need.most) <= room.length * (1 + 1e-9)
            assert s.left_over >= -1e-12


def test_heavier_demands_cost_mass() -> None:
    need, masses = Need(1000, 20, 200), []
    bare = Limits(safety=1.0, fatigue=0.0)
    for limits in (
        bare,
        Limits(),
        Limits(cycles=1e7),
        Limits(fatigue=1.0, safety=2.0),
        Limits(fatigue=1.5, safety=2.5),
    ):
        found = extension(need, DH, limits)
        assert found.feasible
        masses.append(found.mass)
        assert found.spring.fatigue_margin(need.least, need.most, limits) >= limits.fatigue - 1e-9
    assert masses == sorted(masses)


def test_parallel_springs_share_the_load_and_are_the_fewest() -> None:
    need, room = Need(20e3, 660, 4630), Envelope(0.04, 0.6)
    found = side_by_side(lambda part: compression(part, DH, None, room), need)
    assert found.feasible
    assert found.count * found.spring.rate == pytest.approx(need.rate)
    for fewer in range(1, found.count):
        assert not compression(need.shared(fewer), DH, None, room).feasible
    nothing = side_by_side(lambda part: compression(part, DH, None, Envelope(0.01, 0.1)), need, 3)
    assert not nothing.feasible
    assert nothing.count == 3
    assert nothing.reason.startswith("3 springs side by side cannot")


def test_zero_free_length_by_initial_tension_is_out_of_reach_of_the_guide_line() -> None:
    # F0/k >= n d needs pi w^2 tau_0 / G >= 1; with the guide line that takes Rm of at least 2780 MPa
    w = np.linspace(4, 20, 1000)
    share = math.pi * w**2 * (0.135 - 0.00625 * w) / 81.5e9
    assert 1 / share.max() / 1e6 == pytest.approx(2780, abs=5)
    found = extension(Need(590, 57, 155), DH, closed=0.097, order=lambda s: s.left_over)
    spring = found.spring
    assert isinstance(spring, ExtensionSpring)
    assert spring.left_over > 0
    # wound to a higher stress, it can
    high = Limits(initial=0.3, initial_slope=0.01)
    spring = extension(Need(590, 140, 155), DH, high, order=lambda s: s.left_over).spring
    assert isinstance(spring, ExtensionSpring)
    assert spring.left_over == pytest.approx(0, abs=1e-12)


def test_bad_needs() -> None:
    for rate, least, most in ((0, 0, 1), (1, 2, 1), (1, -1, 1), (math.nan, 0, 1), (1, 0, math.inf)):
        with pytest.raises(InputError):
            Need(rate, least, most)
    with pytest.raises(InputError, match="no preferred DH wire"):
        extension(Need(100, 0, 10), DH, None, Envelope(outer=0.001))
