"""Ordinary springs: attachments, stiffness and preload that make the best of free lengths and of the room there is.

A free length L0 adds ``-k L0 d/|d|`` to the force of the zero-free-length spring: no moment matrix, no bound, but small
changes of a design that was optimal without it. Where a spring's length changes little over the workspace, L0/|d| is
nearly constant and only weakens the spring: so one attachment moves close to its joint and the spring gets stiffer.

Attachments stay 5 mm from the axes that they turn about (`levers`).

Room is a constraint: springs are moved until nothing is nearer than it may be at the sampled poses; then the whole
workspace is judged, and the poses where something is too near are added until there is none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ...balance import Balance, check
from ...clearance import Clearance, ClearanceConstraint, within
from ...clearance import clearance as judge_room
from ...io import Source, loaded
from ...kinematics import Tree, sample
from ...model.arrays import Array
from ...model.elements import lines
from ...model.errors import Fault, InfeasibleError, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.units import Amount
from ...model.validate import MAX_SAMPLES, whole_number
from ..options import Options, option, takes
from ..region import Given, given_regions
from .levers import Levers
from .ordinary_fit import FREE_LENGTHS, WIDTH, Fit, both

ROOM_ROUNDS = 8  # of adding the poses with too little room
WEIGHT = 10  # times that such a pose counts


@dataclass(frozen=True)
class Ordinary:
    """What is lost with ordinary springs.

    Attributes:
        ideal: the design with zero free length.
        plain: the same springs with their free lengths, nothing else changed.
        balance: with attachments, stiffness and preload optimised.
        free_length: spring -> free length as bought [m]; what the preload makes of it stands with the spring.
        room: before and after, when it was a constraint.
    """

    ideal: Balance
    plain: Balance
    balance: Balance
    free_length: Mapping[str, float]
    room: tuple[Clearance, Clearance] | None = None

    @property
    def mechanism(self) -> Mechanism:
        return self.balance.mechanism

    @property
    def moved(self) -> bool:
        """Whether it is another design at all: where there was room enough, it is not."""
        return self.mechanism.springs != self.ideal.mechanism.springs

    @cached_property
    def gain(self) -> float:
        """How many times smaller the peak residual has become."""
        return self.plain.relative / self.balance.relative if self.balance.relative else np.inf

    def to_dict(self) -> dict[str, Any]:
        """The ``free_length`` part of ``equipoise design --json``."""
        old = {
            s.name: (s, use) for s, use in zip(lines(self.ideal.mechanism, FREE_LENGTHS), self.ideal.use, strict=True)
        }
        springs = []
        for spring, use in zip(lines(self.mechanism, FREE_LENGTHS), self.balance.use, strict=True):
            before, before_use = old[spring.name]
            bought = self.free_length.get(spring.name, 0.0)
            springs.append(
                {
                    "name": spring.name,
                    "free_length": bought,
                    "preload": spring.stiffness * (bought - spring.free_length),
                    "stiffness": [before.stiffness, spring.stiffness],
                    "max_force": [float(before_use.max_force), float(use.max_force)],
                }
            )
        return {
            "residual": {
                "ideal": self.ideal.relative,
                "plain": self.plain.relative,
                "optimised": self.balance.relative,
            },
            "gain": self.gain if np.isfinite(self.gain) else None,
            "springs": springs,
            "clearance": None
            if self.room is None
            else [room.least_of_springs if np.isfinite(room.least_of_springs) else None for room in self.room],
        }


@dataclass(frozen=True)
class OrdinaryOptions(Options):
    """What `ordinary` can be asked for.

    Attributes:
        free_length: of all springs, or spring -> free length [m], and other springs stay as they are; by default all
            springs move and have the free lengths that they have.
        clearance: [m] what every spring keeps from other springs and from links that it is not fixed to.
        regions: where the ends on a body may be, as in a `Problem`; by default the `attachments` of the mechanism, else
            a ball as large as they are away from its origin.
        stiffness_factor: stiffness stays between its old value over this and times this.
        preload: the share of the free length that initial tension may take away; a rod in series may double it.
        poses: random ones that the residual torque is minimised on, root mean square; within the ranges of the goal's
            motions, where it has some.
        seed: of those poses.
    """

    free_length: Amount | Mapping[str, Amount] | None = option(None, "length", "of the springs")
    _: KW_ONLY
    clearance: Amount | None = option(None, "length", "what springs keep from each other and from links")
    regions: Mapping[str, Given] | None = None
    stiffness_factor: Amount = option(5.0, "number", "by which stiffness may change")
    preload: Amount = option(0.0, "share", "of the free length that initial tension may take away")
    poses: int = 200
    seed: int = 0


@takes(OrdinaryOptions)
def ordinary(mechanism: Source, options: OrdinaryOptions) -> Ordinary:
    """Make the best of a design whose springs have a free length, or need room, or both; see `OrdinaryOptions`.

    Raises:
        InputError: a bad option, or no such spring.
        InfeasibleError: no place was found with so much room.
    """
    mechanism = loaded(mechanism)
    stiffness_factor, preload = float(options.stiffness_factor), float(options.preload)
    clearance = None if options.clearance is None else float(options.clearance)
    regions = given_regions(mechanism, options.regions or {})
    lengths = _lengths(mechanism, options.free_length)
    if not (1 <= stiffness_factor < np.inf and 0 <= preload <= 1):
        raise InputError("stiffness_factor must be at least 1 and preload a share from 0 to 1")
    if clearance is not None and not 0 <= clearance < np.inf:
        raise InputError(Fault(("clearance",), f"must be at least 0 m, found {clearance:g}"))
    whole_number("poses", options.poses, 1, MAX_SAMPLES)
    moves = within(mechanism, mechanism.goal.poses.motions)  # as far as it has to balance and to have room
    q = sample(Tree.of(moves), options.poses, options.seed)
    plain = mechanism.with_springs(
        replace(s, free_length=lengths.get(s.name, s.free_length)) for s in lines(mechanism, FREE_LENGTHS)
    )

    last: list[Array] = []  # what the rounds of making room have come to: each starts from there too
    levers = Levers.of(mechanism, lines(mechanism, FREE_LENGTHS))

    def fitted(room: ClearanceConstraint | None) -> Mechanism:
        fit = Fit(mechanism, lengths, regions, q, levers if room is None else both(levers, room))
        starts = [*fit.starts(stiffness_factor), *last[-1:]]
        found = [fit.solve(x, stiffness_factor, preload) for x in starts]
        best = min(found, key=lambda one: one[1])[0]
        last.extend([best.reshape(-1, WIDTH)] if room is not None else [])
        return fit.mechanism_of(best)

    if clearance is None:
        return Ordinary(check(mechanism), check(plain), check(fitted(None)), lengths)
    before, narrow = judge_room(moves), q
    made, after, least, aim = mechanism, before, -np.inf, clearance
    if options.free_length is not None:
        made = fitted(None)
        after = judge_room(moves.with_springs(made.springs))
    for more in range(ROOM_ROUNDS + 1):
        if after.least_of_springs >= clearance:  # what is satisfied changes nothing
            return Ordinary(check(mechanism), check(plain), check(made), lengths, (before, after))
        if more == ROOM_ROUNDS:
            break
        made = fitted(ClearanceConstraint(mechanism, narrow, aim))
        after = judge_room(moves.with_springs(made.springs))
        least = max(least, after.least_of_springs)
        aim += max(0.0, clearance - after.least_of_springs)  # rows give way: what is missing is asked for on top
        close = [gap.configuration for gap in after.of_springs if gap.distance < clearance]
        narrow = np.concatenate([narrow, *[np.repeat(at[None], WEIGHT, axis=0) for at in close]])
    raise InfeasibleError(
        f"no attachments were found that keep {1e3 * clearance:.4g} mm: the best come as near as {1e3 * least:.4g} mm; "
        "allow less, larger regions, or springs between other bodies"
    )


def _lengths(mechanism: Mechanism, given: Amount | Mapping[str, Amount] | None) -> dict[str, float]:
    names = tuple(spring.name for spring in mechanism.springs)
    if not names:
        raise InputError(f"mechanism '{mechanism.name}' has no springs that could have a free length")
    if given is None:
        return {spring.name: spring.free_length for spring in lines(mechanism, FREE_LENGTHS)}
    each = given if isinstance(given, Mapping) else dict.fromkeys(names, given)
    lengths = {name: float(value) for name, value in each.items()}  # the options hold numbers
    for name, value in lengths.items():
        if name not in names:
            raise InputError(Fault(("free_length",), f"there is no spring {nearest(name, names)}", names))
        if not 0 < value < np.inf:
            raise InputError(Fault(("free_length", name), f"must be more than 0 m, found {value:g}"))
    return lengths
