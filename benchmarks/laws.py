"""What a law costs: five springs of each on the UR5, compared with five of zero free length.

Each is checked against the slow sum before it is timed. Run with: python benchmarks/laws.py
"""

from __future__ import annotations

from functools import partial

import arms
import measure
import numpy as np

import equipoise as eq
from equipoise.energy.evaluate import Potential
from equipoise.energy.kernel import Kernel

POSES = 200_000
LAWS = {
    "extension": eq.laws.Extension(900.0, 0.3, 3.0),
    "compression": eq.laws.Compression(900.0, 0.9),
    "gas": eq.laws.Gas(200.0, 1.2, 0.1, progression=1.3),
    "constant": eq.laws.ConstantForce(20.0),
    "table of 6 points": eq.laws.Table(tuple((0.2 * i, float(i**1.5)) for i in range(1, 7))),
    "free length": eq.laws.Linear(900.0, 0.1),
}


def main() -> None:
    plain = arms.ur5(5)
    q = np.asfortranarray(np.random.default_rng(0).uniform(-np.pi, np.pi, (POSES, 6)))
    robots = {"zero free length": plain}
    for name, law in LAWS.items():
        ends = ((s.name, s.body_a, s.p_a, s.body_b, s.p_b) for s in plain.springs)
        robots[name] = plain.with_springs(eq.LineElement(*own, law) for own in ends)
    tasks = []
    for name, robot in robots.items():
        kernel, some = Kernel(robot), q[:500]
        expected = Potential(robot).reference(some).torque
        found = kernel(some, tier="generated").torque
        if not np.abs(found - expected).max() < 1e-10 * np.abs(expected).max():
            raise SystemExit(f"{name} disagrees with the slow sum")
        tasks.append(partial(kernel, q, out=kernel.room(POSES), tier="generated"))
    times = measure.seconds(*tasks, repeat=40, best=True)
    for name, seconds in zip(robots, times, strict=True):
        print(f"{name:20} {POSES / seconds / 1e6:6.1f} M poses/s  {times[0] / seconds:5.2f} of zero free length")


if __name__ == "__main__":
    main()
