"""Stiffness blocks of planar arms against the paper's numbers and the energy of the mechanism itself."""

from pathlib import Path

import numpy as np
import pytest
from robots import lee_chen, robot

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.model.errors import UnsupportedError
from equipoise.synthesis.planar.arm import Installation, PlanarArm, obstacles
from equipoise.synthesis.planar.stiffness_blocks import StiffnessBlocks

ARM = Path(__file__).parents[1] / "examples" / "mechanisms" / "lee_chen_arm.yaml"
# Lee and Chen (2014), Table 5: i, k, stiffness [N/m], a [m], b [m], alpha [deg], beta [deg]
TABLE_5A = [(1, 3, 590, 0.010, 0.073, 90, 180), (1, 4, 78, 0.190, 0.063, 90, 0), (1, 4, 160, 0.030, 0.031, 90, 180)]
TABLE_5B = [
    (1, 2, 93, 0.134, 0.120, 90, 0),
    (1, 4, 128, 0.134, 0.045, 90, 0),
    (2, 4, 320, 0.072, 0.045, 0, 0),
    (3, 4, 400, 0.262, 0.035, 180, 180),
]


def installed(table) -> list[Installation]:
    turn = {0: 1, 90: 1j, 180: -1, 270: -1j}
    return [Installation(i, k, s, a * turn[alpha], b * turn[beta]) for i, k, s, a, b, alpha, beta in table]


@pytest.mark.parametrize(
    ("table", "least", "most", "mean", "residual"),
    [(TABLE_5A, 20.52, 20.63, 20.58, 0.055), (TABLE_5B, 27.17, 27.29, 27.24, 0.050)],
)
def test_table_5(table, least, most, mean, residual):
    """The energies that PAPERS.md recomputes from the rounded table; published 20.56 and 27.27 J."""
    arm = PlanarArm.of(eq.load(ARM))
    balance = eq.check(eq.load(ARM).with_springs(arm.springs(installed(table))))
    assert balance.total == pytest.approx((least, most), abs=0.005)
    assert balance.constant == pytest.approx(mean, abs=0.005)
    assert balance.residual.max.max() == pytest.approx(residual, abs=0.0006)
    assert balance.unbalanced.max.max() == pytest.approx(8.47, abs=0.005)


def test_blocks_as_in_eqs_34_to_36():
    arm = PlanarArm.of(eq.load(ARM), end=0.070)
    gravity, spring = StiffnessBlocks.gravity(arm), StiffnessBlocks.spring(arm, installed(TABLE_5A)[0])
    m, r, s, g = (0.848, 0.848, 1.330), (0.18, 0.18, 0.07), (0.09, 0.09, 0.06), 9.81
    assert gravity.block(1, 2) == pytest.approx(-1j * g * (s[0] / r[0] * m[0] + m[1] + m[2]))  # Eq. (34a)
    assert gravity.block(1, 3) == pytest.approx(-1j * g * (s[1] / r[1] * m[1] + m[2]))  # Eq. (34b)
    assert gravity.block(1, 4) == pytest.approx(-1j * g * s[2] / r[2] * m[2])  # Eq. (34c)
    assert spring.block(1, 2) == pytest.approx(590 * 0.010 * 1j)  # Eq. (36)
    assert spring.block(1, 3) == pytest.approx(-590 * 0.010 * 0.073 / 0.18 * 1j)
    assert spring.block(2, 3) == pytest.approx(-590 * 0.073 / 0.18)
    assert np.count_nonzero(gravity.off_diagonal) == 3


def test_print():
    arm = PlanarArm.of(lee_chen())
    blocks = StiffnessBlocks.spring(arm, Installation(1, 2, 100.0, 0.1j, 0.09))
    assert str(blocks).splitlines()[0].split() == ["[", "1", "I", "5", "I'", "0", "0", "]"]
    assert blocks.latex().startswith(r"\begin{bmatrix} 1\,I & 5\,I' & 0 & 0 \\")


def _crooked() -> eq.Mechanism:
    """Turned frames, offsets along the axes, a payload on a body fixed to a link, mass centres off the line."""
    return eq.Mechanism(
        "crooked arm",
        bodies=(eq.Body("one", 1.2, (0.1, 0.05, 0.3)), eq.Body("two", 0.8, (0.07, -0.03, 0.02)), eq.Body("tip", 0.3)),
        joints=(
            eq.Joint("a", "revolute", "world", "one", (0.1, 0.2, 0.3), (np.pi / 2, 0, 0), (0, 0, 2)),
            eq.Joint("b", "revolute", "one", "two", (0.2, 0.05, 0.1), (0, 0, 0.7), (0, 0, -1)),
            eq.Joint("flange", "fixed", "two", "tip", (0.15, 0.02, 0.04), (0.4, 0.2, 0.1)),
        ),
        masses=(eq.PointMass("payload", "tip", 0.5, (0.02, 0.03, 0.01)),),
        springs=(
            eq.Spring("s", "tip", (0.02, 0.01, 0.0), "world", (0.0, 0.3, 0.5), 80.0),
            eq.Spring("t", "one", (0.1, 0.0, 0.2), "two", (0.05, 0.02, 0.0), 120.0),
        ),
    )


def test_blocks_are_the_energy():
    """1/2 r^H K r differs from the reference by a constant: blocks off the diagonal are all that varies."""
    mechanism = _crooked()
    arm = PlanarArm.of(mechanism)
    found = arm.installations(mechanism)
    K = StiffnessBlocks.total(arm, found).K
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, 2))
    turned = np.cumsum(q * [1, -1], axis=1) * np.sign(_sense(mechanism))
    r = arm.lengths * np.concatenate([np.ones((50, 1)), arm.u[1:] * np.exp(1j * turned)], axis=1)
    energy = 0.5 * np.einsum("ni,ij,nj->n", r.conj(), K, r).real
    difference = Potential(mechanism)(q).energy - energy
    assert np.ptp(energy) > 1
    assert np.ptp(difference) < 1e-12 * np.ptp(energy)


def _sense(mechanism: eq.Mechanism) -> float:
    """+1: the arm's frame has z along its first joint's axis, which is how angles are counted."""
    arm = PlanarArm.of(mechanism)
    return float((arm.R[1] @ np.array(mechanism.joints[0].axis))[2])


def test_springs_there_and_back():
    mechanism = _crooked()
    arm = PlanarArm.of(mechanism)
    found = arm.installations(mechanism)
    again = arm.installations(mechanism.with_springs(arm.springs(found)))
    for one, two in zip(found, again, strict=True):
        assert (one.i, one.k, one.stiffness) == (two.i, two.k, two.stiffness)
        np.testing.assert_allclose([one.a, one.b], [two.a, two.b], atol=1e-14)


def test_what_is_no_planar_arm():
    assert "not parallel" in obstacles(robot("ur5"))[0]
    with pytest.raises(UnsupportedError, match="free length"):
        PlanarArm.of(lee_chen()).installations(
            lee_chen().with_springs([eq.Spring("s", "world", (0, 0, 0.1), "link2", (0.1, 0, 0), 50.0, 0.02)])
        )
    assert not obstacles(lee_chen())
