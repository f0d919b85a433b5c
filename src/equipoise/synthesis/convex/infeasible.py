"""Why exact balance is infeasible: the pairs or the regions, and which other pairs would make it possible."""

from __future__ import annotations

from dataclasses import replace

from ...kinematics import Tree
from ...model.coordinate import load_unit
from ...model.errors import EquipoiseError
from ..design import Infeasible
from ..mounts import Mounts
from .block_sets import FEASIBLE
from .least_squares_form import LeastSquaresForm, build
from .semidefinite import least_rms, rms_program

FAR = 10.0  # times as large: regions that tell whether the pairs or the regions are to blame
REMEDIES = 24  # other pairs tried when exact balance is infeasible
SINGLY = 5  # of them that are tried one by one, where they help all together
FEW = 300  # poses that tell whether exact balance is possible


def infeasible_on(reduced: LeastSquaresForm, bound: float) -> Infeasible:
    """The proof that the pairs of a problem do not do it, with what to blame and other pairs that would help.

    Args:
        bound: what they leave, as a share of the unbalanced torque.
    """
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
    kind = load_unit(c for c, scale in zip(Tree.of(problem.judged).coordinates, problem.scale, strict=True) if scale)
    return Infeasible(own, bound * unit, far * unit if far >= FEASIBLE else 0.0, places, len(missing), kind)


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
