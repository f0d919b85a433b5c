"""The table of the README on real arms by default: how near the bound, with how many springs, and how quickly.

`python benchmarks/defaults.py [--span N] [FILE ...]`: the example robots, those of the package example-robot-data where
it is installed, and more files.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Iterator
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import equipoise as eq
from equipoise.model.errors import EquipoiseWarning

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"
EXAMPLES = {"UR5": "ur5", "UR10": "ur10", "Panda": "panda", "xArm7": "xarm7"}
PACKAGED = {"Kinova": "kinova.urdf", "SO-100": "so100.urdf"}


def human_arm() -> eq.Mechanism:
    """The right arm of the human model, its shoulder fixed."""
    body = eq.load(ROBOTS / "human.urdf")
    names = {b.name for b in body.bodies if b.name.startswith(("right_upperarm", "right_lowerarm", "right_hand"))}
    joints = (j for j in body.joints if j.child in names)
    return eq.Mechanism(
        "human arm",
        tuple(b for b in body.bodies if b.name in names),
        tuple(j if j.parent in names else replace(j, parent="world") for j in joints),
        gravity=(0.0, -9.81, 0.0),
    )


def robots() -> Iterator[tuple[str, eq.Mechanism]]:
    for title, name in EXAMPLES.items():
        yield title, eq.load(ROBOTS / f"{name}.urdf")
    yield "human arm", human_arm()
    try:
        files = metadata.distribution("example-robot-data").files or []
    except metadata.PackageNotFoundError:
        return
    for title, name in PACKAGED.items():
        for file in files:
            if file.name == name:
                yield title, eq.load(Path(str(file.locate())))


def main() -> None:
    parser = argparse.ArgumentParser(description="Real arms by default")
    parser.add_argument("files", nargs="*", type=Path, help="more robots")
    parser.add_argument("--span", type=int, default=2)
    args = parser.parse_args()
    warnings.simplefilter("ignore", EquipoiseWarning)
    eq.design(ROBOTS.parent / "mechanisms" / "pendulum.yaml")  # what is imported once is not counted
    heads = ("robot", "joints", "unbalanced rms", "bound", "reached", "springs", "stiffest [N/m]", "processor time [s]")
    print("|", " | ".join(heads), "|\n" + "|---" * len(heads) + "|")
    for title, mechanism in [*robots(), *((path.stem, eq.load(path)) for path in args.files)]:
        start = time.process_time()
        design = eq.design(mechanism, span=args.span)
        seconds = time.process_time() - start
        bound = "-" if design.bound is None else f"{100 * design.bound / design.unbalanced:.4g} %"
        reached = f"{100 * design.residual / design.unbalanced:.4g} %"
        stiffest = max((spring.strength[0] for spring in design.mechanism.springs), default=0.0)
        cells = (
            title, len(mechanism.coordinates), f"{design.unbalanced:.4g} N m", bound, reached,
            len(design.mechanism.springs), f"{stiffest:.4g}", f"{seconds:.2f}",
        )  # fmt: skip
        print("|", " | ".join(map(str, cells)), "|", flush=True)


if __name__ == "__main__":
    main()
