"""A real browser without a window, for tests of pages; skipped where there is none, but never where CI runs.

One serves a whole session (the fixture `browser`); a page is open as long as it is looked at. What a page is waited
for is a state of it: `PATIENCE` only ends a test that would wait for ever.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest
from peers import peer

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

NAMES = ("chromium", "chromium-browser", "google-chrome")
QUIET = [  # no sandbox: CI runs as root; no request of its own; no graphics card: the processor draws, WebGL too
    "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-gpu", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]  # fmt: skip
PATIENCE = 300_000  # [ms]
LOOK = 50  # [ms] between two looks at what a page does


@contextmanager
def chromium() -> Iterator[Browser]:
    """The system's Chromium."""
    api = peer("playwright.sync_api")
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        if os.environ.get("CI"):
            raise RuntimeError(f"no browser: none of {', '.join(NAMES)} is installed")
        pytest.skip("no Chromium is installed")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=QUIET, timeout=PATIENCE)
        try:
            yield browser
        finally:
            browser.close()


@contextmanager
def opened(browser: Browser, width: int, height: int, **options: Any) -> Iterator[Page]:
    """A new page of this size, without animations."""
    page = browser.new_page(viewport={"width": width, "height": height}, reduced_motion="reduce", **options)
    page.set_default_timeout(PATIENCE)
    try:
        yield page
    finally:
        page.close()


def wait_until(page: Page, done: Callable[[], bool]) -> None:
    """Until the page has brought about what `done` looks for."""
    for _ in range(PATIENCE // LOOK):
        if done():
            return
        page.wait_for_timeout(LOOK)
    raise AssertionError("the page did not follow")
