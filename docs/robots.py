"""Renew the table of docs/robot-files.md: every robot file of three packages, read or refused and why."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
import test_robot_files as files
from engine import Engine

from equipoise.energy import Potential
from equipoise.kinematics import Tree
from equipoise.kinematics.sampling import sample

FORCES = ("stiffness", "gravcomp", "wind", "plugin")  # with one of these left out, the engine's torques are others
PAGE, MARK = Path(__file__).with_name("robot-files.md"), "<!-- robots -->"
HELD = "held with --base fixed"
HEAD = ("file", "", "coordinates", "read in [ms]", "largest torque", "difference", "said")


def row(path: Path) -> tuple[str, ...] | None:
    """Of one file; None of a part that holds no robot."""
    start = time.perf_counter()
    m, said = files.load(path)
    if m is None and any("free" in line for line in said):
        m, said = files.load(path, base="fixed")
        said = [HELD, *said]
    seconds = time.perf_counter() - start
    package = next((part for part in path.parts if part.startswith("gymnasium")), "example-robot-data")
    name = f"{package.replace('_', '-')}: {path.parent.name}/{path.name}"
    if m is None:
        if any("does not compile" in line or "<config>" in line for line in said):
            return None
        return name, "refused", "", "", "", "", said[-1]
    tree = Tree.of(m)
    if not tree.n and path.suffix == ".xml":
        return None
    q = sample(tree, 5, 1) if tree.n else np.zeros((5, 0))
    torque = Potential(m)(q).torque
    ours = [line.removeprefix(f"{path}: ").split(": ", 1)[-1] for line in said if str(path) in line or line == HELD]
    notes = "; ".join(dict.fromkeys([*ours, *(["inertias that look wrong"] if len(said) > len(ours) else [])]))
    difference = ""
    if path.suffix == ".urdf" or not any(force in line for line in said for force in FORCES):
        other = files.gravity_by_pinocchio(path, m, q) if path.suffix == ".urdf" else Engine(path, m).torque(q)
        largest = max(1.0, float(np.abs(other).max(initial=0)))
        difference = f"{float(np.abs(torque - other).max(initial=0)) / largest:.0e}"
    largest = f"{float(np.abs(torque).max(initial=0)):.3g}"
    return name, "read", str(tree.n), f"{1e3 * seconds:.0f}", largest, difference, notes


def main() -> None:
    """Write the table after the mark."""
    for path in (files.URDF[0], files.MJCF[0]):
        files.load(path)  # what is imported once is not counted
    rows = [found for path in (*files.URDF, *files.MJCF) if (found := row(path)) is not None]
    count = sum(found[1] == "read" for found in rows)
    lines = [HEAD, ("---",) * len(HEAD), *rows]
    table = "\n".join("| " + " | ".join(cell.replace("|", "/") for cell in line) + " |" for line in lines)
    before = PAGE.read_text().split(MARK)[0]
    PAGE.write_text(f"{before}{MARK}\n\n{count} of {len(rows)} are read.\n\n{table}\n")
    print(f"{count} of {len(rows)} are read")


if __name__ == "__main__":
    main()
