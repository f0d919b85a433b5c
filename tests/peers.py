"""Independent libraries that some platforms do not have: skipped there, but never where CI runs."""

from __future__ import annotations

import os
from importlib import import_module, metadata
from pathlib import Path
from typing import Any

import pytest


def peer(name: str) -> Any:
    return import_module(name) if os.environ.get("CI") else pytest.importorskip(name)


def robot_files(package: str, suffix: str) -> list[Path]:
    """The files with this suffix that a package installs, in their order; none where it does not install, as above."""
    try:
        found = metadata.distribution(package)
    except metadata.PackageNotFoundError:
        if os.environ.get("CI"):
            raise
        return []
    return sorted(Path(str(found.locate_file(file))).resolve() for file in found.files or () if file.suffix == suffix)
