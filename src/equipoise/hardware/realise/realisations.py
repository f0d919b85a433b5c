"""How the springs of a design can be made: five ways to install a helical spring, and what each leaves unbalanced.

* direct: an extension spring between the attachments; its initial tension F_0 makes up for its length L_0, and what it
  does not make up for, L_0 - F_0/k, is left as free length
* case: an extension spring in a case that turns about A and reaches behind it: no free length (Simionescu, Ciupitu and
  Ionita 2015, Fig. 8b)
* telescope: a compression spring in a telescopic case that turns about A, pressed by a rod from B: no free length (the
  same, Fig. 8a)
* pulley: an extension spring elsewhere on A's body, pulled by a cable that leaves over a pulley at A: no free length,
  but the cable's length over the pulley is not quite the distance from A to B
* eyelet: the same with a smooth hole instead of the pulley: no error of length, more friction

Residuals are those of the mechanism with this one spring so installed and the others ideal.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np

from ...balance import Balance
from ...kinematics import Tree, sample
from ...model.arrays import Array, frozen, vec3
from ...model.elements import Spring, lines
from ...model.mechanism import Mechanism
from ...model.units import AmountField, share
from ..sizing.limits import Limits
from ..sizing.winding import Envelope, Need, Winding, compression, extension, side_by_side
from ..sizing.wire import MM, WIRES, Wire
from .installed import Torques, installed_torque
from .stretch import Pulley, Straight, Stretch, beyond

KINDS = ("direct", "case", "telescope", "pulley", "eyelet")
FRICTION = {"direct": 0.0, "case": 0.03, "telescope": 0.05, "pulley": 0.02, "eyelet": 0.15}
"""Share of the spring's force that friction holds back. Assumed, by no standard: loops that roll on pins, a spring that
rubs in its case, a spring that rubs and a rod that slides, a pulley on ball bearings, a polished hole with the cable
bent by about a right angle."""
LEAST_FREE = 0.1 * MM  # less free length than this counts as none when springs are compared


@dataclass(frozen=True)
class Options:
    """What springs may be made of and the room that they have.

    Attributes:
        wires: grades to choose from.
        limits: what springs may bear.
        envelope: room for each spring.
        pulley: radius of the pulleys, to the middle of the cable [m].
        ends: how near to each other the joints at A and B of a case can come [m].
        most: springs side by side.
        friction: share of the force, for each of `KINDS`.
    """

    wires: tuple[Wire, ...] = (WIRES["DH"],)
    limits: Limits = field(default_factory=Limits)
    envelope: Envelope = field(default_factory=lambda: Envelope())
    pulley: AmountField = AmountField("length", 10 * MM)
    ends: AmountField = AmountField("length", 10 * MM)
    most: int = 8
    friction: Mapping[str, Any] = field(default_factory=lambda: dict(FRICTION))

    def __post_init__(self) -> None:
        held = {kind: share(value, "friction", kind) for kind, value in self.friction.items()}
        object.__setattr__(self, "friction", held)


@frozen
class Realisation:
    """One way to make one spring of a design.

    Attributes:
        kind: one of `KINDS`.
        winding: the spring, or the nearest to one.
        reason: why it does not work; empty when it does.
        stretch: its law, for the judgement of the mechanism.
        behind: how far a case reaches behind A [m].
        residual: (n,) largest residual torque of the mechanism with it [N m or N]; None when it does not work.
        share: the same, of the largest unbalanced torque.
        friction: share of its force.
    """

    kind: str
    winding: Winding
    reason: str
    stretch: Stretch
    friction: float
    behind: float | None = None
    residual: Array | None = None
    share: float | None = None

    @property
    def works(self) -> bool:
        """Whether it can be made and moves through the whole workspace."""
        return not self.reason


def realisations(balance: Balance, i: int, options: Options) -> tuple[Realisation, ...]:
    """All ways to make spring `i` of a judged mechanism, those that do not work with the reason."""
    spring, use = lines(balance.mechanism, "hardware")[i], balance.use[i]
    shortest, free = use.min_length, spring.free_length
    k = spring.stiffness
    need = Need(k, k * max(shortest - free, 0.0), use.max_force)
    pushes = ""
    if shortest < free - LEAST_FREE:
        pushes = (
            f"it comes to {shortest / MM:.1f} mm, less than its free length of {free / MM:.1f} mm, where it must push"
        )
    return (
        _direct(balance, i, need, options, pushes),
        _case(balance, i, need, options, pushes),
        _telescope(balance, i, need, options, pushes),
        _cable(balance, i, need, options, pushes, "pulley", options.pulley),
        _cable(balance, i, need, options, pushes, "eyelet", 0.0),
    )


def _direct(balance: Balance, i: int, need: Need, options: Options, pushes: str) -> Realisation:
    spring, shortest = lines(balance.mechanism, "hardware")[i], balance.use[i].min_length

    def wind(part: Need) -> Winding:
        return extension(
            part, options.wires, options.limits, options.envelope, free=spring.free_length,
            closed=max(shortest, 1e-6), order=lambda s: np.round((s.left_over - spring.free_length) / LEAST_FREE),
        )  # fmt: skip

    winding = side_by_side(wind, need, options.most)
    free = max(getattr(winding.spring, "left_over", 0.0), 0.0)
    closed = f"the attachments come as near as {shortest / MM:.1f} mm; " if winding.reason else ""
    made = Realisation("direct", winding, pushes or closed + winding.reason, Straight(free), options.friction["direct"])
    if not made.works:
        return made
    if abs(free - spring.free_length) < 1e-12:
        return _ideal(balance, made)
    return _judged(balance.mechanism, i, made)


def _case(balance: Balance, i: int, need: Need, options: Options, pushes: str) -> Realisation:
    spring = lines(balance.mechanism, "hardware")[i]
    winding = side_by_side(
        lambda part: extension(part, options.wires, options.limits, options.envelope, free=spring.free_length),
        need, options.most,
    )  # fmt: skip
    reason = pushes or winding.reason or _too_near(balance.use[i].min_length, options)
    behind = max(getattr(winding.spring, "left_over", 0.0) - spring.free_length, 0.0)
    law = Straight(spring.free_length)
    return _ideal(balance, Realisation("case", winding, reason, law, options.friction["case"], behind))


def _telescope(balance: Balance, i: int, need: Need, options: Options, pushes: str) -> Realisation:
    spring, shortest = lines(balance.mechanism, "hardware")[i], balance.use[i].min_length
    winding = side_by_side(
        lambda part: compression(part, options.wires, options.limits, options.envelope), need, options.most
    )
    reason = pushes or winding.reason or _too_near(shortest, options)
    # cap at most `ends` short of B when B is nearest; the spring, `free_length` long less what it is pressed, behind it
    pressed = shortest - spring.free_length
    behind = max(winding.spring.free_length - pressed - (shortest - options.ends) + options.ends, 0.0)
    law = Straight(spring.free_length)
    return _ideal(balance, Realisation("telescope", winding, reason, law, options.friction["telescope"], behind))


def _cable(
    balance: Balance, i: int, need: Need, options: Options, pushes: str, kind: str, radius: float
) -> Realisation:
    mechanism, spring = balance.mechanism, lines(balance.mechanism, "hardware")[i]
    d = _seen_from_a(mechanism, spring)
    law = best_pulley(mechanism, i, d, radius)
    stretch, _ = law(d)
    least, most = (spring.stiffness * float(x) for x in (stretch.min(), stretch.max()))
    need = Need(need.rate, min(need.least, max(least, 0.0)), max(need.most, most))
    winding = side_by_side(
        lambda part: extension(part, options.wires, options.limits, options.envelope), need, options.most
    )
    reason = pushes or winding.reason
    if not reason and radius and (gap := float(beyond(law, d).min())) <= 0:
        reason = f"the cable's end comes {-gap / MM:.1f} mm inside the pulley of {radius / MM:g} mm radius"
    if not reason and stretch.min() < -LEAST_FREE:
        reason = f"the cable goes slack by {-stretch.min() / MM:.1f} mm"
    made = Realisation(kind, winding, reason, law, options.friction[kind])
    if not made.works:
        return made
    if not radius:
        return _ideal(balance, made)
    return _judged(mechanism, i, made)


def best_pulley(mechanism: Mechanism, i: int, d: Array, radius: float) -> Pulley:
    """The pulley of a radius for spring `i`: the cable comes from behind A, and its preload leaves the least torque.

    Args:
        d: (N, 3) vectors from A to B in the frame of A's body, as `check` samples them.
    """
    spring = lines(mechanism, "hardware")[i]
    mean = d.mean(axis=0)
    if np.linalg.norm(mean) < 1e-9 * np.linalg.norm(d, axis=1).max():
        mean = d[0]
    law = Pulley(radius, vec3(mean / np.linalg.norm(mean)), -spring.free_length)
    if not radius:
        return law
    # the torque is linear in the preload: least squares
    q = sample(Tree.of(mechanism), mechanism.workspace.samples)
    laws: list[Stretch] = [Straight(s.free_length) for s in lines(mechanism, "hardware")]
    laws[i] = law
    gravity, springs = Torques(mechanism, laws)(q)
    laws[i] = replace(law, preload=law.preload + 1.0)
    per_metre = Torques(mechanism, laws)(q)[1][:, i] - springs[:, i]
    left = gravity + springs.sum(axis=1)
    size = float((per_metre**2).sum())
    return replace(law, preload=law.preload - float((left * per_metre).sum()) / size) if size else law


def _seen_from_a(mechanism: Mechanism, spring: Spring) -> Array:
    """(N, 3) [m] from A to B in the frame of A's body, over the poses that `check` samples."""
    tree = Tree.of(mechanism)
    poses = tree.poses(sample(tree, mechanism.workspace.samples))
    A, B = tree.index[spring.body_a], tree.index[spring.body_b]
    d = poses.point(B, np.array(spring.p_b)) - poses.point(A, np.array(spring.p_a))
    return np.einsum("nji,nj->ni", poses.R[:, A], d)


def _ideal(balance: Balance, made: Realisation) -> Realisation:
    """It does exactly what the design says, and so leaves what the design leaves."""
    return replace(made, residual=balance.residual.max, share=balance.relative) if made.works else made


def _too_near(shortest: float, options: Options) -> str:
    if shortest >= options.ends:
        return ""
    found = f"the attachments come as near as {shortest / MM:.1f} mm"
    return f"{found}, the two joints of a case need {options.ends / MM:g} mm"


def _judged(mechanism: Mechanism, i: int, made: Realisation) -> Realisation:
    """With what it leaves when spring `i` is made so and the others are ideal."""
    laws = [
        made.stretch if j == i else Straight(spring.free_length)
        for j, spring in enumerate(lines(mechanism, "hardware"))
    ]
    judged = installed_torque(mechanism, laws)
    return replace(made, residual=judged.residual, share=judged.share)


def rank(made: Realisation) -> tuple[bool, float, float]:
    """Which is better: one that works, then the one that leaves least (to 0.1 % of unbalanced), then the lightest."""
    share = inf if made.share is None else round(made.share, 3)
    return not made.works, share, made.winding.mass
