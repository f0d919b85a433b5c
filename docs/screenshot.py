"""Renew docs/images/viewer.png: the viewer in Chromium, drawn as the tests draw it.

Run it as `.venv/bin/python docs/screenshot.py`.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from browser import chromium  # noqa: E402 - the tests' browser, from their folder

import equipoise as eq  # noqa: E402
from equipoise.viewer.server import Viewer  # noqa: E402


def main() -> None:
    mechanism = eq.load(ROOT / "examples" / "mechanisms" / "delta_balanced.yaml")
    with tempfile.TemporaryDirectory() as folder, chromium() as browser:
        viewer = Viewer(mechanism, Path(folder) / "mine.yaml", port=8095)
        page = browser.new_page(viewport={"width": 1280, "height": 860})
        page.goto(viewer.url)
        page.wait_for_selector("[data-residual]", timeout=60_000)
        for q in viewer.panel.motions["each joint in turn"][:100:4]:
            viewer.panel.go(q)
        page.get_by_role("button", name="\u2715").or_(page.locator(".mantine-Notification-closeButton")).first.click()
        page.wait_for_timeout(4000)
        page.screenshot(path=ROOT / "docs" / "images" / "viewer.png")
        viewer.close()


if __name__ == "__main__":
    main()
