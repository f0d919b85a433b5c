"""The blocks of unknowns that are asked for beside springs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ...model.mechanism import Mechanism
from ...model.units import Amount
from .blocks import Block
from .cam_block import CamBlock
from .counterweight_block import CounterweightBlock


def beside(
    mechanism: Mechanism, counterweights: Amount | Mapping[str, Amount] | None, cams: Iterable[str] | None
) -> tuple[Block, ...]:
    """Those of counterweights and cams; see `ProblemOptions`.

    Raises:
        InputError: no such body or joint.
    """
    weights = () if counterweights is None else CounterweightBlock.each(mechanism, counterweights)
    return (*weights, *CamBlock.each(mechanism, cams or ()))
