"""Options of `equipoise design` for the method cam."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..model.errors import Fault, InputError
from .buildable import parts


def for_cam(method: str, joint: str | None, stock: Path | None, columns: list[str] | None = None) -> dict[str, Any]:
    """The options of the method cam that are not given by ``--set``.

    Raises:
        InputError: another method, or a list that cannot be read.
    """
    given = {"--joint": joint, "--stock": stock}
    if method != "cam":
        if used := [name for name, value in given.items() if value is not None]:
            raise InputError(Fault((used[0],), f"is for --method cam; the method is {method}"))
        return {}
    found: dict[str, Any] = {} if joint is None else {"joint": joint}
    if stock is not None:
        found["stock"] = parts(stock, columns)
    return found
