"""How long the viewer takes to follow a slider, for every example: scene, torques, energies and verdict."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from measure import seconds

import equipoise as eq
from equipoise.viewer.server import Viewer

EXAMPLES = Path(__file__).parents[1] / "examples" / "mechanisms"
BUDGET = 0.05  # [s]
POSES = 20


def updates() -> list[tuple[str, float]]:
    """Seconds for one update of each example, the median over poses of its first motion."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted(EXAMPLES.glob("*.yaml")):
            viewer = Viewer(eq.load(path), Path(folder) / "out.yaml", port=8300)
            frames = next(iter(viewer.panel.motions.values()), np.tile(viewer.model.q, (2, 1)))
            tasks = [lambda q=q, go=viewer.panel.go: go(q) for q in frames[1 :: max(1, len(frames) // POSES)]]
            found.append((path.stem, float(np.median(seconds(*tasks, repeat=2)))))
            viewer.close()
    return found


def main() -> None:
    for name, time in updates():
        print(f"{name}: {1e3 * time:.3g} ms for an update of the viewer, {time / BUDGET:.2g} of {1e3 * BUDGET:g} ms")


if __name__ == "__main__":
    main()
