"""The method `convex`: the least torque any springs can leave, and few real springs measured against that bound."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any
from warnings import warn

import numpy as np

from ...balance import check
from ...model.errors import EquipoiseError, EquipoiseWarning, Fault, InfeasibleError, InputError, nearest
from ...model.masses import lumped_masses
from ...model.mechanism import Mechanism
from ...model.progress import silent
from ...model.units import Amount, number
from ...model.validate import whole_number
from ..design import Design, FrontRow
from ..load import OWN
from ..method import Method
from ..mounts import Mounts
from ..options import MethodOptions, option, takes
from ..problem import Problem, ProblemOptions
from ..region import plain_regions
from .block_sets import FEASIBLE
from .brought import brought
from .cam_block import CamBlock
from .candidates import front_row, load_residuals, with_parts
from .counterweight_block import CounterweightBlock
from .few_springs import ROUNDING_SHARE, SpringSearch, SpringSet
from .goal import Goal, Rms, rms
from .infeasible import infeasible_on
from .least_squares_form import LeastSquaresForm, build
from .lightest import CLOSE, Lightest, lightest, weighs
from .peak import Peak
from .polish import Parts
from .preferred import preferred
from .wishes import PREFERENCES, Preference

ROUNDING = 1e-13
SPRINGS_TRIED = 8  # springs tried when no number is given


@dataclass(frozen=True, kw_only=True)
class SolverOptions(MethodOptions):
    """What `solve` can be asked for.

    Attributes:
        springs: at most so many; by default the fewest that are exact where that is possible, else that come within
            1 % of the unbalanced torque of the bound.
        exact: insist on exact balance.
        front: also list the best design for every number of springs up to `springs` (8 by default).
        residual: the lightest counterweights that leave this share of the unbalanced rms torque, 0 for exact balance;
            by default weights may have any mass and springs and weights leave as little as they can.
        prefer: what counts first among designs that are equal to 0.01 % of the unbalanced torque: the largest "force",
            the stored "energy", the largest "length" or "rate"; by default what `Wishes` lists.
        seed: of the random starts.
    """

    springs: int | None = option(None, "whole", "at most so many (default: as few as are exact, or near the bound)")
    exact: bool = False
    front: bool = False
    prefer: Preference | None = option(None, "text", "what is least among equally good designs", PREFERENCES)
    residual: Amount | None = option(
        None, "share", "with counterweights, what may be left of the unbalanced rms torque (default 0%)"
    )
    seed: int = option(0, "whole", "of the random starts (default 0)")


@dataclass(frozen=True, kw_only=True)
class ConvexOptions(SolverOptions, ProblemOptions):
    """What the method convex can be asked for: what `ProblemOptions` and `SolverOptions` list, with one seed."""

    seed: int = option(0, "whole", "of the random starts and poses (default 0)")


@takes(ConvexOptions)
def design(mechanism: Mechanism, options: ConvexOptions) -> Design:
    """Choose springs between bodies of a mechanism, and the lightest counterweights: `solve` of `Problem.of`."""
    if options.counterweights is not None and options.residual is None:
        options = replace(options, residual=0.0)
    return solve(Problem.of(mechanism, **options.of(ProblemOptions)), **options.of(SolverOptions))


@takes(SolverOptions)
def solve(problem: Problem, options: SolverOptions) -> Design:
    """Choose springs, few of them, and bound what any could do (docs/theory.md, section 4).

    With a `residual` the lightest counterweights are chosen first, and then springs for them; `front` is theirs.

    Raises:
        InfeasibleError: `exact`, and no springs on the pairs do it, or none were found; or no springs help at all; or
            no counterweights leave as little as is asked.
        InputError: a bad option, loops that cannot be closed, or nothing to balance.
    """
    if options.springs is not None:
        whole_number("springs", options.springs, 1 if options.residual is None else 0)
    whole_number("seed", options.seed, 0)
    if options.prefer not in (None, *PREFERENCES):
        raise InputError(Fault(("prefer",), f"unknown value {nearest(options.prefer, PREFERENCES)}", PREFERENCES))
    if options.residual is None:
        return _springs(problem, options)
    if not weighs(problem):
        raise InputError(Fault(("residual",), "is what counterweights may leave: give counterweights too"))
    return _weighted(problem, options, number("residual", options.residual, positive=False))


def _weighted(problem: Problem, options: SolverOptions, share: float) -> Design:
    """The lightest counterweights, and springs for them."""
    if share and problem.objective != "rms":
        raise InputError(Fault(("residual",), "is a share of the rms torque: it goes with the objective rms"))
    if options.springs == 0:
        problem = problem.with_pairs(())
    reduced = _worth_solving(build(problem, options.progress))
    found = lightest(reduced, share, options.front, options.seed, options.progress or silent)
    if found.alone is not None:
        design = _weights_alone(reduced, found.alone)
    else:
        asked = replace(options, front=False, exact=options.exact or not share)
        design = _springs(found.with_weights, asked, found)
        if design.residual > share * reduced.unbalanced * (1 + CLOSE) and not design.balance.exact:
            raise InfeasibleError(
                f"with counterweights of {found.counterweights.mass:.4g} kg and at most {options.springs} springs the "
                f"best that was found leaves {design.residual:.4g} N m rms: allow more springs"
            )
    weights, free = found.counterweights, _free(problem, options)
    unbalanced = reduced.unbalanced if problem.objective == "rms" else Peak.of(reduced).unit
    made = replace(design, unbalanced=unbalanced, free_parameters=free, counterweights=weights)
    return made.with_provenance()


def _weights_alone(reduced: LeastSquaresForm, parts: Parts) -> Design:
    """The design that takes no springs."""
    goal = Peak.of(reduced) if reduced.problem.objective == "peak" else Rms(reduced)
    loads = load_residuals(goal, parts)
    left = max(load.residual for load in loads) if isinstance(goal, Peak) else rms(reduced, parts)[0] * goal.unit
    averaged = reduced.averaged and isinstance(goal, Rms)
    return Design(
        mechanism=with_parts(reduced, parts),
        method="convex",
        objective=reduced.problem.objective,
        joints=reduced.problem.joints,
        residual=float(left),
        unbalanced=goal.unit,
        averaged=averaged,
        samples=None if averaged else len(reduced.problem.states),
        loads=loads,
    )


def _springs(problem: Problem, options: SolverOptions, weights: Lightest | None = None) -> Design:
    """Springs, on a mechanism that has its weights."""
    if options.exact and problem.given_poses:
        raise InputError(Fault(("exact",), "is about all poses, and the goal gives some"))
    reduced = _worth_solving(build(problem, options.progress))
    goal = Peak.of(reduced) if problem.objective == "peak" else Rms(reduced)
    springs = options.springs or problem.goal.cost.springs
    search = SpringSearch(goal, springs or SPRINGS_TRIED, options.seed, options.progress or silent)
    if weights is not None:
        search.start(weights.springs_on(reduced), weights.share * weights.reduced.unbalanced / goal.unit)
    bound = _bound(goal)
    least = bound if isinstance(goal, Rms) else _bound(Rms(reduced))  # exact or not: the mean square tells best
    possible, asked_less = least is None or least < FEASIBLE, weights is not None and weights.share > 0
    apart = problem.given_poses or bool(reduced.limits)  # what springs alone could do is not what is asked
    infeasible = None if least is None or possible or asked_less or apart else infeasible_on(reduced, least)
    if options.exact and infeasible is not None:
        raise InfeasibleError(str(infeasible))
    found = _found(search, springs is None)
    if weights is None and not reduced.limits:  # what leaves as much may cost more
        found = preferred(goal, found, search.found, springs or found.count + 1, options.prefer)
    averaged = reduced.averaged and problem.objective == "rms"
    if bound is not None:
        bound = min(0.0 if possible else bound, found.value) * goal.unit
    design = Design(
        mechanism=with_parts(reduced, found.parts),
        method="convex",
        objective=problem.objective,
        joints=problem.joints,
        residual=found.value * goal.unit,
        unbalanced=goal.unit,
        bound=bound,
        averaged=averaged,
        samples=None if averaged else len(problem.states),
        free_parameters=_free(problem, options),
        exact_feasible=None if least is None or apart else possible,
        infeasible=infeasible,
        loads=load_residuals(goal, found.parts),
        front=tuple(_rows(search)) if options.front else (),
        by_chance=found.by_chance,
        brought=brought(reduced) if problem.objective == "rms" else {},
        goal=problem.mechanism.goal,
    ).with_provenance()
    if options.exact and not _exact(design, problem):
        raise InfeasibleError(
            f"springs on these pairs may balance exactly, but none were found with {found.count} or fewer: "
            f"the best leaves {design.residual:.3g} N m {design.objective} where it counts; allow more springs"
        )
    return design


def _exact(design: Design, problem: Problem) -> bool:
    """Whether it is proved under every load."""
    loaded = (case for load in problem.loads for case in load.each(design.mechanism))
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


def _free(problem: Problem, options: SolverOptions) -> dict[str, Any]:
    """What a design says of the problem and the options that it comes from, as plain data."""
    return {
        **({"span": problem.span} if problem.span is not None else {}),
        "pairs": [list(pair) for pair in problem.pairs],
        "regions": {name: plain_regions(own) for name, own in problem.attachments.items()},
        **_weighed(problem, options),
        "springs": options.springs,
        **({"prefer": options.prefer} if options.prefer else {}),
        "objective": problem.objective,
        "joints": None if problem.joints is None else list(problem.joints),
        **({"weights": dict(problem.weights)} if problem.weights else {}),
        **_cams(problem),
        **({"loads": [load.to_dict() for load in problem.loads]} if problem.loads != (OWN,) else {}),
        "samples": problem.samples,
        "unlimited": problem.unlimited,
        "keep": problem.keep,
        "seed": options.seed,
        **({"seed of poses": problem.seed} if problem.seed != options.seed else {}),
    }


def _weighed(problem: Problem, options: SolverOptions) -> dict[str, Any]:
    radii = {block.body: block.radius for block in problem.beside if isinstance(block, CounterweightBlock)}
    return {"counterweights": radii, "residual": options.residual} if radii else {}


def _cams(problem: Problem) -> dict[str, Any]:
    found = [block.place[0] for block in problem.beside if isinstance(block, CamBlock)]
    return {"cams": found} if found else {}


METHOD = Method(
    "convex",
    "zero-free-length springs between any bodies: exact where feasible, beside a global bound",
    "docs/theory.md, section 4: semidefinite program over moment matrices, then local polish",
    applies,
    design,
    ConvexOptions,
    exact=False,
)
