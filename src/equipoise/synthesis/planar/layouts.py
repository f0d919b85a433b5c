"""Which springs where: every layout of a planar arm that is cheapest in some sense, with springs, or why it fails.

A layout is a multiset of pairs of links, the ground being link 1 (Lee and Chen 2014, Tables 2 and 3). Candidates are
looked at in the order of their cost. Each is excluded by a criterion that is necessary (`criteria`), or by a proof that
can be checked (`exclusion`), or it is feasible: springs of that layout balance an example arm exactly, judged by
`balance.check`. What none of the three decides is left open, and said so. The search ends with the first cost at which
a layout is feasible.

Exclusions hold for every arm whose mass centres lie on its links, between the joints, with springs on the link lines.
Where the joints that springs span count, a layout has at most one spring per pair (the paper's J1): two between links i
and k may be exchanged for springs ik and (i+1)k, which span less, but for one special case (`energy.equivalent`), which
the tests exclude up to six links.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any, get_args

import numpy as np

from ...balance import Balance, check
from ...model.errors import Fault, InputError
from ...model.mechanism import Body, Joint, Mechanism
from ...model.notebook import Shown
from ...model.progress import Progress
from ...model.validate import whole_number
from .arm import PlanarArm
from .criteria import Failure, LayoutObjective, failures, objections
from .design_equations import Angles, SymbolicBlocks, design_equations
from .exclusion import Layout, Leaf, Proof, prove
from .installing import Installed, solve

MAX_LINKS, MAX_SPRINGS = 10, 12
MAX_LAYOUTS = 500_000  # candidates of one search: beyond it, hours
OBJECTIVES: tuple[LayoutObjective, ...] = get_args(LayoutObjective)
LENGTH, MASS = 0.2, 1.0  # [m, kg] of every link of the example arm, its mass centre halfway


@dataclass(frozen=True)
class Excluded:
    """Why a layout balances no arm: the necessary criteria that it fails, or a proof."""

    layout: Layout
    failures: tuple[Failure, ...]
    proof: Proof | None = None

    def __str__(self) -> str:
        if self.proof is None:
            return "; ".join(str(failure) for failure in self.failures)
        count = cases(self.proof)
        return f"proved by the signs of attachments on the link lines, in {count} case{'s' if count > 1 else ''}"

    def to_dict(self) -> dict[str, Any]:
        """An element of ``equipoise layouts --excluded --json``."""
        return {**_numbers(self.layout), "cost": None, "example": None, "excluded": str(self)}


@dataclass(frozen=True)
class Feasible:
    """A layout that balances.

    Attributes:
        cost: in terms of the objective.
        found: the springs.
        balance: the verdict on the example arm with them, exact.
        objections: what the paper's criteria for the objective, which are not necessary, have against it.
    """

    layout: Layout
    cost: float
    found: Installed
    balance: Balance
    objections: tuple[Failure, ...]

    @property
    def equations(self) -> SymbolicBlocks:
        """The design equations, with the angles that the springs have, Eqs. (39)-(43)."""
        named = zip(self.found.springs, labels(self.layout), strict=True)
        springs = ((one.i, one.k, label, Angles.of(one)) for one, label in named)
        return design_equations(self.found.equations.arm.n, springs)

    def to_dict(self) -> dict[str, Any]:
        """An element of ``equipoise layouts --json``."""
        return {
            **_numbers(self.layout),
            "cost": self.cost,
            "example": {
                "mechanism": self.balance.mechanism.name,
                "energy": self.found.energy,
                "equations": str(self.equations).splitlines(),
                "balance": self.balance.to_dict(),
            },
            "excluded": None,
        }


@dataclass(frozen=True)
class LayoutSearch(Shown):
    """What a search found.

    Attributes:
        pruned: criterion -> the layouts that fail it, and none that is tested before it.
        proved: the layouts that pass all criteria and are excluded by a proof.
        feasible: the layouts of the least cost, each with springs.
        open: the layouts that nothing has decided; only these may undercut the least cost, or share it.
    """

    n: int
    objective: LayoutObjective
    pruned: dict[str, list[Layout]]
    proved: tuple[Excluded, ...]
    feasible: tuple[Feasible, ...]
    open: tuple[Layout, ...]

    @property
    def candidates(self) -> int:
        """How many layouts were looked at."""
        pruned = sum(len(layouts) for layouts in self.pruned.values())
        return pruned + len(self.proved) + len(self.feasible) + len(self.open)

    @property
    def excluded(self) -> Iterator[Excluded]:
        """Every layout that balances nothing, with the reason."""
        for layouts in self.pruned.values():
            for layout in layouts:
                yield Excluded(layout, tuple(failures(layout, self.n)))
        yield from self.proved

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {name: [one.to_dict() for one in getattr(self, name)] for name in ("feasible", "excluded")}


def search(
    n: int,
    objective: LayoutObjective = "springs",
    springs: int | None = None,
    weight: float = 1.0,
    seed: int = 0,
    progress: Progress | None = None,
) -> LayoutSearch:
    """All layouts of least cost that balance arms of n links, the ground included.

    Args:
        objective: the number of springs; the joints that they span; or springs + `weight` times joints.
        springs: exactly so many.

    Raises:
        InputError: a bad option, or one with more than `MAX_LAYOUTS` candidates.
    """
    most = candidates(n, objective, springs, weight)
    if most > MAX_LAYOUTS:
        message = f"{most:,} layouts would have to be looked at, at most {MAX_LAYOUTS:,} are: take fewer"
        raise InputError(Fault(("n",), message))
    example = example_arm(n)
    arm = PlanarArm.of(example)
    pruned: dict[str, list[Layout]] = defaultdict(list)
    proved: list[Excluded] = []
    feasible: list[Feasible] = []
    left: list[Layout] = []
    for cost, layouts in _by_cost(n, objective, springs, weight):
        for layout in layouts:
            failed = next(failures(layout, n), None)
            if failed is not None:
                pruned[failed.criterion].append(layout)
                continue
            if progress is not None:
                progress(f"layout {name(layout)}", 0.0)
            proof = prove(layout, n)
            if proof is not None:
                proved.append(Excluded(layout, (), proof))
                continue
            found = solve(arm, layout, seed=seed, enough=1)
            balance = None if found is None else check(example.with_springs(arm.springs(found.springs)))
            if found is None or balance is None or not balance.exact:
                left.append(layout)
                continue
            feasible.append(Feasible(layout, cost, found, balance, tuple(objections(layout, n, objective))))
        if feasible:
            break
    return LayoutSearch(n, objective, dict(pruned), tuple(proved), tuple(feasible), tuple(left))


def candidates(n: int, objective: LayoutObjective = "springs", springs: int | None = None, weight: float = 1.0) -> int:
    """How many layouts a search looks at, at most: it ends with the first cost at which one is feasible.

    Raises:
        InputError: as `search`, but for the number.
    """
    whole_number("n", n, 2, MAX_LINKS)
    if objective not in OBJECTIVES:
        raise InputError(Fault(("objective",), f"there is no objective '{objective}'", OBJECTIVES))
    if springs is not None:
        whole_number("springs", springs, 1, MAX_SPRINGS)
    if not (isfinite(weight) and weight > 0):
        raise InputError(Fault(("weight",), f"must be a finite number more than 0, found {weight}"))
    cells = [cell for cost in _cells(n, objective, springs, weight).values() for cell in cost]
    most, farthest = max(size for size, _ in cells), max(joints for _, joints in cells)
    ways = np.zeros((most + 1, farthest + 1), object)  # by springs and joints, of the pairs so far; whole at any size
    ways[0, 0] = 1
    for joints in [k - i for i in range(1, n + 1) for k in range(i + 1, n + 1)]:
        one_less = ways if objective == "springs" else ways.copy()  # of which a pair may be there again, or not
        for size in range(1, most + 1):
            ways[size, joints:] += one_less[size - 1, : farthest + 1 - joints]
    return sum(int(ways[cell]) for cell in cells)


def _by_cost(
    n: int, objective: LayoutObjective, springs: int | None, weight: float
) -> Iterator[tuple[float, list[Layout]]]:
    """Layouts of the same cost, the cheapest first, as far as a feasible one is known."""
    repeated = objective == "springs"
    for cost, cells in sorted(_cells(n, objective, springs, weight).items()):
        yield cost, sorted(layout for cell in cells for layout in _layouts(n, *cell, repeated))


def _cells(
    n: int, objective: LayoutObjective, springs: int | None, weight: float
) -> dict[float, list[tuple[int, int]]]:
    """Cost -> the numbers of springs and joints that have it."""
    pairs = n * (n - 1) // 2
    most = springs or (n - 1 if objective == "springs" else pairs)
    last = inf if springs else _cost(len(default_layout(n)), span(default_layout(n)), objective, weight)
    cells: dict[float, list[tuple[int, int]]] = defaultdict(list)
    for size in range(springs or 1, most + 1):
        for joints in range(size, size * (n - 1) + 1):
            cost = _cost(size, joints, objective, weight)
            if cost <= last:
                cells[cost].append((size, joints))
    return cells


def _cost(size: int, joints: int, objective: LayoutObjective, weight: float) -> float:
    return {"springs": size, "span": joints, "weighted": size + weight * joints}[objective]


def _layouts(n: int, size: int, joints: int, repeated: bool) -> Iterator[Layout]:
    """Layouts of `size` springs that span `joints` joints altogether."""
    pairs = [(i, k) for i in range(1, n + 1) for k in range(i + 1, n + 1)]

    def more(chosen: Layout, first: int, size: int, joints: int) -> Iterator[Layout]:
        if not size:
            if not joints:
                yield chosen
            return
        for number in range(first, len(pairs)):
            i, k = pairs[number]
            rest = joints - (k - i)
            if size - 1 <= rest <= (size - 1) * (n - 1):
                yield from more((*chosen, (i, k)), number if repeated else number + 1, size - 1, rest)

    return more((), 0, size, joints)


def example_arm(n: int, length: float = LENGTH, mass: float = MASS, centre: float = 0.5) -> Mechanism:
    """An arm of n - 1 equal links that turn about y [m, kg], their mass centres at a share of their length."""
    links = ["world", *(f"link {j}" for j in range(2, n + 1))]
    return Mechanism(
        f"arm of {n} links",
        bodies=tuple(Body(link, mass, (centre * length, 0, 0)) for link in links[1:]),
        joints=tuple(
            Joint(f"joint {j + 1}", "revolute", links[j - 1], links[j], (length if j > 1 else 0, 0, 0), axis=(0, -1, 0))
            for j in range(1, n)
        ),
    )


def default_layout(n: int) -> Layout:
    """13, 14, .., 1n, 2n: the fewest springs and the smallest span at once (section 7.2)."""
    return ((1, 2),) if n == 2 else (*((1, k) for k in range(3, n + 1)), (2, n))


def span(layout: Layout) -> int:
    """The joints that springs span, altogether: Eq. (30)."""
    return sum(k - i for i, k in layout)


def name(layout: Layout) -> str:
    """``13,14,24``; with dashes where a link's number has two digits."""
    dash = "-" if any(k > 9 for _, k in layout) else ""
    return ",".join(f"{i}{dash}{k}" for i, k in layout)


def labels(layout: Layout) -> list[str]:
    """A name for each spring: 13, and 14_1, 14_2 where there are several, as in the paper's Table 5."""
    names = [name((pair,)) for pair in layout]
    return [one if names.count(one) == 1 else f"{one}_{names[: s + 1].count(one)}" for s, one in enumerate(names)]


def cases(proof: Proof) -> int:
    """How many cases a proof distinguishes."""
    return 1 if isinstance(proof, Leaf) else cases(proof.below) + cases(proof.above)


def _numbers(layout: Layout) -> dict[str, Any]:
    return {"pairs": [list(pair) for pair in layout], "springs": len(layout), "span": span(layout)}
