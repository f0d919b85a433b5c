"""The blocks of unknowns that are asked for beside springs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ...model.mechanism import Mechanism
from ...model.units import Amount
from .blocks import Block
from .cam_block import CamBlock
from .counterweight_block import CounterweightBlock
from .moving_weight_block import MovingWeightBlock
from .set_block import SetBlock


def beside(
    mechanism: Mechanism,
    counterweights: Amount | Mapping[str, Amount] | None,
    cams: Iterable[str] | None,
    torsion: Iterable[str] | None,
    tune: Iterable[str] | None,
    moves: bool = False,
) -> tuple[Block, ...]:
    """Those of counterweights, cams, torsion springs and springs of the file; see `ProblemOptions`.

    Args:
        moves: whether a motion has to move the weights.

    Raises:
        InputError: no such body, joint or spring, or one of which nothing can be chosen.
    """
    weight = MovingWeightBlock if moves else CounterweightBlock
    weights = () if counterweights is None else weight.each(mechanism, counterweights)
    on_joints = CamBlock.each(mechanism, cams or ())
    return (*weights, *on_joints, *SetBlock.torsion(mechanism, torsion or ()), *SetBlock.of_file(mechanism, tune or ()))
