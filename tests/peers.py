"""Independent libraries that some platforms do not have: skipped there, but never where CI runs."""

from __future__ import annotations

import os
from importlib import import_module
from typing import Any

import pytest


def peer(name: str) -> Any:
    return import_module(name) if os.environ.get("CI") else pytest.importorskip(name)
