"""Sums of joints as a person writes them: "hip-2*knee"."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ...model.elements.laws.law import Terms
from ...model.errors import Fault, InputError, nearest
from ...model.mechanism import Mechanism
from ..given import number


def terms(mechanism: Mechanism, joint: str | Mapping[str, float] | None, option: str = "joint") -> Terms:
    """(name, ratio) of each joint of a sum: "hip-2*knee" or a mapping; the only hinge where there is only one.

    Raises:
        InputError: it is no such sum, or there are several hinges and none is named.
    """
    hinges = [j.name for j in mechanism.joints if j.type == "revolute"]
    if joint is None:
        if len(hinges) != 1:
            raise InputError(Fault((option,), "which joint is the cam for?", tuple(hinges)))
        return ((hinges[0], 1.0),)
    if not isinstance(joint, str):
        return tuple((name, number(option, ratio, positive=None)) for name, ratio in joint.items())
    if joint in hinges:
        return ((joint, 1.0),)
    names = "|".join(re.escape(name) for name in sorted(hinges, key=len, reverse=True))
    part = rf"\s*([+-]?)\s*(?:(\d*\.?\d+)\s*\*?\s*)?({names})\s*(?=[+-]|$)"
    if not hinges or not re.fullmatch(f"(?:{part})+", joint):
        raise InputError(Fault((option,), f"no revolute joint {nearest(joint, hinges)}", tuple(hinges)))
    signs = {"-": -1.0}
    return tuple((name, signs.get(sign, 1.0) * float(ratio or 1)) for sign, ratio, name in re.findall(part, joint))
