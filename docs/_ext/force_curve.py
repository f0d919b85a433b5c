"""The force of the first spring of a file over its length or angle: ``force_curve.py FILE.yaml OUT.svg``.

What the workspace uses is thick; a dashed line is where the spring goes slack or must not go.
"""

from __future__ import annotations

import sys
import warnings
from math import degrees

import matplotlib as mpl
import numpy as np

import equipoise as eq


def main(file: str, out: str) -> None:
    mpl.use("svg")
    from matplotlib import pyplot as plt

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        balance = eq.check(file, samples=200)
    spring, (low, high) = balance.mechanism.springs[0], balance.use[0].path
    factor, unit = (1e3, "mm") if spring.path_unit == "m" else (degrees(1), "deg")
    figure, axes = plt.subplots(figsize=(5.2, 2.6), layout="constrained")
    wide, used = np.linspace(low - 0.15 * (high - low), high + 0.15 * (high - low), 400), np.linspace(low, high, 400)
    axes.plot(factor * wide, spring.law.pull(wide), color="#9aa5b1", linewidth=1.2)
    axes.plot(factor * used, spring.law.pull(used), color="#d55e00", linewidth=2.6)
    for state in spring.law.states:
        if wide[0] < state.beyond < wide[-1]:
            axes.axvline(factor * state.beyond, color="#3a4552", linewidth=1.0, linestyle="--")
    axes.axhline(0, color="#3a4552", linewidth=0.6)
    axes.set_xlabel(f"{'length' if unit == 'mm' else 'angle'} [{unit}]")
    axes.set_ylabel(f"{'pull' if unit == 'mm' else 'torque'} [{spring.force_unit}]")
    figure.savefig(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
