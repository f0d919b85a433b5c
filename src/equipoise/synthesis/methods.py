"""The methods, as data: what each needs, gives and is based on. Lists in tests and documentation come from here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..errors import Fault, InputError, UnsupportedError, nearest
from ..mechanism import Mechanism
from . import convex
from .design import Design


@dataclass(frozen=True)
class Method:
    """A way to design springs.

    Attributes:
        applies: mechanism -> the reasons why it does not apply, empty when it does.
        parameters: name -> what it is, for ``--set``.
    """

    name: str
    summary: str
    source: str
    applies: Callable[[Mechanism], list[str]]
    run: Callable[..., Design]
    parameters: dict[str, str]


METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method(
            "convex",
            "zero-free-length springs between any bodies of a tree: exact where feasible, beside a global bound",
            "THEORY section 4: semidefinite program over moment matrices, then local polish",
            convex.applies,
            convex.design,
            {
                "span": "springs join bodies at most this many moving joints apart (default 2)",
                "radius": "[m] of every attachment region (default: from each link's size)",
                "springs": "at most this many springs (default: as few as are exact, or within 1 % of the bound)",
                "objective": "rms or peak torque (default rms)",
                "joints": "A,B,...: the joints whose torque counts (default: all)",
                "samples": "random poses to judge on (default: exact averages where possible)",
                "seed": "of the random starts and poses (default 0)",
            },
        ),
    )
}


def design(mechanism: Mechanism, method: str = "convex", **options: Any) -> Design:
    """Design springs for a mechanism.

    Args:
        method: a key of `METHODS`; options: that method's own, see its function.

    Raises:
        InputError: no such method, or a bad option.
        UnsupportedError: the method does not apply; the message says why.
        InfeasibleError: what was asked for does not exist.
    """
    if method not in METHODS:
        raise InputError(Fault(("method",), f"there is no method {nearest(method, METHODS)}", tuple(METHODS)))
    reasons = METHODS[method].applies(mechanism)
    if reasons:
        raise UnsupportedError(f"method '{method}' does not apply to '{mechanism.name}': {'; '.join(reasons)}")
    return METHODS[method].run(mechanism, **options)
