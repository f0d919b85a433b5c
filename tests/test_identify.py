"""Identification: synthetic builds that it must find again, intervals that cover, what cannot be told apart, turns."""

import json
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest
import zoo
from campaign import SHARE, campaign

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.kinematics import Tree, sample
from equipoise.model.elements import TorsionSpring
from equipoise.model.errors import InputError
from equipoise.robust.identify import Regression, handles, identify
from equipoise.robust.measured import Measured, read

NOISE = 0.05  # [N m]


def arm() -> eq.Mechanism:
    """Two links, two springs with a free length, a torsion spring: nothing of it does what something else does."""
    m = zoo.pendulum(free_length=0.05)
    m = m.with_springs([replace(m.springs[0], p_b=(0.15, 0.0, 0.05))])
    fore = zoo.hinge("elbow", "arm", "fore", 0.4)
    springs = (
        *m.springs,
        eq.Spring("elbow spring", "arm", (0.0, 0.0, 0.1), "fore", (0.12, 0.0, 0.03), 300.0, 0.04),
        TorsionSpring("coil", (("elbow", 1.0),), 1.5, 0.3),
    )
    m = replace(m, bodies=(*m.bodies, eq.Body("fore", 1.2, (0.15, 0.0, 0.02))), joints=(*m.joints, fore))
    return m.with_springs(springs)


def built(m: eq.Mechanism, rng: np.random.Generator) -> tuple[eq.Mechanism, dict[str, float]]:
    """The mechanism with other rates, preloads and masses, written down by hand, and the true values."""
    truth, springs = {}, []
    for s in m.springs:
        k = (s.stiffness) * (1 + 0.08 * rng.normal())
        if isinstance(s, TorsionSpring):
            rest = s.rest + 0.05 * rng.normal()
            springs.append(replace(s, stiffness=k, rest=rest))
            truth[f"preload of {s.name}"] = -k * rest
        else:
            free = s.free_length + 0.004 * rng.normal()
            springs.append(replace(s, stiffness=k, free_length=free))
            truth[f"preload of {s.name}"] = -k * free
        truth[f"rate of {s.name}"] = k
    bodies = tuple(replace(b, mass=b.mass * (1 + 0.05 * rng.normal())) for b in m.bodies)
    truth |= {f"mass of {b.name}": b.mass for b in bodies}
    return replace(m, bodies=bodies).with_springs(springs), truth


def measure(m: eq.Mechanism, q: np.ndarray, noise: float, rng: np.random.Generator) -> Measured:
    torque = Potential(m)(q).torque
    return Measured(q, np.arange(q.shape[1]), torque + noise * rng.normal(size=torque.shape))


def test_without_noise_it_finds_the_build():
    rng, m = np.random.default_rng(1), arm()
    real, truth = built(m, rng)
    q = sample(Tree.of(m), 40, 3)
    found = identify(m, measure(real, q, 0.0, rng))
    assert {value.name for value in found.values} == truth.keys()
    for value in found.values:
        assert value.told
        assert value.found == pytest.approx(truth[value.name], rel=1e-6)
    other = sample(Tree.of(m), 50, 9)
    assert Potential(found.mechanism)(other).torque == pytest.approx(Potential(real)(other).torque, abs=1e-7)


@campaign(1000)
def test_intervals_cover_the_truth_in_95_percent_of_builds(seeds):
    m = arm()
    q = sample(Tree.of(m), 40, 0)
    problem = Regression(m, Measured(q, np.arange(2), np.zeros((40, 2))))
    covered = []
    for seed in seeds:
        rng = np.random.default_rng(seed)
        real, truth = built(m, rng)
        values, noise = problem.solve(measure(real, q, NOISE, rng).load)
        assert noise == pytest.approx(NOISE, rel=0.4)
        covered += [value.low <= truth[value.name] <= value.high for value in values]
    slack = 0.02 if SHARE == 1 else 0.04  # of a twentieth of the builds more is chance
    assert np.mean(covered) == pytest.approx(0.95, abs=slack)


def test_what_cannot_be_told_apart_is_named():
    """On a pendulum the zero-free-length spring's torque and gravity's are both a cosine; the preload's is not."""
    m, rng = zoo.pendulum(), np.random.default_rng(0)
    q = sample(Tree.of(m), 30, 0)
    real = m.with_springs([replace(m.springs[0], stiffness=210.0)])
    data = measure(real, q, 1e-3, rng)
    found = identify(m, data)
    assert found.alike == (("rate of shoulder spring", "mass of arm"),)
    told = {value.name: value for value in found.values}
    assert told["preload of shoulder spring"].told
    assert not np.isfinite(told["mass of arm"].high)
    weighed = {value.name: value for value in identify(m, data, known=["masses"]).values}
    rate = weighed["rate of shoulder spring"]
    assert rate.low < 210.0 < rate.high
    assert rate.high - rate.low < 1.0


def test_what_to_turn_and_what_is_left_then():
    """A spring 4 % too soft: k a b = m g l again when either end moves out by about 4 %."""
    m, rng = zoo.pendulum(), np.random.default_rng(0)
    q = sample(Tree.of(m), 30, 0)
    soft = m.with_springs([replace(m.springs[0], stiffness=0.96 * zoo.PENDULUM_K)])
    found = identify(m, measure(soft, q, 1e-4, rng), known=["masses"])
    (turn, *_) = found.turns
    assert "tighten" in str(found) or "away from the origin" in str(found)
    assert turn.what in ("p_a", "p_b")
    length = 0.2 if turn.what == "p_a" else 0.15
    assert turn.by == pytest.approx(length * (1 / 0.96 - 1), rel=0.01)
    assert len(found.turns) == 1
    assert found.before[0] == pytest.approx(0.04 * 2 * 9.81 * 0.3, rel=0.01)
    assert found.after[0] < 0.02 * found.before[0]
    # turned by hand, what was built is balanced
    (spring,) = soft.springs
    p = np.array(getattr(spring, turn.what))
    turned = soft.with_springs([replace(spring, **{turn.what: tuple(p * (1 + turn.by / length))})])
    assert eq.check(turned).relative < 1e-3


def test_the_tutorial_s_measurements_are_what_its_script_makes(tmp_path):
    folder = Path(__file__).parents[1] / "examples" / "measured"
    spec = spec_from_file_location("measurements", folder / "make.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    module.main(tmp_path)
    for name in ("before.csv", "after.csv"):
        made, there = (np.loadtxt(where / name, delimiter=",", skiprows=1) for where in (tmp_path, folder))
        assert made == pytest.approx(there, abs=1e-3)
    assert np.abs(made[:, 1]).max() < 0.1


FILE = "shoulder [deg],elbow [deg],torque:shoulder,current:elbow [mA]\n"


def test_files_and_the_command(run, tmp_path):
    rng, m = np.random.default_rng(2), arm()
    real, truth = built(m, rng)
    q = sample(Tree.of(m), 60, 3)
    load = measure(real, q, 0.01, rng).load
    rows = [
        f"{a:.9f},{b:.9f},{x:.9f},{y:.9f}" for (a, b), (x, y) in zip(np.degrees(q), load / [1, 0.05e-3], strict=True)
    ]
    (tmp_path / "measured.csv").write_text(FILE + "\n".join(rows) + "\n")
    eq.save(m, tmp_path / "arm.yaml")
    data = read(tmp_path / "measured.csv", m, {"elbow": 0.05})
    assert data.load == pytest.approx(load, abs=1e-9)
    command = ("identify", tmp_path / "arm.yaml", tmp_path / "measured.csv")
    code, out, err = run(*command, "--constant", "elbow=0.05 N m/A", "-o", tmp_path / "real.yaml",
                         "--table", tmp_path / "left.csv", "--json")  # fmt: skip
    assert code == 0, err
    answer = json.loads(out)
    for value in answer["values"]:
        assert value["found"] == pytest.approx(truth[value["name"]], rel=0.05)
    assert eq.load(tmp_path / "real.yaml").springs[0].stiffness == pytest.approx(
        truth["rate of shoulder spring"], rel=0.05
    )
    head, *table = (tmp_path / "left.csv").read_text().splitlines()
    assert head == "shoulder [rad],elbow [rad],torque:shoulder [N m],torque:elbow [N m]"
    values = np.array([[float(cell) for cell in row.split(",")] for row in table])
    expected = Potential(eq.load(tmp_path / "real.yaml"))(values[:, :2]).torque
    assert values[:, 2:] == pytest.approx(expected, rel=1e-5, abs=1e-5)
    code, out, _ = run(*command, "--constant", "elbow=0.05 N m/A")
    assert code == 0
    for text in ("rate of elbow spring", "95 %", "largest torque left"):
        assert text in out


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ("shoulder,torque:wrist", "no column 'torque:wrist'"),
        ("shoulder,current:shoulder", "needs its torque constant"),
        ("shoulder [kg],torque:shoulder", "'kg' is no unit of angle"),
        ("shoulder,elbow", "no column of loads"),
        ("shoulder,torque:shoulder,current:shoulder", "a column is there twice|needs its torque constant"),
    ],
)
def test_bad_tables_are_one_error(tmp_path, head, message):
    (tmp_path / "m.csv").write_text(f"{head}\n{','.join(['0'] * len(head.split(',')))}\n")
    with pytest.raises(InputError, match=message):
        read(tmp_path / "m.csv", arm())


def test_too_few_measurements_are_said():
    m = arm()
    q = sample(Tree.of(m), 3, 0)
    with pytest.raises(InputError, match="measure more poses"):
        identify(m, measure(m, q, 0.0, np.random.default_rng(0)))
    assert len([*handles(m)]) == 8
