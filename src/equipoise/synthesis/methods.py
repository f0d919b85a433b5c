"""The methods, as data: what each needs, gives and is based on. Lists in tests and documentation come from here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, ParamSpec, Protocol, cast, overload

from ..io import Source, loaded
from ..model.errors import Fault, InputError, UnsupportedError, nearest
from .bevel import method as bevel
from .cam import method as cam
from .cam.options import CamOptions
from .convex import method as convex
from .convex.method import ConvexOptions
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
    cam,
)
METHODS: dict[str, Method] = {module.METHOD.name: module.METHOD for module in _MODULES}

C = ParamSpec("C")  # the options of each method
B = ParamSpec("B")
P = ParamSpec("P")
N = ParamSpec("N")
S = ParamSpec("S")
D = ParamSpec("D")
K = ParamSpec("K")


class _ByMethod(Protocol[C, B, P, N, S, D, K]):
    """What editors and type checkers know of `design`: for each method the options of its type."""

    @overload
    def __call__(
        self, mechanism: Source, method: Literal["convex"] = "convex", *args: C.args, **options: C.kwargs
    ) -> Design: ...
    @overload
    def __call__(
        self, mechanism: Source, method: Literal["pseudobase"], *args: B.args, **options: B.kwargs
    ) -> Design: ...
    @overload
    def __call__(self, mechanism: Source, method: Literal["planar"], *args: P.args, **options: P.kwargs) -> Design: ...
    @overload
    def __call__(
        self, mechanism: Source, method: Literal["no-auxiliary"], *args: N.args, **options: N.kwargs
    ) -> Design: ...
    @overload
    def __call__(self, mechanism: Source, method: Literal["bevel"], *args: S.args, **options: S.kwargs) -> Design: ...
    @overload
    def __call__(self, mechanism: Source, method: Literal["delta"], *args: D.args, **options: D.kwargs) -> Design: ...
    @overload
    def __call__(self, mechanism: Source, method: Literal["cam"], *args: K.args, **options: K.kwargs) -> Design: ...


def _typed(
    convex: Callable[C, Any],
    pseudobase: Callable[B, Any],
    planar: Callable[P, Any],
    no_auxiliary: Callable[N, Any],
    bevel: Callable[S, Any],
    delta: Callable[D, Any],
    cam: Callable[K, Any],
) -> Callable[[Callable[..., Design]], _ByMethod[C, B, P, N, S, D, K]]:
    """Decorate `design` with the types of all methods' options; at run time it stays as it is."""
    return lambda function: cast("_ByMethod[C, B, P, N, S, D, K]", function)


def reasons(mechanism: Source) -> dict[str, tuple[str, ...]]:
    """Every method, and why it does not apply to a mechanism: nothing where it does."""
    mechanism = loaded(mechanism)
    return {name: tuple(method.applies(mechanism)) for name, method in METHODS.items()}


def by_name(mechanism: Source, method: str, **options: Any) -> Design:
    """`design` by a method whose name is not known before the program runs."""
    if method not in METHODS:
        raise InputError(Fault(("method",), f"there is no method {nearest(method, METHODS)}", tuple(METHODS)))
    mechanism, chosen = loaded(mechanism), METHODS[method]
    valid = chosen.options.names()
    for name in options:
        if name not in valid:
            raise InputError(Fault((name,), f"method '{method}' has no such option", valid))
    reasons = chosen.applies(mechanism)
    if reasons:
        raise UnsupportedError(f"method '{method}' does not apply to '{mechanism.name}': {'; '.join(reasons)}")
    return chosen.run(mechanism, **options)


@_typed(
    ConvexOptions,
    pseudobase.PseudobaseOptions,
    planar.PlanarOptions,
    no_auxiliary.NoAuxiliaryOptions,
    bevel.BevelOptions,
    delta.DeltaOptions,
    CamOptions,
)
def design(mechanism: Source, method: str = "convex", **options: Any) -> Design:
    """Design springs for a mechanism.

    Args:
        mechanism: or the path of its file.
        method: a key of `METHODS`; options: that method's own, see its type, such as `ConvexOptions`.

    Raises:
        InputError: no such method, or a bad option.
        UnsupportedError: the method does not apply; the message says why.
        InfeasibleError: what was asked for does not exist.
    """
    return by_name(mechanism, method, **options)
