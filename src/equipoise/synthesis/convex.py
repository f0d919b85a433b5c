"""The method `convex`: the globally best springs for any tree, then few real springs certified against that bound."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from ..energy.potential import lumped_masses
from ..errors import Fault, InfeasibleError, InputError
from ..mechanism import Mechanism
from ..spring import Spring
from .bound import least_rms
from .design import Design, FrontRow, Infeasible
from .gram import Gram, build
from .minimax import Peak
from .mounts import Mounts
from .polish import Springs
from .problem import Objective, Pair, Problem, Progress, Region
from .search import FEASIBLE, Found, Search

ROUNDING = 1e-13
MOST = 8  # springs tried when no number is given
NEAR = 0.01  # of the unbalanced torque: close enough to the bound to stop adding springs
FAR = 10.0  # times as large: regions that tell whether the pairs or the regions are to blame
REMEDIES = 24  # other pairs tried when exact balance is infeasible
FEW = 300


def design(
    mechanism: Mechanism,
    *,
    span: int = 2,
    pairs: Iterable[Pair] | None = None,
    radius: float | None = None,
    shape: Literal["ball", "box"] = "ball",
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
        InputError: a bad option.  UnsupportedError: the mechanism has loops.
    """
    if springs is not None and springs < 1:
        raise InputError(Fault(("springs",), f"must be at least 1, found {springs}"))
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
    bound = search.bound(tuple(range(len(gram.problem.pairs))))
    feasible = bound < FEASIBLE
    infeasible = None if feasible else _infeasible(gram, bound)
    if exact and infeasible is not None:
        raise InfeasibleError(str(infeasible))

    rows = list(search.front(springs or MOST)) if front else []
    found = rows[-1] if rows else _choose(search, springs, bound)
    if exact and not found.exact:
        raise InfeasibleError(
            f"springs on these pairs can balance exactly, but none were found with {found.count} or fewer: "
            f"the best leaves {found.value * gram.unbalanced:.3g} N m; allow more springs"
        )
    chosen, value, least, unit = found.springs, found.value, 0.0 if feasible else bound, gram.unbalanced
    if objective == "peak":
        chosen, value, least, unit = _lower_peak(gram, found, feasible)
    averaged = gram.averaged and objective == "rms"
    return Design(
        mechanism=replace(bare, springs=(*bare.springs, *_springs(gram.problem, chosen, bare.springs))),
        method="convex",
        objective=objective,
        residual=value * unit,
        unbalanced=unit,
        bound=min(least, value) * unit,  # both hold to rounding or the solver's tolerance; neither may contradict
        averaged=averaged,
        samples=None if averaged else problem.count,
        free_parameters=_options(problem, span if pairs is None else None, springs, unlimited),
        exact_feasible=feasible,
        infeasible=infeasible,
        front=tuple(_row(gram, row) for row in rows),
    ).with_provenance()


def applies(mechanism: Mechanism) -> list[str]:
    """Why the method does not apply; empty when it does."""
    return ["it has loops, and the closed-loop solver does not exist yet"] if mechanism.loops else []


def _worth_solving(gram: Gram) -> Gram:
    """The problem on those of its pairs that have an effect."""
    mechanism = gram.problem.mechanism
    mass = sum(mass for _, mass, _ in lumped_masses(mechanism))
    weight = mass * float(np.linalg.norm(mechanism.gravity)) * Mounts.of(mechanism).reach
    if gram.unbalanced <= ROUNDING * weight:
        raise InputError(f"mechanism '{mechanism.name}': nothing to balance, gravity loads no joint that counts")
    if not gram.useful:
        raise InfeasibleError("no spring on these pairs has any effect on a joint that counts")
    return gram.on(gram.useful)


def _lower_peak(gram: Gram, found: Found, feasible: bool) -> tuple[Springs, float, float, float]:
    """For the peak objective: (springs, peak, its bound, unit [N m]), both as shares of the unit."""
    peak = Peak.of(gram)
    least = 0.0 if feasible else peak.bound().value
    springs, value = (found.springs, found.value) if found.exact else peak.polish(found.springs)
    return springs, value, least, peak.unbalanced


def _choose(search: Search, springs: int | None, bound: float) -> Found:
    if springs is not None:
        candidates = [search.best(count) for count in range(1, springs + 1)]
        return min(candidates, key=lambda found: (not found.exact, 0 if found.exact else found.value, found.count))
    found = search.best(1)
    while found.count < MOST and not found.exact and (bound < FEASIBLE or found.value > bound + NEAR):
        found = search.best(found.count + 1)
    return found


def _infeasible(gram: Gram, bound: float) -> Infeasible:
    problem = gram.problem
    far = least_rms(gram.enlarged(FAR)).value
    present = {frozenset(pair) for pair in problem.pairs}
    mounts = Mounts.of(problem.mechanism)
    # a large mechanism has hundreds of other pairs: the nearest ones are tried
    missing = [p for p in mounts.pairs(len(mounts.bodies)) if frozenset(p) not in present]
    missing = sorted(missing, key=mounts.apart)[:REMEDIES]
    pairs = [*problem.pairs, *missing]
    # exact balance at a few hundred random poses is exact balance: fewer samples will do
    samples = None if gram.averaged else FEW
    wider = Problem.of(problem.mechanism, pairs=pairs, regions=problem.regions, joints=problem.joints, samples=samples)
    wide, own = build(wider), list(range(len(problem.pairs)))
    remedies = [p for i, p in enumerate(missing, len(own)) if least_rms(wide.on([*own, i])).value < FEASIBLE]
    unit = gram.unbalanced
    return Infeasible(problem.pairs, bound * unit, far * unit if far >= FEASIBLE else 0.0, tuple(remedies))


def _springs(problem: Problem, found: Springs, present: tuple[Spring, ...]) -> list[Spring]:
    taken = {spring.name for spring in present}
    names = (name for i in range(1, 10_000) if (name := f"spring {i}") not in taken)
    springs = []
    for pair, k, y in zip(found.pair[0], found.k[0], found.y[0], strict=True):
        body_a, body_b = problem.pairs[pair]
        z = problem.lift((body_a, body_b)) @ y
        springs.append(Spring(next(names), body_a, _point(z[:3]), body_b, _point(z[4:]), float(k)))
    return springs


def _point(p: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in p)
    return x, y, z


def _row(gram: Gram, found: Found) -> FrontRow:
    bound = None if found.bound is None else (found.bound if found.bound >= FEASIBLE else 0.0) * gram.unbalanced
    pairs = tuple(gram.problem.pairs[i] for i in found.springs.pair[0])
    return FrontRow(found.count, found.value * gram.unbalanced, bound, pairs, found.exact)


def over_all_turns(mechanism: Mechanism) -> Mechanism:
    """The mechanism without the ranges of its revolute joints."""
    return replace(
        mechanism, joints=tuple(replace(j, range=None) if j.type == "revolute" else j for j in mechanism.joints)
    )


def _options(problem: Problem, span: int | None, springs: int | None, unlimited: bool) -> dict[str, Any]:
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
        "seed": problem.seed,
    }
