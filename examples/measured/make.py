"""Write the measurements of the tutorial: a simulated build of the pendulum, before its screws are turned and after.

Its spring is 4 % too soft and 3 mm too long, its arm weighs what the file says, its sensor scatters by 10 mN m.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from equipoise import Mechanism, load
from equipoise.energy.evaluate import Potential
from equipoise.robust.identify import identify

FOLDER = Path(__file__).parent
DRAWN = FOLDER.parent / "mechanisms" / "pendulum.yaml"
POSES, NOISE = 36, 0.01  # over a whole turn; [N m]


def build() -> Mechanism:
    """The arm as it was built."""
    drawn = load(DRAWN)
    (spring,) = drawn.springs
    return drawn.with_springs([replace(spring, stiffness=0.96 * spring.stiffness, free_length=0.003)])


def turned(real: Mechanism, file: Path) -> Mechanism:
    """The build after the turns that its measurement asks for."""
    (spring,) = real.springs
    for turn in identify(load(DRAWN), str(file), known=["masses"]).turns:
        if turn.what == "tighten":
            changed: dict[str, Any] = {"free_length": spring.free_length - turn.by}
        else:
            p = np.array(getattr(spring, turn.what))
            changed = {turn.what: tuple((p * (1 + turn.by / np.linalg.norm(p))).tolist())}
        spring = replace(spring, **changed)
    return real.with_springs([spring])


def measured(real: Mechanism, seed: int) -> str:
    """What a torque sensor at the shoulder reads, pose by pose."""
    q = np.linspace(-np.pi, np.pi, POSES, endpoint=False)[:, None]
    torque = Potential(real)(q).torque[:, 0] + NOISE * np.random.default_rng(seed).normal(size=POSES)
    rows = [f"{angle:.1f},{load:.4f}" for angle, load in zip(np.degrees(q[:, 0]), torque, strict=True)]
    return "\n".join(["shoulder [deg],torque:shoulder [N m]", *rows]) + "\n"


def main(folder: Path = FOLDER) -> None:
    real = build()
    (folder / "before.csv").write_text(measured(real, 1))
    (folder / "after.csv").write_text(measured(turned(real, folder / "before.csv"), 2))


if __name__ == "__main__":
    main()
