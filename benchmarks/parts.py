"""Every part of a made-up list, moved into place by Nelder and Mead from many starts, beside what `stock` finds.

    .venv/bin/python benchmarks/parts.py [--starts 6] [--seconds 60]

0.3 kg at 0.3 m over +-70 deg, an extension spring hooked within 20 mm of the pivot on the lever, within 250 mm on the
frame. The search here shares nothing with the library's but the margins: in the plane, a spring is its two distances
from the pivot and the angle between them.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from scipy.optimize import minimize

import equipoise as eq
from equipoise.hardware import Choice, Limits, Stock, choose_parts
from equipoise.hardware.stock.made_up import made_up_catalogue
from equipoise.hardware.stock.part import endurance

M, L, TURN, LEVER, FRAME = 0.3, 0.3, np.radians(70), 0.02, 0.25
Q = np.linspace(-TURN, TURN, 61)
LOAD = M * 9.81 * L * np.cos(Q)


def arm() -> eq.Mechanism:
    """The load on its pivot."""
    return eq.Mechanism(
        name="arm",
        bodies=(eq.Body("arm", M, (L, 0.0, 0.0)),),
        joints=(eq.Joint("pivot", "revolute", "world", "arm", axis=(0.0, -1.0, 0.0), range=(-TURN, TURN)),),
    )


def peak(x: np.ndarray, part: Stock, limits: Limits) -> float:
    """Of the load's peak what is left, and how far margins are missed, at distances and angle x (3,)."""
    r, h = LEVER * np.tanh(x[0]), FRAME * np.tanh(x[1])
    s = np.sqrt(r**2 + h**2 - 2 * r * h * np.cos(x[2] - Q))
    force = part.initial_tension + part.rate * (s - part.free_length)
    top, bottom = endurance(part, limits)
    over = max(0.0, part.free_length - s.min()) * part.rate + max(0.0, force.max() - part.max_force / limits.safety)
    over += max(0.0, top * force.max() - bottom * force.min() - 1)
    left = LOAD - force * r * h * np.sin(x[2] - Q) / s
    return float(np.abs(left).max() + 10 * over) / (M * 9.81 * L)


def main() -> None:
    asked = argparse.ArgumentParser()
    asked.add_argument("--starts", type=int, default=6)
    asked.add_argument("--seconds", type=float, default=60.0)
    given = asked.parse_args()
    parts, limits, rng = made_up_catalogue(1300, 0, "extension"), Limits(), np.random.default_rng(0)
    where = {"pairs": [("world", "arm")], "regions": {"arm": LEVER, "world": FRAME}}
    found = choose_parts(arm(), parts, Choice(seconds=given.seconds), **where)
    print(f"stock: {100 * found.left:.4f} % of the peak left, {found.parts[0].part}, {found.polished} polished")
    began, best = time.process_time(), (np.inf, "")
    for part in parts:
        for _ in range(given.starts):
            start = [rng.choice([-1, 1]) * rng.uniform(0.1, 1.5), rng.uniform(0.3, 2), rng.uniform(-np.pi, np.pi)]
            fine = {"maxiter": 500, "xatol": 1e-9, "fatol": 1e-9}
            one = minimize(peak, start, (part, limits), "Nelder-Mead", options=fine)
            best = min(best, (float(one.fun), part.part))
    print(f"every part: {100 * best[0]:.4f} %, {best[1]}, {time.process_time() - began:.0f} s of processor time")


if __name__ == "__main__":
    main()
