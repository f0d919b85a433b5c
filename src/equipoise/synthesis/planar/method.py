"""The method `planar`: springs straight between the links of a planar arm, exact, in a layout of one's choice.

Y.-Y. Lee and D.-Z. Chen, "Determination of spring installation configuration on statically balanced planar articulated
manipulators", Mechanism and Machine Theory 74 (2014). A layout says which links the springs join; their stiffnesses and
attachments solve the design equations, Eq. (23). Beyond the paper: any number of links, mass centres off the link line,
given stiffnesses or attachments, a limit on the attachments.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import isinf, log
from typing import Any

import numpy as np

from ...model.errors import EquipoiseError, Fault, InfeasibleError, InputError
from ...model.mechanism import Mechanism
from ...model.progress import Progress
from ...model.units import Amount
from ...model.validate import whole_number
from ..design import Design
from ..given import Given, number, numbers
from ..method import Method
from ..options import MethodOptions, option, takes
from .arm import Installation, PlanarArm, obstacles, upward
from .criteria import failures
from .elongation import Elongation
from .equivalent import exchanged
from .exclusion import Layout, prove
from .installing import STIFFNESS, A, B, Fixed, Installed, solve
from .layouts import Excluded, default_layout, labels, name

ENDS = ("lower", "upper")
NEAR = 1e-6  # relative: how much longer than allowed is not
STOCK = 200  # choices from stock that are tried
NEAREST = 4  # stiffnesses in stock to choose from, for each spring


@dataclass(frozen=True, kw_only=True)
class PlanarOptions(MethodOptions):
    """What the method planar can be asked for.

    Attributes:
        layout: for each spring the two links that it joins: ``13`` or ``1-3``, the ground being link 1, or names of
            bodies, ``world:forearm``. By default 13, 14, .., 1n, 2n: the fewest springs and the smallest span.
        limit: [m] of every attachment from its joint: on the ground the first one, else the joint to the next link for
            the spring's lower link, and the joint of its upper link. By default as close as is found, in multiples of
            the longest link.
        stiffness, a, b: fixed values [N/m, m, m] by the name of a spring: ``13``, or ``14_1`` and ``14_2`` where two
            join the same links. `a` is counted from the joint of the lower link along that link, the ground's upwards;
            `b` from the joint of the upper link along it; negative values lie on the other side.
        stock: the stiffnesses to choose from [N/m].
        longest: [m] that a spring gets in any pose.
        exchange: ``14:lower`` for two springs 14 as 14 and 24 in the end, Eq. (28a), ``14:upper`` as 14 and 13, (28b).
        seed: of the random starts.
    """

    layout: Sequence[str] | None = option(
        None, "names", "13,14,24: the links of each spring, ground is 1 (default 13,14,..,1n,2n)"
    )
    limit: Amount | None = option(None, "length", "of attachments from their joints (default: as close as is found)")
    stiffness: Given = option(None, "stiffness", "of a spring: stiffness.13, stiffness.14_1", each=True)
    a: Given = option(
        None, "length", "of a spring, along its lower link from the far joint; the ground's is up", each=True
    )
    b: Given = option(None, "length", "of a spring, along its upper link from the near joint", each=True)
    stock: Sequence[Amount] | None = option(None, "stiffness", "K,K,...: stiffnesses to choose from", many=True)
    longest: Amount | None = option(None, "length", "that a spring gets in any pose (default: no limit)")
    exchange: str | None = option(
        None, "text", "14:lower or 14:upper: two springs 14 as 14 and 24, Eq. (28a), or 13, (28b)"
    )
    seed: int = option(0, "whole", "of the random starts (default 0)")


@takes(PlanarOptions)
def design(mechanism: Mechanism, options: PlanarOptions) -> Design:
    """Exact springs for a layout; of the solutions found, the one that stores least. The arm's own springs go.

    Raises:
        InfeasibleError: the layout balances no such arm, or no springs were found; the message says which.
        InputError: a bad option.  UnsupportedError: not a planar serial arm.
    """
    seed, progress = options.seed, options.progress
    whole_number("seed", seed, 0)
    bare = mechanism.with_springs(())
    arm = PlanarArm.of(bare)
    chosen = default_layout(arm.n) if options.layout is None else _read(options.layout, arm)
    limit = None if options.limit is None else number("limit", options.limit, positive=True)
    longest = None if options.longest is None else number("longest", options.longest, positive=True)
    fixed = _fixed(labels(chosen), options.stiffness, options.a, options.b)
    stock = None if options.stock is None else [number("stock", k, positive=True) for k in options.stock]
    why = reason(arm, chosen)
    if why:
        raise InfeasibleError(f"springs {name(chosen)} balance no such arm: {why}")
    if progress is not None:
        progress("solving the design equations", 0.0)
    elongation = None if longest is None else Elongation.of(bare, arm, longest)
    found = solve(arm, chosen, limit, fixed, seed, elongation=elongation)
    if found is not None and stock is not None:
        found = _from_stock(found, stock, seed, progress)
    if found is None:
        raise InfeasibleError(_none(chosen, limit, fixed, stock, longest))
    springs = found.springs if options.exchange is None else _exchanged(found, options.exchange)
    free = {**_free(found, springs, stock, seed), "longest": longest, "exchange": options.exchange}
    designed = Design.of(bare.with_springs(arm.springs(springs)), "planar", free)
    used = max(use.path[1] for use in designed.balance.use)
    if longest is not None and used > longest * (1 + NEAR):
        raise InfeasibleError(f"a spring of {name(chosen)} gets {used:.6g} m long, more than the {longest:g} m allowed")
    if not designed.balance.exact:
        raise EquipoiseError(
            f"the springs found for {name(chosen)} do not balance: a fault of the method, please report"
        )
    return designed


def reason(arm: PlanarArm, layout: Layout) -> str | None:
    """Why a layout cannot balance an arm, proved; None when it may."""
    weight = arm.moments[1:] / arm.lengths[1:]
    gaps = np.diff(weight[:-1])  # the end link's length is anything
    if abs(np.concatenate([weight, gaps])).min() <= 1e-9 * abs(weight).max():
        return None  # gravity leaves a link alone, or acts on two alike: the criteria do not hold
    falling = (weight.real > 0).all() and (gaps.real < 0).all()
    failed = tuple(failures(layout, arm.n))
    proof = prove(layout, arm.n) if not failed and arm.straight and falling else None
    return str(Excluded(layout, failed, proof)) if failed or proof else None


def _read(texts: Sequence[str], arm: PlanarArm) -> Layout:
    if not texts:
        raise InputError(Fault(("layout",), "has no springs; expected pairs of links such as 13,14,14"))
    return tuple(sorted(_pair(text, arm) for text in texts))


def _pair(text: str, arm: PlanarArm) -> tuple[int, int]:
    ends = text.split(":") if ":" in text else text.split("-") if "-" in text else list(text)
    every = [*map(str, range(1, arm.n + 1)), *arm.links]
    numbers = [every.index(end.strip()) % arm.n + 1 for end in ends if end.strip() in every]
    if len(ends) != 2 or len(numbers) != 2 or numbers[0] == numbers[1]:
        raise InputError(
            Fault(("layout",), f"expected two links such as 13, 1-3 or {arm.links[0]}:{arm.links[-1]}, found '{text}'",
                  tuple(f"{j} ({link})" for j, link in enumerate(arm.links, 1)))
        )  # fmt: skip
    return min(numbers), max(numbers)


def _fixed(names: list[str], stiffness: Given, a: Given, b: Given) -> Fixed:
    """The values given; an end on its joint, 0, would make the spring one of the neighbouring link."""
    given = ((STIFFNESS, "stiffness", stiffness, True), (A, "a", a, None), (B, "b", b, None))
    return {
        (names.index(label), which): value
        for which, option, values, positive in given
        for label, value in numbers(option, values, names, positive).items()
    }


def _from_stock(free: Installed, stock: Sequence[float], seed: int, progress: Progress | None) -> Installed | None:
    """A solution with every stiffness from a list, near the free one."""
    of = free.equations
    wanted = [one.stiffness for one in free.springs]
    choices = [
        [of.fixed[s, STIFFNESS]]
        if (s, STIFFNESS) in of.fixed
        else sorted(stock, key=lambda k, w=w: abs(log(k / w)))[:NEAREST]
        for s, w in enumerate(wanted)
    ]

    def off(chosen: tuple[float, ...]) -> float:
        return sum(log(k / w) ** 2 for k, w in zip(chosen, wanted, strict=True))

    tried = sorted(product(*choices), key=off)[:STOCK]
    for number_, chosen in enumerate(tried):
        if progress is not None:
            progress("choosing from stock", number_ / len(tried))
        held = replace(of, fixed={**of.fixed, **{(s, STIFFNESS): k for s, k in enumerate(chosen)}})
        found = held.solve(seed, starts=4, near=free.x)
        if found is not None:
            return found
    return None


def _exchanged(found: Installed, text: str) -> tuple[Installation, ...]:
    """The springs with two of them exchanged, Eqs. (28a, b).

    Raises:
        InputError: no two springs between the links named.  InfeasibleError: no two springs have this effect.
    """
    pair, _, end = text.partition(":")
    arm = found.equations.arm
    links = _pair(pair, arm)
    two = [spring for spring in found.springs if (spring.i, spring.k) == links]
    if len(two) != 2 or end not in ENDS:
        asked = f"expected two springs of the layout and {' or '.join(ENDS)}, such as 14:lower, found '{text}'"
        raise InputError(Fault(("exchange",), asked))
    rest = [spring for spring in found.springs if spring not in two]
    made = exchanged(arm, two[0], two[1], "lower" if end == "lower" else "upper")
    return tuple(sorted((*rest, *made), key=lambda spring: (spring.i, spring.k)))


def _none(layout: Layout, limit: float | None, fixed: Fixed, stock: object, longest: float | None) -> str:
    asked = [
        *([f"lengths of at most {longest:g} m"] if longest is not None else []),
        *([f"attachments within {limit:g} m"] if limit is not None else []),
        *([f"{len(fixed)} given values"] if fixed else []),
        *(["stiffnesses from stock"] if stock is not None else []),
    ]
    given = f" with {' and '.join(asked)}" if asked else ""
    return f"no springs {name(layout)}{given} were found that balance this arm, nor a proof that there are none"


def _free(
    found: Installed, springs: Sequence[Installation], stock: Sequence[float] | None, seed: int
) -> dict[str, Any]:
    of = found.equations
    layout = tuple((one.i, one.k) for one in springs)
    names = labels(layout)

    def along(z: complex) -> float | list[float]:
        return z.real if of.arm.straight else [z.real, z.imag]

    return {
        "layout": [name((pair,)) for pair in layout],
        "stiffness": {label: one.stiffness for label, one in zip(names, springs, strict=True)},
        "a": {label: along(one.a / upward(one.i)) for label, one in zip(names, springs, strict=True)},
        "b": {label: along(one.b) for label, one in zip(names, springs, strict=True)},
        "limit": None if isinf(of.limit) else of.limit,
        "stock": None if stock is None else list(stock),
        "seed": seed,
    }


METHOD = Method(
    "planar",
    "springs straight between the links of a planar serial arm, in a layout of your choice: exact, n - 1 for n links",
    "Lee and Chen (2014), Eqs. (7)-(8), (18), (23), (29)",
    obstacles,
    design,
    PlanarOptions,
)
