"""Mechanism files: `load` reads YAML, URDF and MJCF, `save` writes YAML."""

from __future__ import annotations

import os
from pathlib import Path

from ..model.errors import Fault, InputError
from ..model.mechanism import Mechanism
from . import models

Source = Mechanism | str | os.PathLike[str]
"""A mechanism, or the path of a file that `load` reads."""
YAML_SUFFIXES = (".yaml", ".yml")
WRITERS = ("yaml", "urdf", "mjcf")  # the modules here that have a `to_text(mechanism)`


def load(path: str | os.PathLike[str]) -> Mechanism:
    """Read a mechanism file; the suffix says which kind: .yaml or .yml, .urdf, .mjcf.

    In a file .xml the root element says it.

    Raises:
        InputError: everything that is wrong with the file, with file, line and column.
    """
    suffix = Path(path).suffix.lower()
    if suffix in YAML_SUFFIXES:
        from . import yaml

        return yaml.read(path)
    if suffix in models.MODEL_SUFFIXES:
        return models.read(path)
    found = f"a mechanism file cannot be {_suffix(path)}"
    raise InputError(Fault((), found, (*YAML_SUFFIXES, *models.MODEL_SUFFIXES), file=os.fspath(path)))


def loaded(source: Source) -> Mechanism:
    """The mechanism itself, or the one in the file: what every function that is given either begins with.

    Raises:
        InputError: it is neither, or as `load`.
    """
    if isinstance(source, Mechanism):
        return source
    if isinstance(source, (str, os.PathLike)):
        return load(source)
    raise InputError(f"expected a mechanism or the path of its file, found a {type(source).__name__}")


def save(mechanism: Source, path: str | os.PathLike[str]) -> None:
    """Write a mechanism as YAML, whole or not at all; `load` gives an equal mechanism back.

    Raises:
        InputError: the suffix is not .yaml or .yml, or the file cannot be written.
    """
    from . import yaml
    from .files import write_text

    check_savable(path)
    write_text(path, yaml.to_text(loaded(mechanism)))


def check_savable(path: str | os.PathLike[str]) -> None:
    """Whether `save` could write there, asked before long work.

    Raises:
        InputError: as `save` does.
    """
    from .files import check_writable

    if Path(path).suffix.lower() not in YAML_SUFFIXES:
        found = f"a mechanism is saved as YAML, not as {_suffix(path)}"
        raise InputError(Fault((), found, YAML_SUFFIXES, file=os.fspath(path)))
    check_writable(path)


def _suffix(path: str | os.PathLike[str]) -> str:
    suffix = Path(path).suffix
    return f"'{suffix}'" if suffix else "a file without a suffix"
