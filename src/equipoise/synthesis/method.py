"""What a design method is: data that the command line, the tests and the documentation read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..model.mechanism import Mechanism
from .design import Design
from .options import MethodOptions, Parameter

__all__ = ["Method", "Parameter"]


@dataclass(frozen=True)
class Method:
    """A way to design springs.

    Attributes:
        applies: mechanism -> the reasons why it does not apply, empty when it does.
        run: ``run(mechanism, **options)``, with the fields of the type `options` by name.
        exact: whether it has formulas for exact balance, instead of an objective and a bound.
    """

    name: str
    summary: str
    source: str
    applies: Callable[[Mechanism], list[str]]
    run: Callable[..., Design]
    options: type[MethodOptions]
    exact: bool = True

    @property
    def parameters(self) -> dict[str, Parameter]:
        """The options that the command line takes by ``--set``."""
        return self.options.parameters()
