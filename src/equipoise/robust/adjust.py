"""What to move when the payload changes: attachments or preloads, how far, and the energy that it takes.

The torque of a zero-free-length spring is affine in either of its attachments, and every spring's in its free length.
So a set of these, one for each spring at most, is found by one linear least-squares problem over the poses, its
shortest solution; with a free length Newton's method repeats it. All sets of few springs are tried: the first that
keeps the balance is the fewest springs that can, and of those it is the one that moves least.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import Any, get_args

import numpy as np

from ..balance import Balance, check, payload_residual
from ..energy.evaluate import Potential
from ..energy.extremes import climb
from ..io import Source, loaded
from ..kinematics import Tree, sample
from ..model.arrays import Array, frozen
from ..model.elements import lines
from ..model.errors import InputError
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from ..model.payload import Payload
from ..model.progress import Progress, silent
from ..model.units import Amount, number, quantity, share
from ..model.validate import whole_number
from ..synthesis.mounts import Mounts
from .arcs import Locked, locked
from .limited import limited
from .moves import Handle, Move, Way, What, moved, sets, value
from .reach import least_left
from .scatter import Scatter
from .steps import Step, step
from .torque_map import TorqueMap

POSES = 200
SETTLING_STEPS = 20
KEPT = 1e-9  # of what the range of payload does, root mean square: less is balance
PAYLOADS = 5  # of the range, ends included, for which the adjustment is given
SHOWN = 1000  # poses that tell what is left at each
EVERY_ATTACHMENT = Scatter(stiffness=0, attachment=1, mass=0, length=0)


@frozen
class Adjustment(Shown):
    """How a design follows a range of payloads, and the fixed design that is best over it.

    Attributes:
        tolerance: what `best` may leave and still keeps the balance, see `Way.share`.
        ways: every attachment and free length on its own, the best first.
        best: of the fewest springs that keep the balance, those that move least; else what leaves least.
        ends: the verdict with it at the smallest and at the largest payload.
        fixed: the mechanism, without the payload, set by `best` for the middle of the range once and for all.
        left: (n,) its largest residual torque over the range [N m or N].
        bound: (n,) no fixed springs whatever leave less: half the range times the largest torque of 1 kg.
        unmoved: what the design as it is leaves at the worse end, as `Way.share`.
        steps: `best` at payloads of the range, beside the design as it is.
        locked: a pose in which `best` takes no energy, where there is one.
        travel: [m] that an end may be moved, at most.
        reach: [N m] rms, what all springs on the same pairs leave at the largest payload at least, see `least_left`;
            None where the balance is kept, or nothing is known.
    """

    payload: Payload
    tolerance: float
    ways: tuple[Way, ...]
    best: Way
    ends: tuple[Balance, Balance]
    fixed: Mechanism
    left: Array
    bound: Array
    unmoved: float
    steps: tuple[Step, ...]
    locked: Locked | None
    travel: float = inf
    reach: float | None = None

    @property
    def exact(self) -> bool:
        """Whether the verdict is exact balance at both ends."""
        return all(balance.exact for balance in self.ends)

    @property
    def keeps(self) -> bool:
        """Whether `best` keeps the balance to the tolerance."""
        return self.best.share <= self.tolerance

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise adjust --json``."""
        return {
            "payload": {"body": self.payload.link, "place": self.payload.place.tolist(), "range": self.payload.span},
            "tolerance": self.tolerance,
            "keeps": self.keeps,
            "exact": self.exact,
            "best": self.best.to_dict(),
            "ways": [way.to_dict() for way in self.ways],
            "unmoved": self.unmoved,
            "travel": None if self.travel == inf else self.travel,
            "reach": self.reach,
            "steps": [one.to_dict() for one in self.steps],
            "without_energy": None if self.locked is None else self.locked.to_dict(),
            "residual": [balance.residual.max.tolist() for balance in self.ends],
            "fixed": {"residual": self.left.tolist(), "bound": self.bound.tolist()},
        }


def adjust(
    mechanism: Source,
    payload: Payload,
    *,
    tolerance: Amount = KEPT,
    travel: Amount = inf,
    payloads: int = PAYLOADS,
    seed: int = 0,
    progress: Progress | None = None,
) -> Adjustment:
    """Find what to move, from the springs of a design that is balanced at any payload of the range or none.

    Args:
        mechanism: or the path of its file.
        tolerance: of what the range of payload does: less is balance; a design of rounded numbers needs more.
        travel: [m] that an end, or a free length, may be moved at most.
        payloads: for how many payloads of the range the adjustment is given.

    Raises:
        InputError: no springs, no range, a payload that loads nothing, or no such tolerance.
    """
    mechanism, tolerance = loaded(mechanism), share(tolerance, "tolerance")
    if not KEPT <= tolerance < 1:
        raise InputError(f"the tolerance must be a share from {KEPT:g} to less than 1, found {tolerance:g}")
    travel = inf if travel == inf else number("travel", quantity(travel, "length", "travel"), positive=True)
    whole_number("payloads", payloads, 2)
    springs = lines(mechanism, "adjust")
    if not springs:
        raise InputError(f"mechanism '{mechanism.name}' has no springs to adjust")
    if not payload.low < payload.high:
        raise InputError("the payload must have a range, the smallest and the largest; for one, design with it")
    tree = Tree.of(mechanism)
    problem = _Problem(mechanism, payload, sample(tree, POSES, seed), travel)
    if not problem.unit:
        raise InputError(f"a payload on '{payload.link}' loads no joint")
    handles = [Handle(i, what) for i in range(len(springs)) for what in get_args(What)]
    ways, report = [], progress or silent
    for i, handle in enumerate(handles):
        report("trying what to move", i / (len(handles) + 2))
        ways.append(problem.way((handle,)))
    chosen = problem.fewest(handles, tolerance)
    best = problem.way(chosen)
    report("judging the adjusted design", len(handles) / (len(handles) + 2))
    ends = (check(payload.on(best.low, payload.low)), check(payload.on(best.high, payload.high)))
    fixed = problem.settled(chosen, payload.middle)
    masses, some = np.linspace(payload.low, payload.high, payloads).tolist(), sample(tree, SHOWN, seed + 1)
    steps = (step(mechanism, problem.settled(chosen, mass), chosen, payload, mass, some) for mass in masses)
    left = payload_residual(payload, fixed, fixed.springs)
    return Adjustment(
        payload=payload,
        tolerance=tolerance,
        ways=tuple(sorted(ways, key=lambda way: _order(way.share, sum(m.travel for m in way.moves), tolerance))),
        best=best,
        ends=ends,
        fixed=fixed,
        left=np.array([left[name] for name in tree.coordinates]),
        bound=(payload.high - payload.low) / 2 * _torque_of_one(mechanism, payload),
        unmoved=max(float(np.linalg.norm(torque)) for torque in (problem.low, problem.high)) / problem.unit,
        steps=tuple(steps),
        locked=locked(mechanism, best.moves, problem.q),
        travel=travel,
        reach=None if best.share <= tolerance else least_left(mechanism, payload, payload.high, travel),
    )


def _torque_of_one(mechanism: Mechanism, payload: Payload) -> Array:
    """(n,) largest torque of 1 kg of payload."""
    bare = replace(
        mechanism.with_springs(()).with_masses(()),
        bodies=tuple(replace(body, mass=0.0) for body in mechanism.bodies),
    )
    return check(payload.on(bare, 1.0)).unbalanced.max


def _order(share: float, travel: float, tolerance: float) -> tuple[float, float]:
    """What keeps the balance comes first, then what leaves least (to 0.1 %), then what moves least."""
    return 0.0 if share <= tolerance else max(round(share, 3), 1e-3), travel


class _Problem:
    """Torques at the poses, coordinate by coordinate, slides weighted to count like turns."""

    def __init__(self, mechanism: Mechanism, payload: Payload, q: Array, travel: float = inf) -> None:
        self.mechanism, self.payload, self.q, self.travel = mechanism, payload, q, travel
        self.tree = Tree.of(mechanism)
        self.weight = np.where(self.tree.turns, 1.0, Mounts.of(mechanism).reach).repeat(len(q))
        self.low, self.high = (self._torque(payload.on(mechanism, mass)) for mass in (payload.low, payload.high))
        self.unit = float(np.linalg.norm(self.high - self.low))

    def way(self, handles: Sequence[Handle]) -> Way:
        low, high = (self.settled(handles, mass) for mass in (self.payload.low, self.payload.high))
        left = (
            self._torque(self.payload.on(low, self.payload.low)),
            self._torque(self.payload.on(high, self.payload.high)),
        )
        moves = tuple(Move(low.springs[h.spring].name, h.what, value(low, h), value(high, h)) for h in handles)
        share = max(float(np.linalg.norm(torque)) for torque in left) / self.unit
        return Way(moves, share, self._work(low, high), low, high)

    def settled(self, handles: Sequence[Handle], mass: float) -> Mechanism:
        """The springs set for a payload [kg], without it."""
        now = self.mechanism
        left = self._torque(self.payload.on(now, mass))
        start = np.concatenate([value(now, handle) for handle in handles])
        widths = [len(value(now, handle)) for handle in handles]
        for _ in range(SETTLING_STEPS):
            J = np.concatenate(self._columns(now, handles), axis=1)
            done = np.concatenate([value(now, handle) for handle in handles]) - start
            step = limited(J, left, widths, done, self.travel)
            for part in (1.0, 0.5, 0.25, 0.125):
                trial = moved(now, handles, part * step)
                torque = self._torque(self.payload.on(trial, mass))
                if torque @ torque < (1 - 1e-6) * (left @ left):
                    break
            else:
                break
            now, left = trial, torque
            if np.linalg.norm(left) < 1e-14 * self.unit:
                break
        return now

    def fewest(self, handles: Sequence[Handle], tolerance: float) -> tuple[Handle, ...]:
        """The set to move, by the torques' derivatives."""
        columns = self._columns(self.mechanism, handles)
        every = np.concatenate([*columns, self.low[:, None], self.high[:, None]], axis=1)
        R = np.linalg.qr(every)[1]  # as many rows as columns say the same as all poses do
        width = np.cumsum([0, *(c.shape[1] for c in columns)])
        best: tuple[tuple[float, float], tuple[Handle, ...]] | None = None
        for chosen in sets(handles):
            own = [j for h in chosen for j in range(width[handles.index(h)], width[handles.index(h) + 1])]
            each = [width[handles.index(h) + 1] - width[handles.index(h)] for h in chosen]
            none = np.zeros(len(own))
            x = np.stack([limited(R[:, own], r, each, none, self.travel) for r in R[:, -2:].T], axis=1)
            share = float(np.linalg.norm(R[:, own] @ x + R[:, -2:], axis=0).max()) / self.unit
            if best is not None and len(chosen) > len(best[1]) and best[0][0] == 0.0:
                break  # fewer springs do it
            found = _order(share, float(np.linalg.norm(x[:, 1] - x[:, 0])), tolerance), chosen
            if best is None or found[0] < best[0]:
                best = found
        return best[1] if best else tuple(handles[:1])

    def _columns(self, mechanism: Mechanism, handles: Sequence[Handle]) -> list[Array]:
        """Of each handle (n N, 3) or (n N, 1): change of the torque per metre."""
        used = sorted({handle.spring for handle in handles})
        torque_map = TorqueMap(mechanism.with_springs(mechanism.springs[i] for i in used), self.q, EVERY_ATTACHMENT)
        J = torque_map.jacobian()
        found = []
        for handle in handles:
            spring = lines(mechanism, "adjust")[handle.spring]
            if handle.what == "free_length":
                alone = replace(mechanism.with_springs((replace(spring, free_length=1.0),)), provenance={})
                ideal = alone.with_springs((replace(spring, free_length=0.0),))
                column = (self._torque(alone) - self._torque(ideal))[:, None]
            else:
                own = [
                    i
                    for i, p in enumerate(torque_map.parameters)
                    if p.item == spring.name and p.kind == "attachment" and p.value.startswith(handle.what)
                ]
                column = self.weight[:, None] * J[:, own]
            found.append(column)
        return found

    def _torque(self, mechanism: Mechanism) -> Array:
        return self.weight * Potential(mechanism)(self.q).torque.T.ravel()

    def _work(self, low: Mechanism, high: Mechanism) -> tuple[float, float]:
        first, second = Potential(low), Potential(high)

        def both(q: Array) -> Array:
            work = second(q).springs.sum(axis=1) - first(q).springs.sum(axis=1)
            return np.stack([-work, work], axis=1)

        least, most = climb(self.tree, both, self.q)[0]
        return float(-least), float(most)
