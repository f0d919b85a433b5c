"""Of equivalent designs the one that a person would draw.

Rotating a moment matrix's factor, sliding both ends along parallel axes, turning a spring about its only hinge, trading
stiffness for length: all leave the torque as it is at every pose. Of the designs that are as good as the one that was
found, to 0.01 % of the unbalanced torque, each is moved along such changes to where its `Wishes` are met best
(`equal_torque`), and the best is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from .equal_torque import same_torque
from .few_springs import ROUNDING_SHARE, SpringSet
from .goal import Goal, Rms, rms
from .polish import Parts
from .wishes import Preference, Wishes

EQUAL = 1e-4  # of the unbalanced torque: designs this close to each other count as equivalent
LOOKED_AT = 2  # designs of one number of parts
LIGHTER = 1 / 3  # one part more is worth it where all together weigh less than this share: their largest stored energy


def preferred(
    goal: Goal, found: SpringSet, sets: Mapping[int, Sequence[SpringSet]], most: int, prefer: Preference | None = None
) -> SpringSet:
    """The best of what is equivalent to a set; with one part more, up to `most`, only where that is far lighter.

    Args:
        sets: those that the search found, by their number of parts. For another goal than the mean square only what
            leaves the same torques as the set is looked at.
    """
    limit = found.value + EQUAL
    chosen, weight = found, np.inf
    for count in range(found.count, min(max(most, found.count), found.count + 1) + 1):
        others = sets.get(count, ()) if isinstance(goal, Rms) else ()
        equal = [one for one in others if one is not found and one.exact == found.exact and one.value <= limit]
        equal = ([found, *equal] if count == found.count else equal)[:LOOKED_AT]
        if not equal:
            continue
        wishes = Wishes(goal.reduced, Parts.joined([one.parts for one in equal]), prefer)
        best = min(_moved(goal, wishes, equal), key=lambda one: wishes.worth(one.parts)[0])
        stored = wishes.stored(best.parts)
        if stored < LIGHTER * weight:
            chosen, weight = best, stored
    return chosen


def _moved(goal: Goal, wishes: Wishes, equal: Sequence[SpringSet]) -> Iterator[SpringSet]:
    """The sets, and where they meet the wishes better; what is preferred is looked for from the ends of usual walks."""

    def walk(own: Wishes, one: SpringSet) -> SpringSet:
        parts = wishes.drawn(same_torque(own, wishes.drawn(one.parts)))
        left = float(rms(goal.reduced, parts)[0])
        if one.exact and left >= ROUNDING_SHARE:
            return one
        value = left if isinstance(goal, Rms) else one.value
        return replace(one, parts=parts, value=value, cost=float(parts.cost(goal.reduced)[0]))

    usual, strict = wishes.usual
    walked = [walk(usual, one) for one in equal]
    best = min(range(len(walked)), key=lambda i: wishes.worth(walked[i].parts)[0])
    every = [*equal, *walked]
    if usual.worth(walked[best].parts)[0][0]:  # an end is on the wrong side
        every.append(walk(strict, equal[best]))
    yield from every
    if wishes.prefer is not None:
        yield from (walk(wishes, one) for one in every)
