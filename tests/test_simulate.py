"""Simulation in MuJoCo: what is exact stays where it is left, what is not moves, motions take what mechanics says."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from campaign import share
from loop_zoo import four_bar
from robots import balanced
from zoo import G, exact_pendulum, lee_chen_arm, lenzo_spherical, parallelogram_lamp, pendulum

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.kinematics.linkage import Linkage
from equipoise.kinematics.sampling import sample
from equipoise.model.errors import InputError
from equipoise.reproduce import cho2012, lin2010
from equipoise.simulate import Engine, EngineError, play, release
from equipoise.simulate.quiet import quiet
from equipoise.synthesis.delta.robot import DeltaRobot

SPHERE = 0.05  # [m]
DEGREE = np.pi / 180
INERTIA = (0.01, 0.01, 0.01, 0.0, 0.0, 0.0)


@cache
def delta() -> eq.Mechanism:
    """Full balance with data of which nothing is special."""
    bare = DeltaRobot(base=0.25, platform=0.1, upper=0.4, lower=0.7, com_2=0.15, com_4=0.3).mechanism()
    masses: dict[str, Any] = {
        "link_8": 0.3,
        "link_9": 0.2,
        "frame": 0.4,
        "link_2p": 0.35,
        "spring_7": 1.8,
        "spring_10": 0.5,
    }
    return eq.design(bare, "delta", BF=0.12, CS=0.1, **masses).mechanism


LEE = ("13,14,14", "13,14,24", "12,14,24,34", "12,14,23,24")  # of THEORY's table, for the arm of the paper's Table 4


def lee(layout: str) -> eq.Mechanism:
    return eq.design(lee_chen_arm().mechanism, "planar", layout=layout.split(",")).mechanism


def with_inertia(m: eq.Mechanism) -> eq.Mechanism:
    return replace(m, bodies=tuple(replace(body, inertia=INERTIA) for body in m.bodies))


# Staying ------------------------------------------------------------------------------------------------------------


def test_a_pendulum_stays_and_a_soft_spring_moves_it():
    found = release(with_inertia(exact_pendulum().mechanism), seconds=3, poses=5, tolerance=1e-9)
    assert found.stays
    assert found.meaningful
    assert found.design.largest < 1e-12
    assert found.control is not None
    # 1 % of m g l over the inertia, from rest: no faster than free fall with a hundredth of gravity
    inertia = INERTIA[1] + 2.0 * 0.3**2
    fastest = 0.5 * 0.01 * 2.0 * G * 0.3 / inertia * 3**2
    assert 0.01 < found.control.largest < fastest
    assert found.control.energy.max() < 1e-9


def test_without_springs_it_falls():
    m = with_inertia(pendulum()).with_springs(())
    found = release(m, seconds=2, poses=3)
    assert not found.stays
    assert found.control is None
    # free of damping it reaches the mirrored angle about straight down
    _, joint = found.worst
    assert joint == "shoulder"
    np.testing.assert_allclose(found.design.holding, found.unbalanced)
    np.testing.assert_allclose(found.design.holding[:, 0], 2.0 * G * 0.3 * np.cos(found.poses[:, 0]), rtol=1e-9)


def test_the_control_is_the_spring_that_is_felt_most():
    m = with_inertia(lenzo_spherical().mechanism)
    weak = replace(m.springs[0], name="weak", stiffness=1e-3)
    found = release(m.with_springs((weak, *m.springs)), seconds=0.5, poses=2, tolerance=1e-2)
    assert found.soft in {spring.name for spring in m.springs}


@pytest.mark.deep
@pytest.mark.parametrize("name", ["pendulum", "lenzo", "bevel", *LEE])
def test_exact_designs_stay(name):
    """10 s from many poses: below 1e-6 rad, and the control moves by more than 1 degree from every pose."""
    m = {
        "pendulum": lambda: exact_pendulum().mechanism,
        "lenzo": lambda: lenzo_spherical().mechanism,
        "bevel": lambda: cho2012.balanced().mechanism,
        **{layout: partial(lee, layout) for layout in LEE},
    }[name]()
    found = release(m, seconds=10, poses=share(60), tolerance=1e-6, radius=SPHERE)
    assert found.stays, found.design.largest
    assert found.control is not None
    assert found.control.moved.max(axis=1).min() > DEGREE


@pytest.mark.slow(reason="ten seconds of six joints")
def test_a_balanced_ur5_stays():
    found = release(balanced().mechanism, seconds=10, poses=10, tolerance=1e-4)
    assert found.stays
    assert found.design.largest < 1e-9
    assert found.meaningful
    fallen = release(balanced().mechanism.with_springs(()), seconds=1, poses=3)
    assert not fallen.stays
    assert fallen.design.largest > 10 * DEGREE


def test_parallelograms_stay():
    found = release(parallelogram_lamp().mechanism, seconds=1, poses=3, tolerance=1e-7, radius=SPHERE)
    assert found.stays
    assert found.design.constraint_error < 1e-8
    assert "equalities" in str(found.settings)


def test_friction_holds_only_where_it_is_asked_for():
    """1 % of the torque is missing, friction holds twice that; damping takes what moves to rest."""
    m = with_inertia(exact_pendulum().mechanism)
    m = m.with_springs([replace(m.springs[0], stiffness=0.99 * m.springs[0].stiffness)])
    stiff = replace(m, joints=(replace(m.joints[0], friction=0.02 * 2.0 * G * 0.3),))
    free, held = (release(stiff, seconds=1, poses=3, control=False, friction=friction) for friction in (False, True))
    assert (free.design.moved > DEGREE).all()
    assert held.design.largest < 1e-3  # the engine's friction is a little soft
    assert "friction and damping of the joints" in str(held.settings)
    assert "no friction or damping" in str(free.settings)
    slow = replace(m, joints=(replace(m.joints[0], damping=5.0),))
    slowed = release(slow, seconds=1, poses=3, control=False, friction=True)
    assert (slowed.design.moved < 0.1 * free.design.moved).all()


# Real linkages ------------------------------------------------------------------------------------------------------


def held(m: eq.Mechanism, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Holding torques with and without springs, by the engine, and the largest opening of a loop [m]."""
    sprung, bare, error = Engine(m, SPHERE), Engine(m.with_springs(()), SPHERE), 0.0
    found = []
    for engine in (sprung, bare):
        torques = []
        for one in q:
            engine.place(one)
            torques.append(engine.holding())
            error = max(error, engine.constraint_error)
        found.append(np.array(torques))
    return found[0], found[1], error


@pytest.mark.slow(reason="loops in the engine")
def test_the_arm_of_lin2010_with_its_ball_joints():
    m = lin2010.balanced(real=True).mechanism
    tree = Tree.of(m)
    assert isinstance(tree, Linkage)
    assert (tree.mobility.numerical, len(m.loops)) == (11, 5)  # 6 active, 5 idle
    q = sample(tree, 15, 3)
    with_springs, without, error = held(m, q)
    assert np.abs(with_springs).max() < 1e-9 * np.abs(without).max()
    assert error < 1e-12
    spun = q.copy()
    spun[:, 6:] += np.random.default_rng(0).uniform(-1, 1, spun[:, 6:].shape)
    np.testing.assert_allclose(held(m, spun)[1][:, :6], without[:, :6], atol=1e-9)
    np.testing.assert_allclose(without[:, 6:], 0, atol=1e-9)
    found = release(m, seconds=0.5, poses=2, tolerance=1e-2, radius=SPHERE)
    assert found.stays
    assert found.design.constraint_error < 1e-5
    ours = eq.check(m, samples=50).residual.max
    assert np.abs(with_springs).max() < 1e-9 * np.abs(without).max() > 0
    assert ours.max() < 1e-9 * np.abs(without).max()


@pytest.mark.slow(reason="loops in the engine")
def test_a_delta_robot_with_its_rod_pairs():
    m = delta()
    q = sample(Tree.of(m), 50, 3)
    with_springs, without, error = held(m, q)
    assert np.abs(with_springs).max() < 1e-9 * np.abs(without).max()
    assert error < 1e-12
    found = release(m, seconds=0.5, poses=2, tolerance=1e-5, radius=SPHERE)
    assert found.stays
    assert found.design.constraint_error < 1e-5
    # what is not balanced agrees with ours, through the loops
    from equipoise.energy.evaluate import Potential

    np.testing.assert_allclose(without, Potential(m.with_springs(()))(q).torque, rtol=1e-8, atol=1e-8)


# Motions ------------------------------------------------------------------------------------------------------------


def test_a_pendulum_driven():
    """I q'' with the springs, and m g l cos q more without them."""
    m = with_inertia(exact_pendulum().mechanism)
    t = np.linspace(0, 2, 2001)
    q = 0.3 + 0.5 * (1 - np.cos(np.pi * t))
    found = play(m, t, q[:, None])
    inertia = INERTIA[1] + 2.0 * 0.3**2
    expected = inertia * 0.5 * np.pi**2 * np.cos(np.pi * t)
    inner = slice(5, -5)
    np.testing.assert_allclose(found.torque[inner, 0], expected[inner], atol=1e-4)
    np.testing.assert_allclose(found.unsprung[inner, 0], (expected + 2 * G * 0.3 * np.cos(q))[inner], atol=1e-4)
    assert np.ptp(found.gravity + found.springs) < 1e-12
    np.testing.assert_allclose(found.gravity, 2 * G * 0.3 * (np.sin(q) - np.sin(q[0])), atol=1e-12)
    (peak, bare), (work, bare_work) = found.peak, found.work
    assert peak[0] < 0.3 * bare[0]
    assert work[0] < bare_work[0]


def test_friction_and_damping_cost_work():
    """Of a motion with the springs: dry friction against the rate's sign, damping in proportion to it."""
    m = with_inertia(exact_pendulum().mechanism)
    rubs = replace(m, joints=(replace(m.joints[0], friction=0.7, damping=0.4),))
    t = np.linspace(0, 2, 801)
    q = 0.3 + 0.5 * (1 - np.cos(np.pi * t))
    rate = np.gradient(q, t)
    more = play(rubs, t, q[:, None]).torque[:, 0] - play(m, t, q[:, None]).torque[:, 0]
    inner = np.abs(rate) > 0.05
    np.testing.assert_allclose(more[inner], 0.7 * np.sign(rate[inner]) + 0.4 * rate[inner], atol=1e-9)


def test_a_motion_that_does_not_end_at_rest():
    """Constant rate: no inertial torque, at its ends neither, with uneven steps too."""
    m = with_inertia(exact_pendulum().mechanism)
    t = np.array([0.0, 0.1, 0.15, 0.3, 0.5, 0.6])
    np.testing.assert_allclose(play(m, t, (0.2 + 3.0 * t)[:, None]).torque, 0, atol=1e-9)


@pytest.mark.slow(reason="six seconds of motion in the engine")
def test_the_motion_of_lin2010():
    """Eq. (26): the engine's energies are those of the paper's Fig. 9, and their sum is constant."""
    m = lin2010.balanced().mechanism
    every = slice(None, None, 10)
    found = play(m, lin2010.TIMES[every], lin2010.motion()[every], SPHERE)
    assert np.ptp(found.gravity + found.springs) < 1e-9 * np.ptp(found.gravity)
    from equipoise.energy.evaluate import Potential

    ours = Potential(m)(lin2010.motion()[every]).gravity
    np.testing.assert_allclose(found.gravity, ours - ours[0], atol=1e-6 * np.ptp(ours))
    assert (found.peak[0][1:5] < found.peak[1][1:5]).all()


# What is refused ----------------------------------------------------------------------------------------------------


def test_a_missing_inertia_is_named():
    with pytest.raises(InputError, match=r"bodies.arm.inertia: motion depends on it, of 'arm': .*--radius 50mm"):
        release(exact_pendulum().mechanism)


def test_a_pose_outside_the_limits_is_named():
    m = with_inertia(pendulum())
    limited = replace(m, joints=(replace(m.joints[0], range=(-0.5, 0.5)),))
    with pytest.raises(InputError, match=r"joint 'shoulder' of body 'arm' is at 57.2958 deg, its range is -28.6479 to"):
        Engine(limited).place(np.array([1.0]))
    engine = Engine(four_bar(independent=("rocker",)), SPHERE)
    with pytest.raises(InputError, match=r"the loops of 'four-bar' do not close at rocker -1 \[rad or m\]"):
        engine.place(np.array([-1.0]))


def diverging() -> eq.Mechanism:
    m = pendulum(stiffness=1e13)
    return replace(m, bodies=(replace(m.bodies[0], mass=1e-6, inertia=(1e-12, 1e-12, 1e-12, 0, 0, 0)),))


def test_a_simulation_that_diverges_says_where():
    with pytest.raises(EngineError, match=r"diverged at .* s, first at body 'arm' .joint 'shoulder'."):
        release(diverging(), seconds=1, poses=1, control=False)


@pytest.mark.parametrize(("option", "value"), [("seconds", 0), ("tolerance", -1), ("poses", 0)])
def test_bad_values(option, value):
    with pytest.raises(InputError, match=option):
        release(with_inertia(pendulum()), **{option: value})


# The command line ---------------------------------------------------------------------------------------------------

PENDULUM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"


def test_command_line(run):
    options = ("--seconds", "1", "--poses", "2", "--radius", "50mm")
    code, text, _ = run("simulate", PENDULUM, *options)
    assert code == 0
    assert "STAYS" in text
    assert "control, 'shoulder spring' 1 % soft: drifts by" in text
    code, text, _ = run("simulate", PENDULUM, *options, "--json", "--no-control")
    found = json.loads(text)
    assert found.keys() >= {"poses", "seconds", "max_drift", "rms_drift"}
    assert (code, found["poses"], found["control"]) == (0, 2, None)
    code, text, _ = run("simulate", PENDULUM, *options, "--seconds", "0.2", "--tolerance", "1 deg")
    assert "TOO LITTLE: staying proves nothing" in " ".join(text.split())


def test_command_line_says_no(run, tmp_path):
    loose = tmp_path / "loose.yaml"
    eq.save(with_inertia(pendulum(150.0)), loose)
    code, text, _ = run("simulate", loose, "--seconds", "1", "--poses", "2")
    assert code == 1
    assert text.startswith("MOVES: 'shoulder' drifts by")


def test_command_line_motion(run, tmp_path):
    picture = tmp_path / "motion.svg"
    code, text, _ = run("simulate", PENDULUM, "--radius", "50mm", "--move", "shoulder:0:2:0:60 deg", "--plot", picture)
    assert code == 0
    assert "gravity's energy varies by" in text
    assert picture.read_text().startswith("<?xml")


FOLDER = PENDULUM.parent


@pytest.mark.parametrize(("file", "paper"), [("lee2014_table5a", "lee2014"), ("lenzo_layout_b", "lenzo2017")])
def test_command_line_motion_of_a_paper(run, file, paper):
    options = ("--radius", "50mm", "--motion", paper, "--json")
    code, text, _ = run("simulate", FOLDER / f"{file}.yaml", *options)
    found = json.loads(text)
    assert code == 0
    assert found["energy_variation"] < 1e-9 * found["gravity_variation"]
    assert all(joint["peak"] < joint["peak_without_springs"] for joint in found["joints"])


def test_command_line_motion_of_a_file(run, tmp_path):
    """Degrees and milliseconds: the same as a move."""
    t = np.linspace(0, 2, 401)
    degrees = 60 * (t / 2) ** 2 * (3 - t)
    table = tmp_path / "motion.csv"
    table.write_text(
        "shoulder [deg], time [ms]\n" + "".join(f"{a}, {1e3 * b}\n" for a, b in zip(degrees, t, strict=True))
    )
    common = ("simulate", PENDULUM, "--radius", "50mm", "--json")
    by_file = json.loads(run(*common, "--motion", table)[1])
    by_move = json.loads(run(*common, "--move", "shoulder:0:2:0:60 deg")[1])
    assert by_file["joints"][0]["peak"] == pytest.approx(by_move["joints"][0]["peak"], rel=1e-6)
    assert by_file["seconds"] == 2


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("time,knee\n0,0\n", 1, "no coordinate 'knee'"),
        ("shoulder\n0\n", 1, "expected the columns 'time' and coordinates, each once, found shoulder"),
        ("time,shoulder,shoulder\n0,0,0\n", 1, "each once"),
        ("time,shoulder [kg]\n0,0\n", 1, "column 'shoulder': expected a number"),
        ("time,shoulder\n0,0\n\n1,x\n", 4, "expected 2 numbers, found '1,x'"),
        ("time,shoulder\n0,0\n1,nan\n", 3, "must be finite"),
        ("time,shoulder\n0,0\n1,1,1\n", 3, "expected 2 numbers, found '1,1,1'"),
        ("time,shoulder\n0,0\n2,1\n1,2\n", 1, "at least three times, in increasing order"),
        ("time,shoulder\n", 1, "at least three times"),
    ],
)
def test_command_line_bad_motion_files(run, tmp_path, text, line, message):
    table = tmp_path / "motion.csv"
    table.write_text(text)
    code, out, error = run("simulate", PENDULUM, "--radius", "50mm", "--motion", table)
    assert (code, out) == (2, "")
    assert f"motion.csv:{line}" in error
    assert message in error


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "bodies.arm.inertia"),
        (("--motion", "lin2010"), "the arm of lin2010 has 'joint 1', 'one-link arm' has no such coordinate"),
        (("--motion", "lin2011"), "no motion 'lin2011'; did you mean 'lin2010'"),
        (("--motion", "absent.csv"), "absent.csv: cannot be read"),
        (("--motion", "lin2010", "--move", "shoulder:0:2:0:1"), "is instead of --move"),
        (("--radius", "-5mm"), "--radius: must be more than 0 m"),
        (("--radius", "5kg"), "--radius: expected a number"),
        (("--move", "shoulder:0:2"), "expected JOINT:START:END:FROM:TO"),
        (("--move", "knee:0:2:0:1"), "no coordinate 'knee'"),
        (("--move", "shoulder:2:1:0:1"), "must end after it starts"),
        (("--move", "shoulder:0:2:0:1 kg"), "--move: expected a number"),
        (("--plot", "x.svg"), "is of a motion"),
    ],
)
def test_command_line_refuses(run, options, message):
    code, text, error = run("simulate", PENDULUM, *options)
    assert (code, text) == (2, "")
    assert message in error


def test_the_engine_leaves_the_process_as_it_was(tmp_path, monkeypatch):
    """Its own warnings go nowhere else while it works, whoever works beside it; the hook of others is back then."""
    monkeypatch.chdir(tmp_path)
    heard: list[str] = []

    def hook(message):
        heard.append(message)

    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(hook)
    try:
        with quiet(mujoco):
            with quiet(mujoco):
                assert mujoco.get_mju_user_warning() is not hook
            assert mujoco.get_mju_user_warning() is not hook
        with ThreadPoolExecutor(4) as pool:
            list(pool.map(lambda seed: release(pendulum(), seconds=0.05, poses=2, seed=seed, radius=0.05), range(8)))
        with pytest.raises(EngineError):
            release(diverging(), seconds=1, poses=1, control=False)
        assert mujoco.get_mju_user_warning() is hook
    finally:
        mujoco.set_mju_user_warning(before)
    assert heard == []
    assert list(tmp_path.iterdir()) == []
