"""What a build's springs and masses really are, from measured holding torques; what to turn, and what is left then.

The holding torque is linear in the rates, the preloads and the masses. So they come from one least-squares problem, in
shares of what the file says; the noise from what no values explain; the intervals from Student's distribution. Values
that do the same to the measured torques cannot be told apart: they stay as near to the file's as the measurement lets
them, and are named.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..energy.evaluate import Potential
from ..io import Source, loaded
from ..kinematics import Tree, sample
from ..model.arrays import Array, frozen
from ..model.elements import Spring, TorsionSpring
from ..model.errors import Fault, InputError, nearest
from ..model.mechanism import Mechanism
from ..model.notebook import Shown
from .measured import Measured, read
from .turns import Turn, turns

LEVEL = 0.95
ALIKE = 1e-7  # of the largest singular value: a smaller one is none
MIXED = 1e-4  # a value's share in what cannot be told that is more than rounding
SURE = 3.0  # times its standard deviation: less left over is no reason to turn a screw
POSES = 1000  # over which what is left is judged
KINDS = ("rates", "preloads", "masses")


@dataclass(frozen=True)
class Value:
    """A rate, preload, strength or mass.

    Attributes:
        nominal: as the file has it; `unit` is of all.
        found: the best estimate, low and high its 95 % interval; infinite where it cannot be told.
        alike: the names of the others that it cannot be told apart from.
    """

    name: str
    unit: str
    nominal: float
    found: float
    low: float
    high: float
    alike: tuple[str, ...] = ()

    @property
    def told(self) -> bool:
        return not self.alike and bool(np.isfinite(self.high))


@dataclass(frozen=True)
class Handle:
    """A number of a mechanism that its holding torque is linear in: its name, unit, value, and what a change does."""

    name: str
    kind: str
    unit: str
    nominal: float
    step: float

    def set(self, mechanism: Mechanism, value: float) -> Mechanism:
        """The mechanism with another value, everything else the same."""
        what, own = self.name.split(" of ", 1)
        if what == "mass":
            bodies = tuple(replace(b, mass=value) if b.name == own else b for b in mechanism.bodies)
            if any(b.name == own for b in mechanism.bodies):
                return replace(mechanism, bodies=bodies)
            return mechanism.with_masses(replace(m, mass=value) if m.name == own else m for m in mechanism.masses)
        return mechanism.with_springs(_changed(s, what, value) if s.name == own else s for s in mechanism.springs)


def _changed(spring: Any, what: str, value: float) -> Any:
    """A spring with another rate and the same preload, another preload, or another strength altogether."""
    if isinstance(spring, Spring):
        if what == "rate":
            return replace(spring, stiffness=value, free_length=spring.stiffness * spring.free_length / value)
        return replace(spring, free_length=-value / spring.stiffness)
    if isinstance(spring, TorsionSpring):
        if what == "rate":
            return replace(spring, stiffness=value, rest=spring.stiffness * spring.rest / value)
        return replace(spring, rest=-value / spring.stiffness)
    return spring.scaled(value)


def handles(mechanism: Mechanism) -> Iterator[Handle]:
    """All that a measurement may tell; a preload is the force at no length, or the torque at no angle."""
    for spring in mechanism.springs:
        if isinstance(spring, (Spring, TorsionSpring)):
            rest = spring.free_length if isinstance(spring, Spring) else spring.rest
            most = 0.05 * spring.stiffness  # 50 mm, or 0.05 rad: what a preload is compared with
            yield Handle(f"rate of {spring.name}", "rates", f"{spring.force_unit}/{spring.path_unit}",
                         spring.stiffness, spring.stiffness)  # fmt: skip
            tight = 0.0 - spring.stiffness * rest
            yield Handle(f"preload of {spring.name}", "preloads", spring.force_unit, tight, most)
        else:
            yield Handle(f"strength of {spring.name}", "rates", "of the file's", 1.0, 1.0)
    for one in (*mechanism.bodies, *mechanism.masses):
        if one.mass:
            yield Handle(f"mass of {one.name}", "masses", "kg", one.mass, one.mass)


class Regression:
    """The least-squares problem of poses: made once, solved for any loads.

    Attributes:
        handles: the unknowns.
        A: (N m, unknowns) torque per step of each.
    """

    def __init__(self, mechanism: Mechanism, measured: Measured, known: Sequence[str] = ()) -> None:
        q, joints = measured.q, measured.joints
        every = [*handles(mechanism)]
        names = (*KINDS, *(handle.name for handle in every))
        for name in known:
            if name not in names:
                raise InputError(Fault(("known",), f"there is no {nearest(name, names)}", names))
        self.mechanism = mechanism
        self.handles = [h for h in every if h.name not in known and h.kind not in known]
        self._base = Potential(mechanism)(q).torque[:, joints]
        columns = []
        for handle in self.handles:
            changed = handle.set(mechanism, handle.nominal + handle.step)
            columns.append((Potential(changed)(q).torque[:, joints] - self._base).ravel())
        self.A = np.stack(columns, axis=1) if columns else np.zeros((self._base.size, 0))
        acts = np.linalg.norm(self.A, axis=0)
        none = acts <= ALIKE * max(float(acts.max(initial=0)), 1e-300)
        self._scale = np.where(none, 1.0, acts)
        U, S, V = np.linalg.svd(self.A / self._scale, full_matrices=False)
        keep = ALIKE * max(float(S.max(initial=0)), 1e-300) < S
        self.rank = int(keep.sum())
        self._pinv = (V[keep].T / S[keep]) @ U[:, keep].T / self._scale[:, None]
        told = V[keep].T @ V[keep]  # onto what can be told
        self._mixed = np.abs(np.eye(len(acts)) - told)
        self.freedom = self.A.shape[0] - self.rank

    def solve(self, load: Array) -> tuple[tuple[Value, ...], float]:
        """The values for loads (N, m), and the standard deviation of the noise [N m or N]."""
        from scipy.stats import t

        r = (load - self._base).ravel()
        step = self._pinv @ r
        rest = r - self.A @ step
        noise = float(np.sqrt(rest @ rest / self.freedom)) if self.freedom > 0 else np.inf
        quantile = float(t.ppf((1 + LEVEL) / 2, self.freedom)) if self.freedom > 0 else np.inf
        half = quantile * noise * np.linalg.norm(self._pinv, axis=1)
        return tuple(self._value(i, float(step[i]), float(half[i])) for i in range(len(self.handles))), noise

    def _value(self, i: int, step: float, half: float) -> Value:
        h, row = self.handles[i], self._mixed[i]
        found = h.nominal + step * h.step
        if row[i] <= MIXED:
            return Value(h.name, h.unit, h.nominal, found, found - half * h.step, found + half * h.step)
        alike = tuple(other.name for j, other in enumerate(self.handles) if j != i and row[j] > MIXED)
        return Value(h.name, h.unit, h.nominal, found, -np.inf, np.inf, alike)

    def with_values(self, values: Sequence[Value]) -> Mechanism:
        """The mechanism as it was found to be; masses stay at least 0."""
        mechanism = self.mechanism
        for handle, value in zip(self.handles, values, strict=True):
            changed = max(value.found, 0.0) if handle.kind == "masses" else value.found
            if handle.unit != "N" and handle.unit != "N m":
                mechanism = handle.set(mechanism, changed)
        for handle, value in zip(self.handles, values, strict=True):
            if handle.unit in ("N", "N m"):
                mechanism = handle.set(mechanism, value.found)
        return mechanism


@frozen
class Identified(Shown):
    """What a measurement tells.

    Attributes:
        values: rates, preloads and masses.
        noise: standard deviation of what they do not explain [N m or N].
        mechanism: as it was found to be; turned: after the turns.
        before, after: largest remaining torque of each coordinate over the workspace, now and after the turns.
        measured: (largest, root mean square) of the loads as they were measured.
    """

    values: tuple[Value, ...]
    noise: float
    mechanism: Mechanism
    turns: tuple[Turn, ...]
    turned: Mechanism
    before: Array
    after: Array
    measured: tuple[float, float]

    @cached_property
    def alike(self) -> tuple[tuple[str, ...], ...]:
        """The groups of values that cannot be told apart."""
        groups: list[set[str]] = []
        for value in self.values:
            if value.told:
                continue
            own = {value.name, *value.alike}
            for group in [g for g in groups if g & own]:
                own |= group
                groups.remove(group)
            groups.append(own)
        order = [value.name for value in self.values]
        return tuple(tuple(sorted(group, key=order.index)) for group in groups)

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise identify --json``."""

        def number(x: float) -> float | None:
            return float(x) if np.isfinite(x) else None

        return {
            "values": [
                {"name": v.name, "unit": v.unit, "nominal": v.nominal, "found": number(v.found),
                 "interval": [number(v.low), number(v.high)], "told": v.told}
                for v in self.values
            ],
            "alike": [list(group) for group in self.alike],
            "noise": number(self.noise),
            "measured": {"max": self.measured[0], "rms": self.measured[1]},
            "turns": [turn.to_dict() for turn in self.turns],
            "remaining": {"before": self.before.tolist(), "after": self.after.tolist()},
        }  # fmt: skip


def identify(
    mechanism: Source,
    measured: Measured | str,
    *,
    constants: Mapping[str, float] | None = None,
    known: Sequence[str] = (),
    seed: int = 0,
) -> Identified:
    """What a build's springs and masses are, from the loads that its motors held.

    Args:
        measured: or the path of its CSV file, see `measured.read`.
        constants: joint -> torque constant [N m/A], where currents were measured.
        known: names of values that are as the file has them, or "rates", "preloads" or "masses" for all of a kind.

    Raises:
        InputError: as `read`; nothing to identify, or fewer measurements than unknowns.
    """
    mechanism = loaded(mechanism)
    data = measured if isinstance(measured, Measured) else read(measured, mechanism, constants)
    problem = Regression(mechanism, data, known)
    if not problem.handles or not problem.rank:
        raise InputError("there is nothing to identify: no unknown rate, preload or mass acts on what was measured")
    if problem.freedom < 1:
        raise InputError(
            f"{data.load.size} measured loads cannot tell {problem.rank} values and the noise: measure more poses, or "
            "say what is known with --known"
        )
    values, noise = problem.solve(data.load)
    found = problem.with_values(values)
    q = sample(Tree.of(mechanism), POSES, seed)
    doubt = noise * np.sqrt(problem.rank / problem.freedom)  # of a torque that the values give
    moved, turned = turns(found, q, SURE * float(doubt))
    left = [np.abs(Potential(m)(q).torque).max(axis=0) for m in (found, turned)]
    load = np.abs(data.load)
    return Identified(
        values, noise, found, moved, turned, *left, measured=(float(load.max()), float(np.sqrt((load**2).mean())))
    )
