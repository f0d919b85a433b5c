"""What to turn on a build so that least torque is left: adjusting screws that tighten springs or move their ends."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from ..energy.evaluate import Potential
from ..model.arrays import Array
from ..model.elements import Spring
from ..model.mechanism import Mechanism

What = Literal["tighten", "p_a", "p_b"]
STEP = 1e-6  # [m] for slopes
LONGEST = 0.02  # [m] that a screw moves
WORTH = 0.9  # of what was left: a turn that leaves more is not worth the trouble
ROUNDS = 6


@dataclass(frozen=True)
class Turn:
    """A screw to turn.

    Attributes:
        spring: whose.
        what: "tighten" shortens the free length; "p_a" and "p_b" move an end away from the origin of its body.
        by: [m] less than 0 is the other way.
        left: root mean square torque [N m or N] after this turn and those before it.
    """

    spring: str
    what: What
    body: str
    by: float
    left: float

    def __str__(self) -> str:
        by = f"{1e3 * abs(self.by):.2f} mm"
        if self.what == "tighten":
            return f"{'tighten' if self.by > 0 else 'loosen'} {self.spring} by {by}"
        way = "away from" if self.by > 0 else "towards"
        return f"move the end of {self.spring} on {self.body} by {by} {way} the origin of {self.body}"

    def to_dict(self) -> dict[str, Any]:
        return {**vars(self)}


def turns(mechanism: Mechanism, q: Array, floor: float = 0.0) -> tuple[tuple[Turn, ...], Mechanism]:
    """The turns that help most at poses q (N, n), one after the other; and the mechanism after them.

    At most one for each spring's length, and one for its ends; none where no more than `floor` [N m or N] is left.
    """
    chosen: list[tuple[int, What]] = []
    steps = np.zeros(0)
    left, found, now = _rms(mechanism, q), [], mechanism
    while left > floor:
        taken = {(i, what == "tighten") for i, what in chosen}
        tried = []
        for screw in _screws(mechanism):
            if (screw[0], screw[1] == "tighten") not in taken:
                best = _best(mechanism, [*chosen, screw], np.append(steps, 0.0), q)
                tried.append((_rms(_moved(mechanism, [*chosen, screw], best), q), screw, best))
        least = min(tried, key=lambda one: one[0], default=None)
        if least is None or least[0] > WORTH * left:
            break
        left, screw, steps = least
        chosen.append(screw)
        now = _moved(mechanism, chosen, steps)
        found.append(left)
    made = []
    for (i, what), by, rest in zip(chosen, steps.tolist(), found, strict=True):
        spring = mechanism.springs[i]
        body = {"p_a": spring.body_a, "p_b": spring.body_b}.get(what, "")
        made.append(Turn(spring.name, what, body, by, rest))
    return tuple(made), now


def _screws(mechanism: Mechanism) -> Iterator[tuple[int, What]]:
    for i, spring in enumerate(mechanism.springs):
        if isinstance(spring, Spring):
            yield i, "tighten"
            if any(spring.p_a):
                yield i, "p_a"
            if any(spring.p_b):
                yield i, "p_b"


def _best(mechanism: Mechanism, screws: Sequence[tuple[int, What]], start: Array, q: Array) -> Array:
    """The steps (screws,) [m] that leave least, by Gauss-Newton from `start`."""
    x = start
    for _ in range(ROUNDS):
        here = Potential(_moved(mechanism, screws, x))(q).torque.ravel()
        J = np.stack(
            [(Potential(_moved(mechanism, screws, x + STEP * unit))(q).torque.ravel() - here) / STEP
             for unit in np.eye(len(x))], axis=1,
        )  # fmt: skip
        new = np.clip(x - np.linalg.lstsq(J, here, rcond=1e-9)[0], -LONGEST, LONGEST)
        if np.abs(new - x).max() < 1e-9:
            break
        x = new
    return x


def _moved(mechanism: Mechanism, screws: Sequence[tuple[int, What]], steps: Array) -> Mechanism:
    springs: list[Any] = list(mechanism.springs)
    for (i, what), by in zip(screws, steps.tolist(), strict=True):
        spring = springs[i]
        if what == "tighten":
            springs[i] = replace(spring, free_length=spring.free_length - by)
        else:
            p = np.array(getattr(spring, what))
            springs[i] = replace(spring, **{what: tuple((p + by * p / np.linalg.norm(p)).tolist())})
    return mechanism.with_springs(springs)


def _rms(mechanism: Mechanism, q: Array) -> float:
    return float(np.sqrt((Potential(mechanism)(q).torque ** 2).sum(axis=1).mean()))
