"""Ordinary springs: the loss by formula and by MuJoCo, and what optimising wins back."""

# pyright: reportAttributeAccessIssue=false
# (the names of MuJoCo come from a compiled module that ships no type stubs)

import json
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest
import zoo
from robots import robot

import equipoise as eq
from equipoise.kinematics import Tree, sample
from equipoise.model.errors import InputError
from equipoise.synthesis.convex.ordinary import ordinary
from equipoise.synthesis.convex.ordinary_fit import WIDTH, Fit

MGL = 2 * zoo.G * 0.3


def mujoco_peak(m: eq.Mechanism) -> float:
    """Largest torque that holds the one link, by MuJoCo's inverse dynamics [N m]."""
    from equipoise.io.mjcf import to_text

    heavy = replace(m, bodies=tuple(replace(body, inertia=(1e-3, 1e-3, 1e-3, 0, 0, 0)) for body in m.bodies))
    model = mujoco.MjModel.from_xml_string(to_text(heavy))
    data = mujoco.MjData(model)
    peak = 0.0
    for angle in np.linspace(-np.pi, np.pi, 7201):
        data.qpos[0], data.qvel[:], data.qacc[:] = angle, 0, 0
        mujoco.mj_inverse(model, data)
        peak = max(peak, abs(float(data.qfrc_inverse[0])))
    return peak


@pytest.mark.parametrize("share", [1 / 8, 1 / 4])
def test_one_link_loses_the_share_of_its_longer_attachment_and_wins_it_back(share):
    """THEORY section 7: the peak is L0 / max(a, b) of m g l."""
    m = zoo.pendulum()
    found = ordinary(m, share * 0.2)
    assert found.plain.relative == pytest.approx(share, rel=1e-9)
    assert mujoco_peak(found.plain.mechanism) / MGL == pytest.approx(share, rel=1e-5)
    assert found.balance.relative < share / 5
    assert mujoco_peak(found.mechanism) / MGL == pytest.approx(found.balance.relative, rel=1e-4)
    (spring,), (old,) = found.mechanism.springs, m.springs
    assert spring.free_length == pytest.approx(share * 0.2)
    assert spring.stiffness <= 5 * old.stiffness * (1 + 1e-9)
    assert np.linalg.norm(spring.p_a) <= 0.2 + 1e-9
    assert np.linalg.norm(spring.p_b) <= 0.15 + 1e-9


def test_initial_tension_that_takes_all_of_it_makes_the_spring_ideal():
    found = ordinary(zoo.pendulum(), 0.05, preload=1.0)
    assert found.balance.relative < 1e-3 * found.plain.relative


def test_the_jacobian_by_differences():
    m = robot("ur5").with_springs(
        (
            eq.Spring("one", "shoulder_link", (0.05, 0.1, 0), "forearm_link", (0, 0.1, 0.05), 500.0),
            eq.Spring("two", "base_link", (0, 0, 0.1), "wrist_1_link", (0.1, 0, 0.02), 300.0),
        )
    )
    fit = Fit(m, {"one": 0.05, "two": 0.3}, {}, sample(Tree.of(m), 30), None)
    x = next(fit.starts(5)).ravel()
    x += 0.05 * np.random.default_rng(0).normal(size=2 * WIDTH)
    J, h = fit.evaluate(x)[1], 1e-6
    for i, e in enumerate(np.eye(len(x))):
        difference = (fit.evaluate(x + h * e)[0] - fit.evaluate(x - h * e)[0]) / (2 * h)
        assert J[:, i] == pytest.approx(difference, abs=1e-6)


def test_bad_options():
    bad: list[tuple[Any, dict[str, Any]]]
    bad = [(-0.1, {}), ({"spring": 0.1}, {}), (0.1, {"preload": 2.0}), (0.1, {"stiffness_factor": 0.5})]
    for given, options in bad:
        with pytest.raises(InputError):
            ordinary(zoo.pendulum(), given, **options)
    with pytest.raises(InputError, match="no springs"):
        ordinary(zoo.pendulum().with_springs(()), 0.1)


def test_command_line(run, tmp_path):
    file, out_file = tmp_path / "arm.yaml", tmp_path / "ordinary.yaml"
    eq.save(zoo.pendulum().with_springs(()), file)
    options = ("--span", 1, "--radius", "200mm", "--free-length", "25mm")
    code, out, _ = run("design", file, *options, "-o", out_file, "--json")
    answer = json.loads(out)
    assert code == 0
    assert answer["free_length"]["gain"] > 5
    assert answer["bound"] is None
    assert [s.free_length for s in eq.load(out_file).springs] == pytest.approx([0.025])
    code, out, _ = run("design", file, *options)
    assert code == 0
    assert "times smaller" in " ".join(out.split())
    assert run("design", file, "--free-length", "3 kg")[0] == 2
