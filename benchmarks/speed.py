"""Energy and torque of many poses: equipoise, its peers and the best C for the same job, side by side in one run.

Everything is checked to agree before it is timed. Ratios are of the least times of things that took turns.
"""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import arms
import c_kernel
import measure
import numpy as np
import peers

import equipoise as eq
from equipoise.energy import Potential
from equipoise.energy.kernel import Kernel, Tier
from equipoise.energy.stream import statistics

POSES = 1_000_000
AGREE = 1e-9  # relative; a physics engine rounds on its way
NUMPY, GENERIC, GENERATED = "equipoise, numpy", "equipoise, one kernel for all", "equipoise, generated"
PINOCCHIO, MUJOCO, C = "Pinocchio, gravity alone", "MuJoCo, lean calls", "C for this arm"
REFERENCE = "numpy, one by one"
JOINTS = (2, 3, 4, 6, 8, 12, 16, 20, 24)
SPRINGS = (0, 1, 2, 4, 8, 16, 32)
CONFIGURATIONS = (10**3, 10**4, 10**5, 10**6, 10**7)


@dataclass(frozen=True)
class Rate:
    """Poses per second [million] of one contestant on `threads`."""

    name: str
    threads: int
    million: float


def rates() -> list[Rate]:
    """The race on the arm with five springs."""
    mechanism = arms.ur5(5)
    kernel, potential = Kernel(mechanism), Potential(mechanism)
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (POSES, 6))
    known = potential.reference(q[:2000])
    columns = np.asfortranarray(q)
    out = kernel.room(POSES)
    out[:] = 0.0
    tasks: dict[tuple[str, int], tuple[int, Callable[[], object]]] = {}

    def agree(name: str, torque: np.ndarray, expected: np.ndarray) -> None:
        difference = np.abs(torque[:2000] - expected).max() / np.abs(expected).max()
        if not difference < AGREE:
            raise SystemExit(f"{name} disagrees with the reference by {difference:.2g} of the largest torque")

    mine: tuple[tuple[str, Tier, int], ...] = (
        (NUMPY, "numpy", 200_000),
        (GENERIC, "generic", POSES),
        (GENERATED, "generated", POSES),
    )
    for threads in (1, 2):
        for name, tier, count in mine:
            run = partial(kernel, columns[:count], out=out[:, :count], threads=threads, tier=tier)
            agree(name, run().torque, known.torque)
            tasks[name, threads] = count, run
        few = q[:100_000]
        torque, run = peers.pinocchio(arms.UR5, few, threads)
        agree(PINOCCHIO, torque.T, known.gravity_torque)
        tasks[PINOCCHIO, threads] = len(few), run
        torque, run = peers.mujoco_lean(mechanism, few[:40_000], threads)
        agree(MUJOCO, torque, known.torque)
        tasks[MUJOCO, threads] = 40_000, run
    tasks[REFERENCE, 1] = 4096, partial(potential.reference, q[:4096])
    compiled = c_kernel.compiled(min(kernel.programs.values(), key=lambda program: program.cost))
    if compiled is None:
        print("no C compiler: the C kernel is left out")
    else:
        rows = np.ascontiguousarray(q.T)
        compiled(rows, out)
        agree(C, out[1:].T, known.torque)
        tasks[C, 1] = POSES, partial(compiled, rows, out)
        tasks[C, 2] = POSES, partial(_halves, compiled, rows, out)
    times = measure.seconds(*(run for _, run in tasks.values()), repeat=9, best=True)
    return [
        Rate(name, threads, count / t / 1e6)
        for ((name, threads), (count, _)), t in zip(tasks.items(), times, strict=True)
    ]


def _halves(run: Callable[[np.ndarray, np.ndarray], None], q: np.ndarray, out: np.ndarray) -> None:
    half = q.shape[1] // 2 // 8 * 8
    parts = ((q[:, :half], out[:, :half]), (q[:, half:], out[:, half:]))
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda part: run(*part), parts))


def limits() -> list[tuple[str, float]]:
    """What the arithmetic and the memory of one core allow [million poses per second]."""
    kernel = Kernel(arms.ur5(5))
    program = min(kernel.programs.values(), key=lambda program: program.cost)
    seconds = (program.cost + 6 * measure.SINCOS) / measure.operations()  # nothing waits for anything
    moved = 8 * (6 + 7)  # what is written goes past the caches
    return [("arithmetic, sines included", 1e-6 / seconds), ("memory", measure.bandwidth() / moved / 1e6)]


def _time_of(mechanism: eq.Mechanism, poses: int) -> float:
    """Nanoseconds per pose of the generated kernel on one core."""
    kernel = Kernel(mechanism)
    q = np.asfortranarray(np.random.default_rng(0).uniform(-np.pi, np.pi, (poses, kernel.tree.n)))
    out = kernel.room(poses)
    out[:] = 0.0
    repeat = 25 if poses <= 10**5 else 7
    return 1e9 * measure.cpu_seconds(lambda: kernel(q, out=out, tier="generated"), repeat) / poses


def growth() -> dict[str, list[tuple[int, float]]]:
    """Nanoseconds per pose over the number of joints, of springs on the arm, and of configurations."""
    return {
        "joints": [(n, _time_of(arms.chain(n), 100_000)) for n in JOINTS],
        "springs": [(m, _time_of(arms.ur5(m), 100_000)) for m in SPRINGS],
        "configurations": [(N, _time_of(arms.ur5(5), N)) for N in CONFIGURATIONS],
    }


def slope(points: list[tuple[int, float]]) -> float:
    """Of the logarithms."""
    x, y = np.log(np.array(points)).T
    return float(np.polyfit(x, y, 1)[0])


STREAM = """
import sys, time
from pathlib import Path
sys.path.insert(0, "benchmarks")
import arms, numpy as np
from equipoise.energy.kernel import Kernel
from equipoise.energy.stream import statistics
def memory():  # of this process alone; a child's ru_maxrss begins with its parent's
    line, = (x for x in Path("/proc/self/status").read_text().splitlines() if x.startswith("VmHWM"))
    return int(line.split()[1]) / 1024
mechanism = arms.ur5(5)
statistics(mechanism, 8)
at_first = memory()
Kernel.of(mechanism)(np.zeros((8, 6)), tier="generated")
compiled = memory()
start = time.perf_counter()
statistics(mechanism, int(sys.argv[1]), threads=2)
print(time.perf_counter() - start, compiled - at_first, memory() - compiled)
"""


def streaming(poses: int) -> tuple[float, float, float]:
    """Seconds for so many streamed poses on two threads; MiB that the compiler takes before, and the poses then."""
    done = subprocess.run([sys.executable, "-c", STREAM, str(poses)], capture_output=True, text=True, check=True)
    seconds, compiler, more = map(float, done.stdout.split())
    return seconds, compiler, more


def starting() -> list[tuple[str, float]]:
    """Seconds to start, in new processes; the files that compiled kernels are kept in are there already."""
    head = "import sys; sys.path.insert(0, 'benchmarks'); import arms, numpy as np; "
    call = head + "from equipoise.energy.kernel import Kernel; k = Kernel(arms.ur5(5)); q = np.zeros((8, 6)); "
    clock = "import time; t = time.perf_counter(); {}; print(time.perf_counter() - t)"
    commands = {"import equipoise": clock.format("import equipoise")} | {
        f"first call, {tier}": call + clock.format(f"k(q, tier='{tier}')") for tier in ("numpy", "generic", "generated")
    }
    found = []
    for what, code in commands.items():
        command = [sys.executable, "-c", code]
        runs = [subprocess.run(command, capture_output=True, text=True, check=True).stdout for _ in range(3)]
        found.append((what, min(map(float, runs))))
    for arguments in (["--help"], ["check", "examples/mechanisms/pendulum.yaml"]):
        name = f"equipoise {' '.join(Path(x).name for x in arguments)}, the whole process on one core"
        found.append((name, min(processor_seconds(arguments) for _ in range(3))))
    return found


def processor_seconds(arguments: list[str]) -> float:
    """Of a new process that runs the command line."""

    def used() -> float:
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before = used()
    subprocess.run([sys.executable, "-m", "equipoise", *arguments], capture_output=True, check=True)
    return used() - before


def sanity() -> None:
    """Streamed statistics are those of the poses."""
    mechanism = arms.ur5(5)
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (100_000, 6))
    torque = Potential(mechanism).reference(q[:5000]).torque
    found = statistics(mechanism, [q[:5000]])
    np.testing.assert_allclose(found.max, np.abs(torque).max(axis=0), rtol=1e-10, atol=1e-10)
