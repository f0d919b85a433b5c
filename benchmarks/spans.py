"""The table of the README: the least torque that any springs leave, by robot and span."""

from __future__ import annotations

import warnings
from pathlib import Path

import equipoise as eq
from equipoise.model.errors import EquipoiseWarning
from equipoise.synthesis import Problem
from equipoise.synthesis.convex.block_sets import FEASIBLE
from equipoise.synthesis.convex.least_squares_form import build
from equipoise.synthesis.convex.semidefinite import least_rms

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"
CASES = {"UR5": ("ur5", 0.15), "UR10": ("ur10", 0.2), "Panda": ("panda", 0.15), "xArm7": ("xarm7", 0.15)}
SPANS = (1, 2, 3, 4, 5, 7)


def main() -> None:
    warnings.simplefilter("ignore", EquipoiseWarning)
    print("| robot | " + " | ".join(f"span {span}" for span in SPANS) + " |")
    print("|---|" + "---|" * len(SPANS))
    for title, (name, radius) in CASES.items():
        mechanism = eq.load(ROBOTS / f"{name}.urdf")
        cells: list[str] = []
        for span in SPANS:
            if cells and cells[-1] in ("exact", ""):
                cells.append("")  # more pairs only help
                continue
            share = least_rms(build(Problem.of(mechanism, span=span, radius=radius, unlimited=True))).value
            cells.append("exact" if share < FEASIBLE else f"{100 * share:.2g} %")
        print(f"| {title} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
