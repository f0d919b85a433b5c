"""The method `convex`: the least torque any springs can leave, and few real springs measured against that bound."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any
from warnings import warn

import numpy as np

from ...balance import check
from ...kinematics import Tree
from ...model.errors import EquipoiseError, EquipoiseWarning, InfeasibleError, InputError
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from ...model.progress import silent
from ...model.validate import whole_number
from ..design import Design, FrontRow, Infeasible
from ..load import OWN
from ..method import Method
from ..mounts import Mounts
from ..options import MethodOptions, option, takes
from ..problem import Problem, ProblemOptions
from .block_sets import FEASIBLE
from .candidates import front_row, load_residuals, with_parts
from .few_springs import ROUNDING_SHARE, SpringSearch, SpringSet
from .goal import Goal, Rms
from .least_squares_form import LeastSquaresForm, build
from .peak import Peak
from .semidefinite import least_rms, rms_program

ROUNDING = 1e-13
SPRINGS_TRIED = 8  # springs tried when no number is given
FAR = 10.0  # times as large: regions that tell whether the pairs or the regions are to blame
REMEDIES = 24  # other pairs tried when exact balance is infeasible
SINGLY = 5  # of them that are tried one by one, where they help all together
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
    """Choose springs, few of them, and bound what any could do (docs/theory.md, section 4).

    Raises:
        InfeasibleError: `exact`, and no springs on the pairs do it, or none were found; or no springs help at all.
        InputError: a bad option, loops that cannot be closed, or nothing to balance.
    """
    if options.springs is not None:
        whole_number("springs", options.springs, 1)
    whole_number("seed", options.seed, 0)
    reduced = _worth_solving(build(problem, options.progress))
    goal = Peak.of(reduced) if problem.objective == "peak" else Rms(reduced)
    search = SpringSearch(goal, options.springs or SPRINGS_TRIED, options.seed, options.progress or silent)
    bound = _bound(goal)
    least = bound if isinstance(goal, Rms) else _bound(Rms(reduced))  # exact or not: the mean square tells best
    infeasible = None if least is None or least < FEASIBLE else _infeasible(reduced, least)
    if options.exact and infeasible is not None:
        raise InfeasibleError(str(infeasible))
    found = _found(search, options.springs is None)
    averaged = reduced.averaged and problem.objective == "rms"
    if bound is not None:
        bound = min(0.0 if infeasible is None else bound, found.value) * goal.unit
    design = Design(
        mechanism=with_parts(reduced, found.parts),
        method="convex",
        objective=problem.objective,
        joints=problem.joints,
        residual=found.value * goal.unit,
        unbalanced=goal.unit,
        bound=bound,
        averaged=averaged,
        samples=None if averaged else problem.count,
        free_parameters=_free(problem, options),
        exact_feasible=None if least is None else infeasible is None,
        infeasible=infeasible,
        loads=load_residuals(goal, found.parts),
        front=tuple(_rows(search)) if options.front else (),
        by_chance=found.by_chance,
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


def _bound(goal: Goal) -> float | None:
    """What no parts can undercut, as a share; None, and a warning, where the solver finds nothing."""
    try:
        return goal.bound.value
    except EquipoiseError as error:
        warn(f"{error}; there is no bound, and springs come from random starts", EquipoiseWarning, stacklevel=2)
        return None


def _found(search: SpringSearch, few: bool) -> SpringSet:
    """The design to deliver: the best, or if `few` one that is good enough."""
    best = (search.few() if few else None) or search.best(search.most)
    if best is None or best.value > 1 - ROUNDING_SHARE:
        raise InfeasibleError("no springs on these pairs lower the torque of the joints that count")
    if search.floor > best.value + FEASIBLE:
        raise EquipoiseError(
            f"the convex solver's bound ({search.floor:.3g} of the unbalanced torque) contradicts a design that leaves "
            f"{best.value:.3g}: the problem is badly scaled; try a larger radius"
        )
    return best


def _rows(search: SpringSearch) -> Iterator[FrontRow]:
    """The lines of the front."""
    for count, found in enumerate(search.front(), 1):
        bound = None  # the bounds of few parts are bounds of the mean square
        if isinstance(search.goal, Rms):
            bound = search.sets.least(count, tuple(found.parts.block[0].tolist()))
        yield front_row(search.goal, count, found, bound)


def _infeasible(reduced: LeastSquaresForm, bound: float) -> Infeasible:
    problem = reduced.problem
    own = tuple(dict.fromkeys(block.place for block in reduced.blocks))
    present = {frozenset(pair) for pair in own}
    mounts = Mounts.of(problem.judged)
    # a large mechanism has hundreds of other pairs: the nearest ones are tried
    missing = [p for p in mounts.pairs(len(mounts.bodies)) if frozenset(p) not in present]
    missing = sorted(missing, key=mounts.apart)[:REMEDIES]
    wider = problem.with_pairs([*(pair for pair in problem.pairs if pair in own), *missing])
    # exact balance within joint ranges, or at a few hundred random poses, is exact balance everywhere
    whole = reduced.averaged and Tree.of(problem.judged).turns.all()
    wider = wider.with_poses(unlimited=True) if whole else replace(wider, samples=FEW)
    wide = build(wider)
    numbers = {place: [i for i, b in enumerate(wide.blocks) if b.place == place] for place in (*own, *missing)}
    unit = reduced.unbalanced
    try:
        far = least_rms(reduced.enlarged(FAR)).value
    except EquipoiseError:
        far = 0.0  # not known
    remedies = _remedies(wide, [i for place in own for i in numbers[place]], [numbers[pair] for pair in missing])
    places = tuple(wide.blocks[i].place for i, *_ in remedies)
    return Infeasible(own, bound * unit, far * unit if far >= FEASIBLE else 0.0, places, len(missing))


def _feasible(reduced: LeastSquaresForm) -> bool:
    """Whether exact balance is possible as far as the solver can tell."""
    try:
        return rms_program(reduced).reaches(FEASIBLE)
    except EquipoiseError:
        return False


def _remedies(wide: LeastSquaresForm, stay: list[int], others: list[list[int]]) -> list[list[int]]:
    """Those of the others, each the blocks of a pair, any of which makes exact balance possible.

    None where all together do not.
    """
    if not others or not _feasible(wide.on([*stay, *(i for blocks in others for i in blocks)])):
        return []
    size = len(others) // 2 if len(others) > SINGLY else 1
    groups = [others[i : i + size] for i in range(0, len(others), size)] if len(others) > 1 else []
    return [one for group in groups for one in _remedies(wide, stay, group)] if groups else others


def _free(problem: Problem, options: SolverOptions) -> dict[str, Any]:
    """What a design says of the problem and the options that it comes from, as plain data."""
    return {
        **({"span": problem.span} if problem.span is not None else {}),
        "pairs": [list(pair) for pair in problem.pairs],
        "regions": {
            name: own[0].to_dict() if len(own) == 1 else [region.to_dict() for region in own]
            for name, own in problem.attachments.items()
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
    "docs/theory.md, section 4: semidefinite program over moment matrices, then local polish",
    applies,
    design,
    ConvexOptions,
    exact=False,
)
