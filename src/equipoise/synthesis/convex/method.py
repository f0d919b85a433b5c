"""The method `convex`: the least torque any springs can leave, and few real springs measured against that bound."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...balance import check
from ...model.errors import EquipoiseError, InfeasibleError, InputError
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from ...model.validate import whole_number
from ..design import Design, Infeasible
from ..load import OWN
from ..method import Method
from ..mounts import Mounts
from ..options import MethodOptions, option, takes
from ..problem import Problem, ProblemOptions
from .candidates import Candidates
from .few_springs import FEASIBLE, ROUNDING_SHARE, SpringSearch, SpringSet
from .least_squares_form import LeastSquaresForm, build
from .semidefinite import least_rms

ROUNDING = 1e-13
SPRINGS_TRIED = 8  # springs tried when no number is given
NEAR = 0.01  # of the unbalanced torque: close enough to the bound to stop adding springs
FAR = 10.0  # times as large: regions that tell whether the pairs or the regions are to blame
REMEDIES = 24  # other pairs tried when exact balance is infeasible
FEW = 300  # poses that tell whether exact balance is possible


@dataclass(frozen=True, kw_only=True)
class SolverOptions(MethodOptions):
    """What `solve` can be asked for.

    Attributes:
        springs: at most so many; by default the fewest that are exact where that is possible, else that come within
            1 % of the unbalanced torque of the bound.
        exact: insist on exact balance.
        front: also list the best design for every number of springs up to `springs` (8 by default).
        seed: of the random starts.
    """

    springs: int | None = option(
        None, "whole", "at most so many (default: as few as are exact, or within 1 % of the bound)"
    )
    exact: bool = False
    front: bool = False
    seed: int = option(0, "whole", "of the random starts (default 0)")


@dataclass(frozen=True, kw_only=True)
class ConvexOptions(SolverOptions, ProblemOptions):
    """What the method convex can be asked for: what `ProblemOptions` and `SolverOptions` list, with one seed."""

    seed: int = option(0, "whole", "of the random starts and poses (default 0)")


@takes(ConvexOptions)
def design(mechanism: Mechanism, options: ConvexOptions) -> Design:
    """Choose springs between bodies of a mechanism: `solve` of `Problem.of`; see those."""
    return solve(Problem.of(mechanism, **options.of(ProblemOptions)), **options.of(SolverOptions))


@takes(SolverOptions)
def solve(problem: Problem, options: SolverOptions) -> Design:
    """Choose springs, few of them, and bound what any could do (THEORY section 4).

    Raises:
        InfeasibleError: `exact`, and no springs on the pairs do it, or none were found; or no springs help at all.
        InputError: a bad option, loops that cannot be closed, or nothing to balance.
    """
    if options.springs is not None:
        whole_number("springs", options.springs, 1)
    whole_number("seed", options.seed, 0)
    reduced = _worth_solving(build(problem, options.progress))
    search = SpringSearch(reduced, options.seed, options.progress)
    bound = search.floor
    infeasible = None if bound < FEASIBLE else _infeasible(reduced, bound)
    if options.exact and infeasible is not None:
        raise InfeasibleError(str(infeasible))
    found, tried = _found(search, options.springs, bound, options.front)
    judge = Candidates(reduced, 0.0 if infeasible is None else bound)
    best = judge(search.pruned(found))
    averaged = reduced.averaged and problem.objective == "rms"
    design = Design(
        mechanism=best.mechanism,
        method="convex",
        objective=problem.objective,
        joints=problem.joints,
        residual=best.value * judge.unit,
        unbalanced=judge.unit,
        bound=min(judge.least, best.value) * judge.unit,  # equal but for rounding where the bound is reached
        averaged=averaged,
        samples=None if averaged else problem.count,
        free_parameters=_free(problem, options),
        exact_feasible=infeasible is None,
        infeasible=infeasible,
        loads=judge.of_loads(best),
        front=tuple(judge.row(row) for row in tried) if options.front else (),
    ).with_provenance()
    if options.exact and not _exact(design, problem):
        raise InfeasibleError(
            f"springs on these pairs may balance exactly, but none were found with {found.count} or fewer: "
            f"the best leaves {design.residual:.3g} N m {design.objective} where it counts; allow more springs"
        )
    return design


def _exact(design: Design, problem: Problem) -> bool:
    """Whether it is proved under every load."""
    loaded = (load.on(design.mechanism) for load in problem.loads)
    return all((design.balance if m == design.mechanism else check(m)).exact for m in loaded)


def applies(mechanism: Mechanism) -> list[str]:
    """Why the method does not apply; empty when it does."""
    return []


def _worth_solving(reduced: LeastSquaresForm) -> LeastSquaresForm:
    """The problem on those of its pairs that have an effect."""
    mechanism = reduced.problem.judged
    weight = max(
        sum(mass for _, mass, _ in lumped_masses(case)) * float(np.linalg.norm(case.gravity))
        for case in reduced.problem.cases
    )
    if reduced.unbalanced <= ROUNDING * weight * Mounts.of(mechanism).reach:
        what = "the springs that stay balance" if mechanism.springs else "gravity loads"
        which = "every joint that counts already" if mechanism.springs else "no joint that counts"
        raise InputError(f"mechanism '{mechanism.name}': nothing to balance, {what} {which}")
    if not reduced.useful:
        raise InfeasibleError("no spring on these pairs has any effect on a joint that counts")
    return reduced.on(reduced.useful)


def _found(search: SpringSearch, springs: int | None, bound: float, every: bool) -> tuple[SpringSet, list[SpringSet]]:
    """The design to deliver, and what was tried: with `every`, also what comes after it."""
    tried: list[SpringSet] = []
    enough: SpringSet | None = None
    for found in search.front(springs or SPRINGS_TRIED):
        tried.append(found)
        near = springs is None and bound >= FEASIBLE and found.value <= bound + NEAR
        if enough is None and (found.exact or near):
            enough = found
            if not every:
                break
    best = enough or tried[-1]
    if best.value > 1 - ROUNDING_SHARE:
        raise InfeasibleError("no springs on these pairs lower the torque of the joints that count")
    if bound > best.value + FEASIBLE:
        raise EquipoiseError(
            f"the convex solver's bound ({bound:.3g} of the unbalanced torque) contradicts a design that leaves "
            f"{best.value:.3g}: the problem is badly scaled; try a larger radius"
        )
    return best, tried


def _infeasible(reduced: LeastSquaresForm, bound: float) -> Infeasible:
    problem = reduced.problem
    far = least_rms(reduced.enlarged(FAR)).value
    own = tuple(block.place for block in reduced.blocks)
    present = {frozenset(pair) for pair in own}
    mounts = Mounts.of(problem.judged)
    # a large mechanism has hundreds of other pairs: the nearest ones are tried
    missing = [p for p in mounts.pairs(len(mounts.bodies)) if frozenset(p) not in present]
    missing = sorted(missing, key=mounts.apart)[:REMEDIES]
    wider = problem.with_pairs([*(pair for pair in problem.pairs if pair in own), *missing])
    if not reduced.averaged:  # exact balance at a few hundred random poses is exact balance
        wider = replace(wider, samples=FEW)
    wide = build(wider)
    number = {block.place: i for i, block in enumerate(wide.blocks)}
    stay = [number[place] for place in own]
    remedies = [p for p in missing if least_rms(wide.on([*stay, number[p]])).value < FEASIBLE]
    unit = reduced.unbalanced
    far = far * unit if far >= FEASIBLE else 0.0
    return Infeasible(own, bound * unit, far, tuple(remedies), len(missing))


def _free(problem: Problem, options: SolverOptions) -> dict[str, Any]:
    """What a design says of the problem and the options that it comes from, as plain data."""
    return {
        **({"span": problem.span} if problem.span is not None else {}),
        "pairs": [list(pair) for pair in problem.pairs],
        "regions": {
            name: {"shape": region.shape, "centre": list(region.centre), "half": list(region.half)}
            for name, region in problem.attachments.items()
        },
        "springs": options.springs,
        "objective": problem.objective,
        "joints": None if problem.joints is None else list(problem.joints),
        **({"weights": dict(problem.weights)} if problem.weights else {}),
        **({"loads": [load.to_dict() for load in problem.loads]} if problem.loads != (OWN,) else {}),
        "samples": problem.samples,
        "unlimited": problem.unlimited,
        "keep": problem.keep,
        "seed": options.seed,
        **({"seed of poses": problem.seed} if problem.seed != options.seed else {}),
    }


METHOD = Method(
    "convex",
    "zero-free-length springs between any bodies: exact where feasible, beside a global bound",
    "THEORY section 4: semidefinite program over moment matrices, then local polish",
    applies,
    design,
    ConvexOptions,
    exact=False,
)
