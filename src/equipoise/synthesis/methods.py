"""The methods, as data: what each needs, gives and is based on. Lists in tests and documentation come from here."""

from __future__ import annotations

from inspect import signature
from typing import Any

from ..errors import Fault, InputError, UnsupportedError, nearest
from ..mechanism import Mechanism
from . import convex
from .bevel import method as bevel
from .delta import method as delta
from .design import Design
from .method import Method
from .no_auxiliary import method as no_auxiliary
from .planar import method as planar
from .pseudobase import method as pseudobase

_MODULES = (
    convex,
    pseudobase,
    planar,
    no_auxiliary,
    bevel,
    delta,
)
METHODS: dict[str, Method] = {module.METHOD.name: module.METHOD for module in _MODULES}


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
    run = METHODS[method].run
    if "progress" not in signature(run).parameters:  # quick work reports none
        options.pop("progress", None)
    own = [name for name, p in signature(run).parameters.items() if p.kind is not p.VAR_KEYWORD and name != "mechanism"]
    valid = tuple(dict.fromkeys([*own, *METHODS[method].parameters]))
    for name in options:
        if name not in valid:
            raise InputError(Fault((name,), f"method '{method}' has no such option", valid))
    reasons = METHODS[method].applies(mechanism)
    if reasons:
        raise UnsupportedError(f"method '{method}' does not apply to '{mechanism.name}': {'; '.join(reasons)}")
    return run(mechanism, **options)
