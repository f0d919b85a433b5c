"""The compiled kernel against the reference, in every tier, on every kind of mechanism."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from campaign import campaign
from hypothesis import given, settings
from hypothesis import strategies as st
from loop_zoo import four_bar
from random_mechanisms import random_mechanism, random_poses
from robots import robot
from zoo import ZOO

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.kernel import Kernel
from equipoise.energy.kernel.generated import Generated
from equipoise.energy.kernel.kernel import CACHE, CHUNK, LINE, TIERS
from equipoise.energy.kernel.trace import Trace
from equipoise.model.errors import UnsupportedError
from equipoise.model.masses import lumped_masses
from equipoise.model.mechanism import Mechanism

ROUNDING = 1e-13
FAR = 1e6  # [rad]
SOURCE = Path(eq.__file__).parents[1]


def disagreement(mechanism: Mechanism, q: np.ndarray, tier: str | None) -> float:
    """The largest difference between kernel and reference, as a share of what adds up to the number."""
    kernel = Kernel(mechanism)
    state, parts = Potential(mechanism).reference(q), kernel.parts(q, tier=tier)  # type: ignore[arg-type]
    total = kernel(q, tier=tier)  # type: ignore[arg-type]
    slides = np.abs(kernel.tree.values(q)[:, ~kernel.tree.rotates]).sum(axis=1).max(initial=0)
    reach = sum(np.abs(j.xyz).sum() for j in mechanism.joints) + slides + 1
    pull = sum(s.stiffness * (reach + s.free_length) * reach for s in mechanism.springs)
    load = sum(mass for _, mass, _ in lumped_masses(mechanism)) * np.linalg.norm(mechanism.gravity) * reach + 1e-9
    ratio = np.abs(kernel.tree.C).max(initial=1)  # a coupling multiplies torque
    return max(
        float(np.abs(found - known).max(initial=0)) / scale
        for found, known, scale in (
            (parts.gravity, state.gravity, load),
            (parts.path, state.path, reach),
            (parts.gravity_torque, state.gravity_torque, load * ratio),
            (parts.spring_torque, state.spring_torque, (pull + load) * ratio),
            (total.energy, state.energy, pull + load),
            (total.torque, state.torque, (pull + load) * ratio),
        )
    )


@pytest.mark.parametrize("tier", [*TIERS, None])
@pytest.mark.parametrize("seed", range(25))
def test_random_mechanisms(seed: int, tier: str | None) -> None:
    m = random_mechanism(seed)
    assert disagreement(m, random_poses(m, 19, seed), tier) < ROUNDING


@campaign(20_000, block=250)
def test_many_random_mechanisms(seeds: range) -> None:
    for seed in seeds:
        m = random_mechanism(seed)
        q = random_poses(m, 4, seed)
        assert disagreement(m, q, "generic") < ROUNDING, seed
        if seed % 10 == 0:  # each is compiled
            assert disagreement(m, q, "generated") < ROUNDING, seed


@pytest.mark.parametrize("tier", TIERS)
@pytest.mark.parametrize("seed", range(25))
def test_angles_far_away(seed: int, tier: str) -> None:
    """Without couplings: theirs are sums and products, which alone lose more than the sines at 1e6 rad."""
    m = replace(random_mechanism(seed, kinds=("revolute", "spherical", "fixed", "parallelogram")), couplings=())
    q = np.random.default_rng(seed).uniform(-FAR, FAR, (40, len(m.coordinates)))
    q[:20, :] = np.rint(q[:20, :])
    q[-1] = FAR
    assert disagreement(m, q, tier) < ROUNDING


@pytest.mark.parametrize("tier", TIERS)
def test_axes_parallel_but_for_rounding(tier: str) -> None:
    """Right angles composed in several ways: twists of 5e-16 rad, whose direction is noise."""
    m = random_mechanism(3141)
    assert disagreement(m, random_poses(m, 3), tier) < ROUNDING


@pytest.mark.parametrize("tier", TIERS)
def test_farther_than_the_compiled_sines_reach(tier: str) -> None:
    m = robot("ur5")
    q = random_poses(m, 50)
    q[7] *= 1e9
    assert disagreement(m, q, tier) < ROUNDING


@pytest.mark.parametrize("tier", ["generic", "generated"])
def test_sine_and_cosine(tier: str) -> None:
    """Below 2e-15 absolute within a turn and beyond, at multiples of half a right angle above all."""
    wheel = eq.Mechanism(
        "wheel",
        (eq.Body("wheel", 1.0, (1.0, 0.0, 0.0)),),
        (eq.Joint("turn", "revolute", "world", "wheel", axis=(0, -1, 0)),),
        gravity=(0.0, 0.0, -1.0),
    )
    near = (np.arange(-16, 17)[:, None] * np.pi / 4 + np.linspace(-1e-3, 1e-3, 201)).ravel()
    angles = np.concatenate([np.linspace(-2 * np.pi, 2 * np.pi, 200_001), near, np.linspace(-FAR, FAR, 100_001)])
    kernel = Kernel(wheel)
    found = kernel(angles[:, None], tier=tier)  # type: ignore[arg-type]
    assert np.abs(found.energy - np.sin(angles)).max() < 2e-15
    assert np.abs(found.torque[:, 0] - np.cos(angles)).max() < 2e-15
    assert kernel(np.array([[0.0]] * 3), tier=tier).energy[0] == 0.0  # type: ignore[arg-type]


@pytest.mark.parametrize("tier", TIERS)
@pytest.mark.parametrize("name", list(ZOO))
def test_zoo(name: str, tier: str) -> None:
    m = ZOO[name]().mechanism
    assert disagreement(m, random_poses(m, 33), tier) < ROUNDING


@pytest.mark.parametrize("tier", TIERS)
def test_what_is_no_number_spoils_its_pose_only(tier: str) -> None:
    m = random_mechanism(4)
    n = len(m.coordinates)
    q = random_poses(m, 300)
    good = Kernel(m)(q, tier=tier)  # type: ignore[arg-type]
    bad = {3: np.nan, 64: np.inf, 65: -np.inf, 299: np.nan}
    for i, (row, value) in enumerate(bad.items()):
        q[row, i % n] = value
    found = Kernel(m)(q, tier=tier)  # type: ignore[arg-type]
    assert np.isnan(found.energy[list(bad)]).all()
    assert np.isnan(found.torque[list(bad)]).all()
    rest = np.setdiff1d(np.arange(300), list(bad))
    np.testing.assert_allclose(found.energy[rest], good.energy[rest], rtol=1e-13)
    np.testing.assert_allclose(found.torque[rest], good.torque[rest], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("tier", TIERS)
def test_coordinates_that_do_nothing_count_too(tier: str) -> None:
    """A turn about the vertical has no effect on anything, but NaN is NaN."""
    m = replace(robot("ur5"), springs=())
    q = random_poses(m, 10)
    q[2, 0] = np.nan
    assert np.isnan(Kernel(m)(q, tier=tier).torque[2]).all()  # type: ignore[arg-type]


@pytest.mark.parametrize("tier", TIERS)
def test_layouts_sizes_threads_and_out_change_nothing(tier: str) -> None:
    m, kernel = random_mechanism(11), Kernel(random_mechanism(11))
    q = random_poses(m, 2 * CHUNK + 7)
    expected = kernel(q, tier=tier)  # type: ignore[arg-type]
    out = np.empty((1 + len(m.coordinates), len(q)))
    variants = [
        (np.asfortranarray(q), {}),
        (np.repeat(q, 2, axis=0)[::2], {}),
        (q, {"threads": 2}),
        (np.asfortranarray(q), {"threads": 3, "out": out}),
    ]
    for poses, options in variants:
        found = kernel(poses, tier=tier, **options)  # type: ignore[arg-type]
        np.testing.assert_array_equal(found.energy, expected.energy)
        np.testing.assert_array_equal(found.torque, expected.torque)
    np.testing.assert_array_equal(out[0], expected.energy)
    for count in (0, 1, 7, 8, 9):
        few = kernel(q[:count], tier=tier)  # type: ignore[arg-type]
        np.testing.assert_array_equal(few.torque, expected.torque[:count])


@pytest.mark.parametrize("tier", TIERS)
def test_single_precision(tier: str) -> None:
    m = robot("ur5")
    q = random_poses(m, 100)
    exact, found = Kernel(m)(q), Kernel(m)(q.astype(np.float32), tier=tier)  # type: ignore[arg-type]
    assert found.energy.dtype == found.torque.dtype == np.float32
    np.testing.assert_allclose(found.torque, exact.torque, atol=2e-5 * np.abs(exact.torque).max())


def test_loops_and_wrong_shapes_are_refused() -> None:
    with pytest.raises(UnsupportedError, match="loops"):
        Kernel(four_bar())
    kernel = Kernel(robot("ur5"))
    with pytest.raises(ValueError, match=r"expected \(N, 6\)"):
        kernel(np.zeros((3, 5)))
    with pytest.raises(ValueError, match="out has shape"):
        kernel(np.zeros((3, 6)), out=np.empty((3, 7)))


def test_past_the_caches() -> None:
    """Large results are written another way where they are aligned: the same numbers, also at the ends of parts."""
    kernel = Kernel(robot("ur5"))
    N = CACHE // (8 * 7) + 13
    q = np.asfortranarray(np.random.default_rng(0).uniform(-np.pi, np.pi, (N, 6)))
    room = kernel.room(N)
    assert room.ctypes.data % LINE == room.strides[0] % LINE == 0
    found = kernel(q, out=room, threads=2, tier="generated")
    known = kernel(q, out=np.empty((7, N + 1))[:, 1:], tier="generated")  # aligned nowhere
    np.testing.assert_array_equal(found.energy, known.energy)
    np.testing.assert_array_equal(found.torque, known.torque)
    generated = kernel._total._started["generated", False]
    assert isinstance(generated, Generated)
    assert set(generated._forms) == {"streamed", "rows"}


def test_many_poses_get_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = Kernel(robot("ur5"))
    assert kernel._total._choice(False) == "numpy"
    kernel._total._work = 10**7
    assert kernel._total._choice(False) == "generated"
    monkeypatch.setattr("equipoise.energy.kernel.kernel.find_spec", lambda name: None)
    assert kernel._total._choice(False) == "numpy"


def test_cheaper_recursion_is_chosen() -> None:
    short, far = Kernel(ZOO["lenzo_spherical"]().mechanism), Kernel(many_springs_from_the_ground())
    costs = {name: program.cost for name, program in short.programs.items()}
    assert costs["local"] < costs["world"]
    costs = {name: program.cost for name, program in far.programs.items()}
    assert costs["world"] < costs["local"]
    assert disagreement(far.mechanism, random_poses(far.mechanism, 20), "numpy") < ROUNDING


def many_springs_from_the_ground() -> Mechanism:
    rng = np.random.default_rng(0)
    names = [f"b{i}" for i in range(10)]
    joints = [
        eq.Joint(f"j{i}", "revolute", parent, child, xyz=(0.3, 0, 0.1), axis=tuple(rng.uniform(-1, 1, 3)))
        for i, (parent, child) in enumerate(zip(["world", *names], names, strict=False))
    ]
    springs = [eq.Spring(f"s{i}", "world", (0.1, 0.2, i), name, (0.1, 0, 0.1), 50.0) for i, name in enumerate(names)]
    bodies = tuple(eq.Body(name, 1.0, (0.1, 0, 0)) for name in names)
    return Mechanism("tower", bodies, tuple(joints), springs=tuple(springs))


def _in_a_new_process(cache: Path | str) -> str:
    code = (
        "import numpy as np, equipoise as eq\n"
        "from equipoise.energy.kernel import Kernel\n"
        "joint = eq.Joint('j', 'revolute', 'world', 'b', axis=(0, -1, 0))\n"
        "m = eq.Mechanism('m', (eq.Body('b', 1.0, (1, 0, 0)),), (joint,))\n"
        "print(Kernel(m)(np.array([[0.0], [1.0]]), tier='generic').torque[0, 0])"
    )
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache), "PYTHONPATH": str(SOURCE)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    return done.stdout.strip() or done.stderr


@pytest.mark.slow(reason="compiles in new processes")
def test_processes_may_compile_at_the_same_time(tmp_path: Path) -> None:
    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(_in_a_new_process, [tmp_path] * 3)) == ["9.81"] * 3
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")}
    assert kept
    assert _in_a_new_process(tmp_path) == "9.81"
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nbc")} == kept  # loaded, not compiled


@pytest.mark.slow(reason="compiles in a new process")
def test_nowhere_to_keep_it() -> None:
    assert _in_a_new_process("/proc/nowhere") == "9.81"


@given(
    st.lists(st.sampled_from([0.0, 1.0, -1.0, 2.0, 0.5]), min_size=1, max_size=4),
    st.lists(st.tuples(st.sampled_from("+-*"), st.integers(0, 30), st.integers(0, 30)), min_size=1, max_size=25),
)
@settings(max_examples=60, deadline=None)
def test_programs_compute_what_was_written_down(constants: list[float], steps: list[tuple[str, int, int]]) -> None:
    from equipoise.energy.kernel import by_numpy

    x = np.array([[0.75], [-1.25]])  # exact in binary, and so is nearly all that follows
    t = Trace()
    symbols, numbers = [t.input(0), t.input(1), *constants], [*x[:, 0], *constants]
    for operation, i, j in steps:
        a, b = i % len(symbols), j % len(symbols)
        symbols.append({"+": t.add, "-": t.sub, "*": t.mul}[operation](symbols[a], symbols[b]))
        u, v = numbers[a], numbers[b]
        numbers.append(u + v if operation == "+" else u - v if operation == "-" else u * v)
        if abs(numbers[-1]) > 1e6:
            symbols[-1], numbers[-1] = 1.0, 1.0
    out = np.empty((len(symbols), 1))
    by_numpy.run(t.program(symbols), x, out)
    np.testing.assert_allclose(out[:, 0], numbers, rtol=1e-9, atol=1e-9)
