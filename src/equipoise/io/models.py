"""Model files, which a mechanism file can build on: URDF and MJCF."""

from __future__ import annotations

import os
from pathlib import Path

from ..model.mechanism import Mechanism
from .files import read_text
from .urdf_known import CONVERTED
from .xmltree import root_tag

__all__ = ["CONVERTED", "MODEL_SUFFIXES", "read"]

URDF_SUFFIXES = (".urdf", ".xml")
MJCF_SUFFIXES = (".mjcf", ".xml")
MODEL_SUFFIXES = tuple(dict.fromkeys((*URDF_SUFFIXES, *MJCF_SUFFIXES)))


def read(path: str | os.PathLike[str], base: str | None = None) -> Mechanism:
    """Read a file whose suffix is one of `MODEL_SUFFIXES`; in a file .xml the root element says which kind it is.

    Args:
        base: see `io.load`.

    Raises:
        InputError: everything that is wrong with the file.
    """
    suffix = Path(path).suffix.lower()
    if suffix in MJCF_SUFFIXES and (suffix not in URDF_SUFFIXES or _is_mjcf(path)):
        from . import mjcf_read

        return mjcf_read.read(path, base)
    from . import urdf

    return urdf.read(Path(path), base)


def _is_mjcf(path: str | os.PathLike[str]) -> bool:
    """Whether the first element of an XML file is MJCF's: comments and declarations may come before it."""
    return (root_tag(read_text(path)) or "").startswith("mujoco")  # <mujocoinclude> is a part of one
