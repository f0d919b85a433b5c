"""The method `convex`: the least torque any springs can leave, and few real springs measured against that bound."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..energy.potential import lumped_masses
from ..errors import EquipoiseError, InfeasibleError, InputError
from ..mechanism import Mechanism
from ..validate import whole_number
from .bound import least_rms
from .design import Design, Infeasible
from .gram import Gram, build
from .judge import Judge
from .method import Method, Parameter
from .mounts import Mounts
from .problem import OBJECTIVES, Objective, Pair, Problem, Progress, Region, Shape
from .search import FEASIBLE, NOTHING, Found, Search

ROUNDING = 1e-13
MOST = 8  # springs tried when no number is given
NEAR = 0.01  # of the unbalanced torque: close enough to the bound to stop adding springs
FAR = 10.0  # times as large: regions that tell whether the pairs or the regions are to blame
REMEDIES = 24  # other pairs tried when exact balance is infeasible
FEW = 300  # poses that tell whether exact balance is possible


def design(
    mechanism: Mechanism,
    *,
    span: int = 2,
    pairs: Iterable[Pair] | None = None,
    radius: float | None = None,
    shape: Shape = "ball",
    regions: Mapping[str, Region] | None = None,
    springs: int | None = None,
    objective: Objective = "rms",
    joints: Iterable[str] | None = None,
    samples: int | None = None,
    unlimited: bool = False,
    exact: bool = False,
    front: bool = False,
    keep: bool = False,
    seed: int = 0,
    progress: Progress | None = None,
) -> Design:
    """Choose springs between bodies of a mechanism (THEORY section 4).

    Args:
        span, pairs, radius, shape, regions, objective, joints, samples, seed: see `Problem.of`.
        springs: at most so many; by default the fewest that are exact where that is possible, else that come within
            1 % of the unbalanced torque of the bound.
        unlimited: judge over all configurations, ignoring the ranges of the joints that turn.
        exact: insist on exact balance.
        front: also list the best design for every number of springs up to `springs` (8 by default).
        keep: the mechanism's own springs stay and count as a load; else they are replaced.
        progress: called with what is being done and the share of it that is done.

    Raises:
        InfeasibleError: `exact`, and no springs on the pairs do it, or none were found.
        InputError: a bad option, or loops that cannot be closed.
    """
    if springs is not None:
        whole_number("springs", springs, 1)
    bare = mechanism if keep else mechanism.with_springs(())
    problem = Problem.of(
        over_all_turns(bare) if unlimited else bare,
        span=span,
        pairs=pairs,
        radius=radius,
        shape=shape,
        regions=regions,
        objective=objective,
        joints=joints,
        samples=samples,
        seed=seed,
    )
    gram = _worth_solving(build(problem, progress))
    search = Search(gram, seed, progress)
    bound = search.floor
    infeasible = None if bound < FEASIBLE else _infeasible(gram, bound)
    if exact and infeasible is not None:
        raise InfeasibleError(str(infeasible))
    found, tried = _found(search, springs, bound, front)
    judge = Judge(gram, 0.0 if infeasible is None else bound, objective, bare)
    best = judge(search.pruned(found))
    averaged = gram.averaged and objective == "rms"
    design = Design(
        mechanism=best.mechanism,
        method="convex",
        objective=objective,
        joints=problem.joints,
        residual=best.value * judge.unit,
        unbalanced=judge.unit,
        bound=min(judge.least, best.value) * judge.unit,  # equal but for rounding where the bound is reached
        averaged=averaged,
        samples=None if averaged else problem.count,
        free_parameters=_options(problem, span if pairs is None else None, springs, unlimited, keep),
        exact_feasible=infeasible is None,
        infeasible=infeasible,
        front=tuple(judge.row(row) for row in tried) if front else (),
    ).with_provenance()
    if exact and not design.balance.exact:
        raise InfeasibleError(
            f"springs on these pairs may balance exactly, but none were found with {found.count} or fewer: "
            f"the best leaves {design.residual:.3g} N m {objective} where it counts; allow more springs"
        )
    return design


def applies(mechanism: Mechanism) -> list[str]:
    """Why the method does not apply; empty when it does."""
    return []


def _worth_solving(gram: Gram) -> Gram:
    """The problem on those of its pairs that have an effect."""
    mechanism = gram.problem.mechanism
    mass = sum(mass for _, mass, _ in lumped_masses(mechanism))
    weight = mass * float(np.linalg.norm(mechanism.gravity)) * Mounts.of(mechanism).reach
    if gram.unbalanced <= ROUNDING * weight:
        what = "the springs that stay balance" if mechanism.springs else "gravity loads"
        which = "every joint that counts already" if mechanism.springs else "no joint that counts"
        raise InputError(f"mechanism '{mechanism.name}': nothing to balance, {what} {which}")
    if not gram.useful:
        raise InfeasibleError("no spring on these pairs has any effect on a joint that counts")
    return gram.on(gram.useful)


def _found(search: Search, springs: int | None, bound: float, every: bool) -> tuple[Found, list[Found]]:
    """The design to deliver, and what was tried: with `every`, also what comes after it."""
    tried: list[Found] = []
    enough: Found | None = None
    for found in search.front(springs or MOST):
        tried.append(found)
        near = springs is None and bound >= FEASIBLE and found.value <= bound + NEAR
        if enough is None and (found.exact or near):
            enough = found
            if not every:
                break
    best = enough or tried[-1]
    if best.value > 1 - NOTHING:
        raise InfeasibleError("no springs on these pairs lower the torque of the joints that count")
    if bound > best.value + FEASIBLE:
        raise EquipoiseError(
            f"the convex solver's bound ({bound:.3g} of the unbalanced torque) contradicts a design that leaves "
            f"{best.value:.3g}: the problem is badly scaled; try a larger radius"
        )
    return best, tried


def _infeasible(gram: Gram, bound: float) -> Infeasible:
    problem = gram.problem
    far = least_rms(gram.enlarged(FAR)).value
    own = tuple(block.place for block in gram.blocks)
    present = {frozenset(pair) for pair in own}
    mounts = Mounts.of(problem.mechanism)
    # a large mechanism has hundreds of other pairs: the nearest ones are tried
    missing = [p for p in mounts.pairs(len(mounts.bodies)) if frozenset(p) not in present]
    missing = sorted(missing, key=mounts.apart)[:REMEDIES]
    wider = problem.with_pairs([*(pair for pair in problem.pairs if pair in own), *missing])
    if not gram.averaged:  # exact balance at a few hundred random poses is exact balance
        wider = replace(wider, samples=FEW)
    wide = build(wider)
    number = {block.place: i for i, block in enumerate(wide.blocks)}
    stay = [number[place] for place in own]
    remedies = [p for p in missing if least_rms(wide.on([*stay, number[p]])).value < FEASIBLE]
    unit = gram.unbalanced
    far = far * unit if far >= FEASIBLE else 0.0
    return Infeasible(own, bound * unit, far, tuple(remedies), len(missing))


def over_all_turns(mechanism: Mechanism) -> Mechanism:
    """The mechanism without the ranges of its revolute joints."""
    return replace(
        mechanism, joints=tuple(replace(j, range=None) if j.type == "revolute" else j for j in mechanism.joints)
    )


def _options(problem: Problem, span: int | None, springs: int | None, unlimited: bool, keep: bool) -> dict[str, Any]:
    return {
        **({"span": span} if span is not None else {}),
        "pairs": [list(pair) for pair in problem.pairs],
        "regions": {
            name: {"shape": region.shape, "centre": list(region.centre), "half": list(region.half)}
            for name, region in problem.regions.items()
        },
        "springs": springs,
        "objective": problem.objective,
        "joints": None if problem.joints is None else list(problem.joints),
        "samples": problem.samples,
        "unlimited": unlimited,
        "keep": keep,
        "seed": problem.seed,
    }


METHOD = Method(
    "convex",
    "zero-free-length springs between any bodies: exact where feasible, beside a global bound",
    "THEORY section 4: semidefinite program over moment matrices, then local polish",
    applies,
    design,
    {
        "span": Parameter("whole", "springs join bodies at most this many moving joints apart (default 2)"),
        "radius": Parameter("length", "of every attachment region (default: from each link's size)"),
        "springs": Parameter("whole", "at most so many (default: as few as are exact, or within 1 % of the bound)"),
        "objective": Parameter("text", "what is minimised (default rms torque)", OBJECTIVES),
        "joints": Parameter("names", "A,B,...: the joints whose torque counts (default: all)"),
        "samples": Parameter("whole", "random poses to judge on (default: exact averages where possible)"),
        "seed": Parameter("whole", "of the random starts and poses (default 0)"),
    },
    exact=False,
)
