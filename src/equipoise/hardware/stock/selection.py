"""The best set of stock springs for a design: a proof of optimality by bounds that meet.

The attachments move so that the stock does exactly what the design's springs do. Relaxations (see `relaxation`) give
sets of springs that might be possible, the cheapest first, and a bound of the cost of every set. Each is settled:
either Newton's method finds attachments where it balances within all limits, or ever finer cells prove that none
exist. Nothing cheaper than the bound exists, so the first set that is possible is the best.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import monotonic
from typing import Any, Literal

import numpy as np

from ..._version import __version__
from ...balance import Balance, judged
from ...energy.extremes import climb
from ...io import Source
from ...model.arrays import Array
from ...model.elements import lines
from ...model.errors import Fault, InfeasibleError, InputError, nearest
from ...model.mechanism import Mechanism
from ...model.progress import Progress, silent
from ...model.units import Amount, quantity
from ..sizing.limits import Limits
from .movable import Movable, Travel
from .part import Catalogue, Stock, endurance, said
from .relaxation import OutOfTime, Pull, Relaxation

Goal = Literal["mass", "price"]
GOALS: tuple[Goal, ...] = ("mass", "price")
CELLS = 3  # of each distance, to begin with
REFINEMENTS = 60  # refinements of one set of springs before it counts as unsettled
HOW = {"extension": "eyelet", "compression": "telescope"}
"""How a part becomes a spring of zero free length."""
NEAREST = 0.010  # [m] that the two joints of a telescope need between them
OVER = 1e-9  # forces over their limit by this share are rounding


@dataclass(frozen=True)
class Selection:
    """The best set of stock springs.

    Attributes:
        mechanism: the design with stock rates and moved attachments.
        stock: the spring taken for each of the design's.
        goal: what is least.
        cost: of all of them [kg, or the price].
        bound: no set costs less.
        settled: sets of springs that were looked at one by one.
        unsettled: sets that could neither be shown possible nor impossible; those count as possible in `bound`.
        seconds: that it took.
    """

    mechanism: Mechanism
    stock: tuple[Stock, ...]
    goal: Goal
    cost: float
    bound: float
    settled: int
    unsettled: int
    seconds: float

    @property
    def gap(self) -> float:
        """(cost - bound) / cost."""
        return max(0.0, (self.cost - self.bound) / self.cost) if self.cost else 0.0

    @property
    def proven(self) -> bool:
        """Whether no other set costs less."""
        return self.gap <= 1e-9

    def to_dict(self) -> dict[str, Any]:
        """The JSON object of ``equipoise stock --json``, without the balance."""
        return {
            "goal": self.goal,
            "cost": self.cost,
            "bound": self.bound,
            "gap": self.gap,
            "proven": self.proven,
            "settled": self.settled,
            "unsettled": self.unsettled,
            "seconds": self.seconds,
            "springs": [
                {"name": spring.name, "p_a": list(spring.p_a), "p_b": list(spring.p_b), "stock": said(stock)}
                for spring, stock in zip(lines(self.mechanism, "stock"), self.stock, strict=True)
            ],
        }


def choose(
    balance: Balance | Source,
    catalogue: Catalogue,
    *,
    goal: Goal = "mass",
    travel: Travel | None = None,
    limits: Limits | None = None,
    seconds: Amount = 60.0,
    progress: Progress | None = None,
) -> Selection:
    """Choose the best stock spring for every spring of a judged design, and move its attachments.

    Args:
        limits: margins of the largest force, and against fatigue where a spring's wire is known; by default a spring
            may be used as far as its list says.

    A stock spring fits when it bears the largest force and is open at the smallest wherever its attachments may be.

    Raises:
        InputError: an unknown goal.
        UnsupportedError: springs that have a free length.
        InfeasibleError: no set of these springs can do it, or none was found in the time.
    """
    if goal not in GOALS:
        raise InputError(Fault(("goal",), f"unknown goal {nearest(goal, GOALS)}", GOALS))
    limit = quantity(seconds, "time", "seconds")
    start, movable = monotonic(), Movable(judged(balance).mechanism, travel)
    say = progress or silent
    say("looking at the stock", 0.0)
    relaxation = _relaxation(movable, catalogue, goal, limits)
    best: Selection | None = None
    bound, settled, unsettled, open_bound = 0.0, 0, 0, np.inf
    while best is None or best.cost > bound * (1 + 1e-9):
        left = limit - (monotonic() - start)
        try:
            found = relaxation.solve(seconds=left) if left > 0 else None
        except OutOfTime:
            left = 0.0
            found = None
        if found is None:
            bound = np.inf if left > 0 else bound  # everything is looked at, or the time is up
            break
        bound = max(bound, found.bound)
        say(f"set {settled + 1}, cost at least {bound:.4g}", min(1.0, 1 - left / limit))
        settled += 1
        shares = _settle(relaxation, found.stock, found.shares)
        relaxation.excluded.append(found.stock)
        if shares is None:
            unsettled += 1
            open_bound = min(open_bound, found.cost)
        elif len(shares):
            stock = tuple(catalogue[i] for i in found.stock)
            cost = float(relaxation.cost[list(found.stock)].sum())
            if best is None or cost < best.cost:
                moved = _built(movable.moved(np.array([s.rate for s in stock]), shares), stock)
                best = Selection(moved, stock, goal, cost, bound, settled, unsettled, 0.0)
    if best is None:
        why = "no set of these springs does what the design's springs do"
        if bound < np.inf or unsettled:
            why = f"none was found in {limit:g} s; {settled} sets were looked at, {unsettled} are unsettled"
        raise InfeasibleError(f"{why} with attachments moved within their limits")
    bound = min(bound, best.cost, open_bound)
    taken = monotonic() - start
    return replace(best, bound=bound, settled=settled, unsettled=unsettled, seconds=taken)


def _built(mechanism: Mechanism, stock: tuple[Stock, ...]) -> Mechanism:
    """With the parts' numbers and masses, behind an eyelet or in a case: on the ground where one end is there."""
    springs = [
        replace(
            spring, part=one.part, realisation=HOW[one.kind], mass=one.mass, diameter=one.outer_diameter,
            mass_split=0.0 if spring.body_b == "world" else 1.0,
        )
        for spring, one in zip(lines(mechanism, "stock"), stock, strict=True)
    ]  # fmt: skip
    provenance = {
        "program": f"equipoise {__version__}",
        "method": "stock",
        "parts": [said(one) for one in dict.fromkeys(stock)],
        "design": dict(mechanism.provenance),
    }
    return replace(mechanism.with_springs(springs), provenance=provenance)


def _relaxation(movable: Movable, catalogue: Catalogue, goal: Goal, limits: Limits | None) -> Relaxation:
    rate = np.array([s.rate for s in catalogue])
    force = np.array([_bears(s, limits) for s in catalogue])
    needs_room = np.array([NEAREST if s.kind == "compression" else 0.0 for s in catalogue])
    tension = np.array([s.initial_tension for s in catalogue])
    least, most = shortest(movable)
    allowed = []
    for spring, low, high in zip(movable.springs, least, most, strict=True):
        fits = np.flatnonzero(
            (rate > 0) & (tension <= rate * low) & (needs_room <= low) & (rate * high <= force * (1 + OVER))
        )
        if not len(fits):
            raise InfeasibleError(
                f"spring '{spring.name}': none of {len(catalogue):,} stock springs both bears the force and stays open"
            )
        allowed.append(fits)
    edges = [
        (_edges(movable.low[i, 0], movable.high[i, 0]), _edges(movable.low[i, 1], movable.high[i, 1]))
        for i in range(len(allowed))
    ]
    cost = np.array([s.mass if goal == "mass" else s.price for s in catalogue])
    relaxation = Relaxation(movable, rate, force, cost, allowed, edges)
    for shares in (movable.low, np.ones_like(movable.low), movable.high):
        relaxation.pulls += _pulls(movable, _longest(movable, shares)[1], shares)
    return relaxation


def _bears(part: Stock, limits: Limits | None) -> float:
    """[N] that it may be used to, if it goes back to nothing between; nothing for a kind that pulls at no eyelet."""
    if part.kind not in HOW:
        return 0.0
    if limits is None:
        return part.max_force
    top, _ = endurance(part, limits)
    return min(part.max_force / limits.safety, 1 / top if top else np.inf)


def _edges(low: float, high: float) -> Array:
    return np.geomspace(low, high, CELLS + 1) if high > low else np.array([low, high])


def shortest(movable: Movable) -> tuple[Array, Array]:
    """(springs,) [m]: the least that each spring's length can be anywhere, and the least that its longest can be.

    Over the sampled poses, with the attachments wherever they may be.
    """
    t, e_a, e_b = movable.directions(movable.poses)
    length = np.array([[ray.length for ray in pair] for pair in movable.rays])
    a, b = (np.stack([movable.low[:, j], movable.high[:, j]]) * length[:, j] for j in range(2))
    nearest_ = _nearest(t, e_a, e_b, a, b)
    return nearest_.min(axis=0), nearest_.max(axis=0)


def _nearest(t: Array, e_a: Array, e_b: Array, a: Array, b: Array) -> Array:
    """(N, springs) least |t - a e_a + b e_b| over the box of a and b, (2, springs) each: a convex problem in two."""

    def length(x: Array, y: Array) -> Array:
        return np.linalg.norm(t - x[..., None] * e_a + y[..., None] * e_b, axis=2)

    dot = lambda x, y: np.einsum("nsi,nsi->ns", x, y)  # noqa: E731
    ta, tb, ab = dot(t, e_a), dot(t, e_b), dot(e_a, e_b)
    best = np.full(ta.shape, np.inf)
    for side in range(2):  # on the four edges
        x = np.broadcast_to(a[side], ta.shape)
        y = np.clip(x * ab - tb, b[0], b[1])
        best = np.minimum(best, length(x, y))
        y = np.broadcast_to(b[side], ta.shape)
        best = np.minimum(best, length(np.clip(ta + y * ab, a[0], a[1]), y))
    det = 1 - ab**2
    with np.errstate(divide="ignore", invalid="ignore"):  # and inside
        x, y = (ta - ab * tb) / det, (ab * ta - tb) / det
    inner = (det > 1e-12) & (x > a[0]) & (x < a[1]) & (y > b[0]) & (y < b[1])
    return np.where(inner, np.minimum(best, length(np.where(inner, x, 0.0), np.where(inner, y, 0.0))), best)


def _longest(movable: Movable, shares: Array) -> tuple[Array, Array]:
    """(springs,) [m] how long each spring gets with its attachments there, and (springs, n) where."""
    return climb(movable.tree, lambda q: np.linalg.norm(movable.reach(q, shares), axis=2), movable.poses)


def _pulls(movable: Movable, q: Array, shares: Array) -> list[Pull]:
    """The force of every spring at its own pose, q (springs, n), in the direction that it has there."""
    t, e_a, e_b = movable.directions(q)
    d = movable.reach(q, shares)
    found = []
    for i, size in enumerate(movable.size):
        u = d[i, i] / np.linalg.norm(d[i, i])
        found.append(Pull(i, size * np.array([u @ t[i, i], -(u @ e_a[i, i]), u @ e_b[i, i]])))
    return found


def _settle(relaxation: Relaxation, stock: tuple[int, ...], shares: Array) -> Array | None:
    """Distances (springs, 2) at which these springs do it; none (0, 2) when that is impossible; None if unsettled."""
    movable = relaxation.movable
    k = relaxation.stiffness[list(stock)] / np.array([s.stiffness for s in movable.springs])
    force = relaxation.force[list(stock)]
    for _ in range(REFINEMENTS):
        inner = relaxation.solve(fixed=stock)
        if inner is None:
            return np.empty((0, 2))
        for guess in (inner.shares, shares):
            found = movable.solve(k, guess)
            if found is not None and movable.inside(found):
                length, q = _longest(movable, found)
                if (relaxation.stiffness[list(stock)] * length <= force * (1 + OVER)).all():
                    return found
                relaxation.pulls += _pulls(movable, q, found)
        if not relaxation.split(inner.shares):
            return None
        shares = inner.shares
    return None
