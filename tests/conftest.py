"""What several test files use."""

from __future__ import annotations

import os
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # workers that each use all cores wait for each other

from collections.abc import Iterator
from typing import Any

import pytest
from browser import chromium
from campaign import SHARE
from hypothesis import HealthCheck, settings

from equipoise import cli

# a slow machine is no fault, and the examples are the same each time, but in campaigns
settings.register_profile("steady", deadline=None, derandomize=SHARE > 1, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("steady")


@pytest.hookimpl(tryfirst=True)  # before -m chooses
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.browser)
            item.add_marker(pytest.mark.slow(reason="needs a browser"))
        if item.get_closest_marker("deep"):
            item.add_marker(pytest.mark.slow(reason="a campaign"))
        for mark in item.iter_markers("slow"):
            if not mark.kwargs.get("reason"):
                raise pytest.UsageError(f"{item.nodeid} does not say why: @pytest.mark.slow(reason=...)")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """One for all: a test opens pages in it."""
    with chromium() as found:
        yield found


@pytest.fixture
def run(monkeypatch, capsys):
    """Call the command line in this process: (exit code, standard output, standard error)."""

    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["equipoise", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        out, err = capsys.readouterr()
        assert "Traceback" not in err
        return int(stop.value.code or 0), out, err

    return call
