"""It stays where you leave it: let go at rest in random poses, undamped, and see how far it moves.

A mechanism that only seems to stay proves nothing. So the same poses are released once more with one spring a little
soft, the one whose weakness the joints feel most: that must move.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ..io import Source, loaded
from ..kinematics.sampling import sample
from ..model.arrays import Array, frozen
from ..model.coordinate import Coordinate
from ..model.errors import Fault, InputError
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from ..model.progress import Progress, silent
from ..model.units import Amount, quantity
from ..model.validate import whole_number
from .engine import Engine, Settings

MAX_POSES = 10_000  # each is a simulation
LOOKS = 100  # times that the drift is read during a run
SECONDS = (0.01, 3600.0)  # of a run
SOFT = 0.01  # share of its stiffness that the soft spring lacks
MOVES = 10.0  # times the tolerance that the soft spring must move it at least


@frozen
class Drift:
    """What became of the released poses.

    Attributes:
        moved: (poses, joints) the largest distance of every joint from where it was let go [rad, or m of slides].
        energy: (poses,) the largest change of the total energy [J]: the error of the integration.
        holding: (poses, n) torque that holds the pose at the independent coordinates, before letting go [N m or N].
        constraint_error: largest opening of an equality at any look [m or rad]; 0 without equalities.
    """

    moved: Array
    energy: Array
    holding: Array
    constraint_error: float

    @property
    def largest(self) -> float:
        """The largest drift of any joint from any pose."""
        return float(self.moved.max(initial=0.0))


@frozen
class Release(Shown):
    """The run, and its positive control.

    Attributes:
        coordinates: of the mechanism.
        seconds: of every run; tolerance: the drift that counts as staying [rad, or m of slides].
        poses: (poses, n) where it was let go [rad or m].
        joints: names of the engine's joints, in the order of `Drift.moved`.
        settings: of the engine.
        unbalanced: (poses, n) the torque that holds the poses without springs [N m or N].
        radius: [m] of the uniform spheres that stood for bodies without an inertia; None when there are none.
        soft: the name of the spring that lacked `SOFT` of its force in `control`; None without springs.
    """

    mechanism: Mechanism
    coordinates: tuple[Coordinate, ...]
    seconds: float
    tolerance: float
    poses: Array
    joints: tuple[str, ...]
    settings: Settings
    design: Drift
    unbalanced: Array
    radius: float | None
    soft: str | None
    control: Drift | None

    @property
    def stays(self) -> bool:
        """Whether no joint drifted further than the tolerance."""
        return self.design.largest <= self.tolerance

    @property
    def meaningful(self) -> bool:
        """Whether the control moved, so that staying means something."""
        return self.control is not None and self.control.largest >= MOVES * self.tolerance

    @property
    def worst(self) -> tuple[int, str]:
        """The pose from which a joint drifted most, and its name."""
        pose, joint = np.unravel_index(int(self.design.moved.argmax()), self.design.moved.shape)
        return int(pose), self.joints[joint]

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        pose, joint = self.worst
        return {
            "mechanism": self.mechanism.name,
            "poses": len(self.poses),
            "seconds": self.seconds,
            "tolerance": self.tolerance,
            "stays": self.stays,
            "max_drift": self.design.largest,
            "rms_drift": float(np.sqrt(np.mean(self.design.moved**2))),
            "worst": {
                "joint": joint,
                "configuration": dict(zip(self.coordinates, self.poses[pose].tolist(), strict=True)),
            },
            "energy_drift": float(self.design.energy.max()),
            "holding_torque": dict(
                zip(self.coordinates, np.abs(self.design.holding).max(axis=0).tolist(), strict=True)
            ),
            "unbalanced_torque": dict(zip(self.coordinates, np.abs(self.unbalanced).max(axis=0).tolist(), strict=True)),
            "constraint_error": self.design.constraint_error,
            "settings": str(self.settings),
            "radius": self.radius,
            "control": None
            if self.control is None
            else {"spring": self.soft, "softer_by": SOFT, "max_drift": self.control.largest, "moves": self.meaningful},
        }


def release(
    mechanism: Source,
    *,
    seconds: Amount = 10.0,
    poses: int = 10,
    seed: int = 0,
    tolerance: Amount = 1e-4,
    radius: Amount | None = None,
    control: bool = True,
    friction: bool = False,
    progress: Progress | None = None,
) -> Release:
    """Let a mechanism go at rest from random poses inside its limits.

    Args:
        mechanism: or the path of its file.
        seconds: of each run.
        tolerance: the drift that counts as staying [rad, or m of slides].
        radius: [m] of the uniform sphere that stands for a body without an inertia; without it that is an error.
        control: run the same with one spring soft.
        friction: with the joints' friction and damping, which then may be what holds it.

    Raises:
        InputError: a bad value, an inertia is missing, or MuJoCo is not installed.
        UnsupportedError: MJCF cannot express the mechanism.
        EngineError: the simulation diverged.
    """
    mechanism, radius = loaded(mechanism), None if radius is None else quantity(radius, "length", "radius")
    seconds, tolerance = quantity(seconds, "time", "seconds"), quantity(tolerance, "angle", "tolerance")
    whole_number("poses", poses, 1, MAX_POSES)
    whole_number("seed", seed, 0)
    if not SECONDS[0] <= seconds <= SECONDS[1]:
        raise InputError(Fault(("seconds",), f"must be between {SECONDS[0]:g} and {SECONDS[1]:g} s, found {seconds:g}"))
    if tolerance <= 0:
        raise InputError(Fault(("tolerance",), f"must be more than 0, found {tolerance:g} rad"))
    engine = Engine(mechanism, radius, friction)
    if engine.tree.n == 0:
        raise InputError(f"mechanism '{mechanism.name}' has no joint that moves: nothing to let go")
    q = sample(engine.tree, poses, seed)
    report = progress or silent
    runs = 2 if control and mechanism.springs else 1
    design = _drift(engine, q, seconds, lambda share: report("letting go", share / runs))
    bare = Engine(mechanism.with_springs(()), radius)
    unbalanced = np.array([_held(bare, one) for one in q])
    soft, moved = None, None
    if runs == 2:
        soft = _felt_most(mechanism, q, radius)
        weak = Engine(_softer(mechanism, soft), radius, friction)
        moved = _drift(weak, q, seconds, lambda share: report(f"the same with '{soft}' soft", (1 + share) / 2))
    names = tuple(engine.model.joint(j).name for j in range(engine.model.njnt))
    tree = engine.tree
    return Release(
        mechanism, tree.coordinates, seconds, tolerance, q, names, engine.settings, design, unbalanced,
        radius if any(body.mass and body.inertia is None for body in mechanism.bodies) else None, soft, moved,
    )  # fmt: skip


def _drift(engine: Engine, q: Array, seconds: float, report: Callable[[float], None]) -> Drift:
    moved, energy, holding, error = [], [], [], 0.0
    for i, one in enumerate(q):
        holding.append(_held(engine, one))
        start, before = engine.data.qpos.copy(), engine.energy
        most, lost = np.zeros(engine.model.njnt), 0.0
        for _ in range(LOOKS):
            engine.run(seconds / LOOKS)
            most = np.maximum(most, engine.moved(start))
            lost = max(lost, abs(engine.energy - before))
            error = max(error, engine.constraint_error)
        moved.append(most)
        energy.append(lost)
        report((i + 1) / len(q))
    return Drift(np.array(moved), np.array(energy), np.array(holding), error)


def _held(engine: Engine, q: Array) -> Array:
    engine.place(q)
    return engine.holding()


def _felt_most(mechanism: Mechanism, q: Array, radius: float | None) -> str:
    """The spring whose own torque is largest over the poses, the least of them by pose being what counts."""
    weightless = replace(mechanism, gravity=(0.0, 0.0, 0.0))
    felt = []
    for spring in mechanism.springs:
        engine = Engine(weightless.with_springs((spring,)), radius)
        felt.append(min(float(np.linalg.norm(_held(engine, one))) for one in q))
    return mechanism.springs[int(np.argmax(felt))].name


def _softer(mechanism: Mechanism, name: str) -> Mechanism:
    return mechanism.with_springs(
        spring.scaled(1 - SOFT) if spring.name == name else spring for spring in mechanism.springs
    )
