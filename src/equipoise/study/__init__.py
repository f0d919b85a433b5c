"""Studies: many designs of many mechanisms, on all cores of a machine or on a cluster, as rows of a table."""

import sys
from types import ModuleType
from typing import Any

from .make import study
from .read import read

__all__ = ["read", "study"]


class _Study(ModuleType):
    """`equipoise.study` is this package and the function of its name, whichever was asked for first."""

    def __call__(self, *args: Any, **options: Any) -> Any:
        return study(*args, **options)


sys.modules[__name__].__class__ = _Study
