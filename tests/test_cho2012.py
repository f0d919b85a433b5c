"""cho2012: the stiffness, the poses of Table 1 in closed form, soft springs, the hemisphere, the example files."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest
from example_files import FOLDER, same

import equipoise as eq
from equipoise.reproduce import Map, reproduce
from equipoise.reproduce.cho2012 import GRID, TABLE_1, TIMES, arm, balanced, motion
from equipoise.reproduce.record import half_unit
from equipoise.synthesis.bevel.differential import ARRANGEMENTS, gravity_torque

WEIGHT = 6.7 * 9.81 * 0.164  # m g l [N m]


@pytest.fixture(scope="module")
def paper():
    return reproduce("cho2012")


@pytest.fixture(scope="module")
def rows(paper):
    return {row.item: row for row in paper.rows}


def test_nothing_differs_unexplained(paper, rows):
    assert len(rows) == len(paper.rows)
    assert {row.verdict for row in rows.values()} == {"agrees", "erratum", "golden"}
    assert [item for item, row in rows.items() if row.verdict == "erratum"] == ["C of (17) over k (b^2 + h^2)"]


def test_stiffness(rows):
    for arrangement in ARRANGEMENTS:
        for spring in balanced(arrangement).mechanism.springs:
            assert spring.stiffness == pytest.approx(1605.7, abs=0.05)
            assert spring.stiffness == pytest.approx(WEIGHT / (2 * 0.0685 * 0.049), rel=1e-12)
    row = rows["k = m g l / (2 b h) (23), Sec. 4.1"]
    assert row.computed == pytest.approx(1.6057, abs=5e-5)
    assert row.relative_difference == pytest.approx(0.0099, abs=5e-5)
    # it takes the rounding of the inputs: that of k alone is not enough
    assert half_unit("1.59") < abs(row.computed - 1.59) < half_unit("1.59") + row.spread
    # first order: 0.05/6.7 + 0.0005/0.164 + 0.0005/0.049 + 0.00005/0.0685 of k
    assert row.spread / row.computed == pytest.approx(0.05 / 6.7 + 0.5 / 164 + 0.5 / 49 + 0.05 / 68.5, rel=1e-3)
    assert pytest.approx(1594, abs=0.5) == 6.65 * 9.81 * 0.164 / (2 * 0.0685 * 0.049)


@pytest.mark.parametrize("arrangement", ARRANGEMENTS)
def test_exact_through_the_couplings(arrangement):
    balance = eq.check(balanced(arrangement).mechanism)
    assert balance.exact
    assert balance.certificate.kind == "fourier"
    assert balance.mechanism.coordinates == ("roll", "pitch")
    assert [coupling.joint for coupling in balance.mechanism.couplings] == ["left disk", "right disk"]


@pytest.mark.parametrize("pose", TABLE_1)
def test_static_torques_of_table_1(rows, pose):
    t_1, t_2 = TABLE_1[pose]
    expected = WEIGHT * sin(t_1) * cos(t_2), WEIGHT * cos(t_1) * sin(t_2)
    np.testing.assert_allclose(-gravity_torque(WEIGHT, np.array([t_1, t_2])), expected, atol=1e-12)
    for j, (name, torque) in enumerate(zip(("roll", "pitch"), expected, strict=True), 1):
        where = f"of theta_{j} ({name}) at pose {pose}, Table 1"
        assert rows[f"static torque {where}"].computed == pytest.approx(torque, abs=1e-12)
        assert rows[f"the same with springs {where}"].computed == pytest.approx(0, abs=1e-12)


def test_static_torques_are_relatively_large(rows):
    """As the paper says: half to 71 % of m g l in the poses of Table 1 that are not zero."""
    found = {round(abs(row.computed) / WEIGHT, 6) for item, row in rows.items() if item.startswith("static torque")}
    assert found == {0.0, 0.5, round(np.sqrt(0.5), 6)}


def test_soft_springs_leave_their_share(rows):
    assert rows["peak residual over m g l, both springs 1 % soft"].computed == pytest.approx(0.01, rel=1e-9)
    assert rows["friction that holds every pose then"].computed == pytest.approx(0.01 * WEIGHT, rel=1e-9)
    printed = abs(1590 / (WEIGHT / (2 * 0.0685 * 0.049)) - 1) * WEIGHT
    assert rows["friction that holds every pose with the printed k"].computed == pytest.approx(printed, rel=1e-9)


def test_the_constant_of_17(rows):
    row = rows["C of (17) over k (b^2 + h^2)"]
    assert row.computed == pytest.approx(1, rel=1e-12)
    assert row.value == 2


def test_gear_ratios(rows):
    assert rows["residual rms torque over unbalanced, gear ratio 2"].computed == 1
    assert rows["residual rms torque over unbalanced, gear ratio 0.5"].computed == pytest.approx(0.84368, abs=5e-6)


def test_the_motion_stays_in_the_poses_of_table_1(paper):
    q = motion()
    for pose, theta in TABLE_1.items():
        held = (10 * (pose - 1) + 2 <= TIMES) & (10 * pose >= TIMES)
        np.testing.assert_allclose(q[held], np.tile(theta, (held.sum(), 1)), atol=1e-12)
    np.testing.assert_allclose(q[0], (0, -np.pi))
    for j, figure in enumerate(paper.figures[:2]):
        assert figure.name == f"fig{5 + j}"
        np.testing.assert_allclose(figure.series[f"reference theta_{j + 1} [rad]"], q[:, j])
        closed = WEIGHT * np.sin(q[:, j]) * np.cos(q[:, 1 - j])
        np.testing.assert_allclose(figure.series["static torque without springs [N m]"], closed, atol=1e-12)
        np.testing.assert_allclose(figure.series["torque with springs [N m]"], 0, atol=1e-12)


def test_maps_over_the_hemisphere(paper):
    *_, both, soft = paper.figures
    assert isinstance(both, Map)
    assert isinstance(soft, Map)
    t_1, t_2 = np.meshgrid(*GRID)
    closed = WEIGHT * np.sin(t_1) * np.cos(t_2), WEIGHT * np.cos(t_1) * np.sin(t_2)
    for j, torque in enumerate(closed, 1):
        np.testing.assert_allclose(both.panels[f"of theta_{j}, no springs"], torque, atol=1e-12)
        np.testing.assert_allclose(both.panels[f"of theta_{j}, balanced"], 0, atol=1e-12)
        np.testing.assert_allclose(soft.panels[f"of theta_{j}, 1 % soft"], 0.01 * torque, atol=1e-12)


@pytest.mark.parametrize(("file", "mechanism"), [("bevel_shoulder", arm()), ("bevel_balanced", balanced().mechanism)])
def test_examples(file, mechanism):
    same(eq.load(FOLDER / f"{file}.yaml"), mechanism, 1e-12, 1e-15, provenance=False)


def test_command_line(run, tmp_path):
    code, out, err = run("reproduce", "cho2012", "-o", tmp_path)
    assert code == 0
    assert "1 errata, proved" in out
    assert "FAIL" not in out
    names = {"cho2012.md", *(f"cho2012-{name}.png" for name in ("torque", "soft", "fig5", "fig6"))}
    assert {path.name for path in tmp_path.iterdir()} == names
    assert err.count("wrote") == 5
