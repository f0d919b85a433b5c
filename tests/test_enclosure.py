"""Enclosed coefficients: against the Fourier form in double precision, and against the verifier's own."""

from __future__ import annotations

import numpy as np
import pytest
from certified import mixed
from example_files import FOLDER

import equipoise as eq
from equipoise.energy.fourier.energy import FourierEnergy
from equipoise.energy.reference import Reference
from equipoise.kinematics import Tree, sample
from equipoise.proof import verify
from equipoise.proof.enclosure import Enclosure
from equipoise.proof.statement import written


def values(terms, unit, q):
    """The sum at configurations."""
    keys, n = np.array([*terms]), q.shape[1]
    c = np.array([complex(x) for x in terms.values()])
    powers = np.prod(q[:, None] ** keys[None, :, n:], axis=2)
    return np.real(powers * np.exp(1j * q @ keys[:, :n].T / unit) @ c)


@pytest.mark.parametrize("name", ["mixed", "lin2010_balanced", "parallelogram_lamp", "lenzo_layout_b"])
def test_the_energy_is_that_of_the_slow_sum(name):
    mechanism = mixed() if name == "mixed" else eq.load(FOLDER / f"{name}.yaml")
    enclosure = Enclosure(written(mechanism))
    q = sample(Tree.of(mechanism), 20)
    state = Reference(mechanism)(q)
    found = values(enclosure.energy(), enclosure.unit, q)
    assert np.ptp(found - state.energy) < 1e-11 * np.abs(state.gravity).max()


def test_both_programs_enclose_the_same_numbers():
    data = written(mixed())
    enclosure, tree = Enclosure(data), verify.Tree(data)
    one, other = enclosure.energy(), tree.energy(True)
    assert enclosure.unit == tree.unit == 3
    assert {*one} <= {*other}
    for key, (a, b, r) in other.items():
        assert r < verify.UNIT >> 300
        c = one.get(key, 0)
        ours = enclosure.number(0) + c
        theirs = enclosure.number(verify.Fraction(a, verify.UNIT), verify.Fraction(b, verify.UNIT))
        wide = enclosure.flint.arb(0, enclosure.flint.arb(2) ** -300)
        assert (ours - theirs + wide + wide * enclosure.flint.acb(0, 1)).contains(0)


def test_torques_are_bounded_like_those_of_the_fourier_form():
    mechanism = mixed()
    enclosure, fourier = Enclosure(written(mechanism)), FourierEnergy(mechanism)
    within = dict(zip(enclosure.names, map(verify.Fraction, fourier.reach.tolist()), strict=True))
    assert [float(x) for x in enclosure.torque(within)] == pytest.approx(fourier.torque_bound())
