"""What the viewer shows and changes: a mechanism, its springs, a payload and a pose. It knows nothing of widgets."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .._version import __version__
from ..balance import Balance, check
from ..energy.evaluate import Potential
from ..energy.reference import State
from ..kinematics import Tree, sample
from ..kinematics.sampling import inside
from ..model.arrays import Array, vec3
from ..model.elements import Element, Spring, Vec3
from ..model.mechanism import Mechanism, PointMass
from ..model.progress import Progress
from ..report.poses import View, choose
from ..report.skeleton import Skeleton
from ..synthesis import Design, Problem, Region, solve
from ..synthesis.mounts import Mounts

POSES, CLOSED = 256, 48  # random poses of the live residual; closing loops takes longer
TRAIL = 250  # poses of the last motion
PAYLOAD = "payload (viewer)"
SPRINGS = 3  # that a mechanism without springs is given
BETTER = 1e-12  # [of the unbalanced torque] a smaller gain is rounding


@dataclass(frozen=True)
class Residual:
    """Over the same random poses always: root mean square torque of all coordinates with and without springs."""

    rms: float
    unbalanced: float

    @property
    def share(self) -> float:
        return self.rms / self.unbalanced if self.unbalanced > 0 else 0.0


class Model:
    """A mechanism that is being looked at.

    Attributes:
        file: as it was loaded.
        springs, on: the springs as edited, and whether each is there.
        masses: the file's point masses as edited.
        payload: [kg] at the tip, on top of the file's own masses.
        q: (n,) the pose; trail: the energies (gravity, springs, total) [J] of the last ones.
        view: where to look from.

    Raises:
        InputError: its loops cannot be closed.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.file = mechanism
        self.springs = list(mechanism.springs)
        self.on = [True] * len(self.springs)
        self.masses = list(mechanism.masses)
        self.payload = 0.0
        self.made: Mapping[str, Any] = mechanism.provenance
        self.tree = Tree.of(mechanism)
        self.view: View
        self.view, poses = choose(mechanism, Skeleton.of(mechanism))
        self.rest = self.q = poses[0]
        self._poses = sample(self.tree, CLOSED if mechanism.loops else POSES)
        self.tip = _tip(mechanism, self.tree)
        self.trail: deque[tuple[float, float, float]] = deque(maxlen=TRAIL)
        self._changed()

    @property
    def mechanism(self) -> Mechanism:
        """As it stands: the springs that are on, and the payload."""
        return self._mechanism

    @property
    def state(self) -> State:
        """Energies, lengths and torques of the pose, of springs that are on."""
        return self._state

    @property
    def edited(self) -> bool:
        """Whether the springs are no longer those of the file or the last design."""
        return self._edited

    def pose(self, q: ArrayLike) -> bool:
        """Go to `q` (n,); False, and nothing changes, where a loop does not close or a joint leaves its range."""
        q = np.array(q, float)
        if not inside(self.tree, q[None], slack=1e-9)[0]:
            return False
        self.q = q
        self._look()
        return True

    def change(self, number: int, **values: Any) -> None:
        """Give a spring other values of its fields.

        Raises:
            InputError: a value is not possible; nothing changes.
        """
        self._try([*self.springs[:number], self.springs[number].changed(**values), *self.springs[number + 1 :]])
        self._edited = True

    def switch(self, number: int | None, on: bool) -> None:
        """One spring, or all of them, on or off."""
        self.on = [on if number in (None, i) else old for i, old in enumerate(self.on)]
        self._changed()

    def load(self, payload: float) -> None:
        """Carry another payload [kg]."""
        self.payload = payload
        self._changed()

    def weigh(self, number: int, mass: float) -> None:
        """Give one of the file's point masses, such as a counterweight, another mass [kg]."""
        self.masses[number] = replace(self.masses[number], mass=mass)
        self._edited = True
        self._changed()

    def residual(self) -> Residual:
        """How well the springs that are on balance, quickly: over a few random poses."""
        if self._residual is None:
            state = self._over
            norm = [float(np.sqrt((t**2).sum(axis=1).mean())) for t in (state.torque, state.gravity_torque)]
            self._residual = Residual(*norm)
        return self._residual

    def paths(self) -> Array:
        """(poses, springs that are on) [m or rad] over the same random poses."""
        return self._over.path

    def judge(self) -> Balance:
        """The verdict of `equipoise check`; takes seconds. Remembered until something changes."""
        if self._balance is None:
            mechanism = self.mechanism
            balance = check(mechanism)
            if mechanism is not self.mechanism:  # somebody has changed it in the meantime
                return balance
            self._balance = balance
        return self._balance

    @property
    def judged(self) -> Balance | None:
        """The verdict, when there is one for what is shown."""
        return self._balance

    def worst(self) -> Array:
        """(n,) the pose of the largest residual torque."""
        return self.judge().worst_configuration

    def redesign(self, progress: Progress | None = None) -> bool:
        """Choose springs anew under the present constraints; False when that is no better, and nothing changes.

        The pairs of bodies and the number of springs stay, attachments may go as far out as they are or as a link's
        size suggests. Springs that are off are left out, those on joints stay as they are. A mechanism without springs
        gets three.

        Raises:
            InfeasibleError: no springs on these pairs help.
        """
        found = self._designed(progress)
        before, springs, on = self.residual(), self.springs, self.on
        self._take(list(found.mechanism.springs))
        if self.residual().rms >= before.rms - BETTER * before.unbalanced:
            self._take(springs, on)
            return False
        self.made, self._edited = found.mechanism.provenance, False
        return True

    def saved(self) -> Mechanism:
        """The mechanism to save; its provenance says when it was changed by hand."""
        made = self.made
        if self._edited or self.payload or not all(self.on):
            made = {
                "program": f"equipoise {__version__}",
                "method": "changed by hand in the viewer",
                "from": dict(made),
            }
        return replace(self.mechanism, provenance=made)

    def _designed(self, progress: Progress | None) -> Design:
        present = [spring for spring, on in zip(self.springs, self.on, strict=True) if on]
        chosen = [spring for spring in present if isinstance(spring, Spring)]
        kept = self.mechanism.with_springs(spring for spring in present if spring not in chosen)
        problem = Problem.of(kept, keep=bool(kept.springs))
        if chosen:
            said = {one.body for one in kept.attachments}  # where the file says where springs may go, it counts
            regions = {body: region for body, region in _regions(kept, chosen).items() if body not in said}
            problem = problem.with_regions(regions).with_pairs((spring.body_a, spring.body_b) for spring in chosen)
        return solve(problem, springs=len(chosen) or SPRINGS, progress=progress)

    def _take(self, springs: list[Element], on: list[bool] | None = None) -> None:
        self.springs, self.on = springs, on or [True] * len(springs)
        self._changed()

    def _try(self, springs: list[Element]) -> None:
        old, self.springs = self.springs, springs
        try:
            self._changed()
        except Exception:
            self.springs = old
            self._changed()
            raise

    _edited = False

    def _changed(self) -> None:
        present = [spring for spring, on in zip(self.springs, self.on, strict=True) if on]
        masses = tuple(self.masses)
        if self.payload > 0:
            body, place = self.tip
            masses = (*masses, PointMass(PAYLOAD, body, self.payload, place))
        self._mechanism = self.file.with_springs(present).with_masses(masses)
        self._potential = Potential(self._mechanism)
        self._over = self._potential(self._poses)
        self._residual: Residual | None = None
        self._balance: Balance | None = None
        self._look()

    def _look(self) -> None:
        self._state = self._potential(self.q)
        gravity, total = float(self._state.gravity[0]), float(self._state.energy[0])
        self.trail.append((gravity, total - gravity, total))


def _tip(mechanism: Mechanism, tree: Tree) -> tuple[str, Vec3]:
    """Where a payload hangs: the end of the body that is the most joints from the ground."""
    depth = {0: 0}
    for link in tree.links:
        depth[link.body] = depth[link.parent] + 1
    parents = {link.parent for link in tree.links}
    mass = {tree.index[body.name]: body.mass for body in mechanism.bodies}
    body = max((b for b in depth if b not in parents), key=lambda b: (depth[b], mass.get(b, 0.0)), default=0)
    bars = {bar.body: bar for bar in Skeleton.of(mechanism).bars}
    place = bars[body].b.p if body in bars and bars[body].b.body == body else np.zeros(3)
    return tree.names[body], vec3(place)


def _regions(mechanism: Mechanism, springs: list[Spring]) -> dict[str, Region]:
    mounts, radius = Mounts.of(mechanism), {}
    for spring in springs:
        for body, p in spring.ends:
            here = max(radius.get(body, 0.0), mounts.default_radius(body), float(np.linalg.norm(p)) * (1 + 1e-9))
            radius[body] = here
    return {body: Region.ball(r) for body, r in radius.items()}
