"""The report in a real browser: it loads nothing, everybody can read it, and it fits narrow screens and paper."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from browser import opened
from peers import peer
from robots import balanced

import equipoise as eq
from equipoise.report.page.make import make, save_report

EXAMPLES = Path(__file__).parents[1] / "examples" / "mechanisms"
SCHEMES = ("light", "dark")


@pytest.fixture(scope="module")
def ur5(tmp_path_factory) -> Path:
    """The report of the UR5 made weightless by three springs, with everything in it."""
    path = tmp_path_factory.mktemp("report") / "ur5.html"
    save_report(make(balanced().balance), path)
    return path


@pytest.fixture(scope="module")
def bare(tmp_path_factory) -> Path:
    """The report of an arm without springs, with long names."""
    path = tmp_path_factory.mktemp("report") / "bare.html"
    arm = replace(eq.load(EXAMPLES / "lee_chen_arm.yaml"), name="an arm whose name does not fit into one line " * 3)
    save_report(make(eq.check(arm)), path)
    return path


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", ["ur5", "bare"])
def test_it_opens_from_disk_alone_and_everybody_can_read_it(browser, request, name, scheme):
    path = request.getfixturevalue(name)
    assert path.stat().st_size < 3_000_000
    asked, said = [], []
    with opened(browser, 1200, 600, color_scheme=scheme) as page:
        page.on("request", lambda request: asked.append(request.url))
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.goto(path.as_uri())
        page.wait_for_load_state("networkidle")
        found = peer("axe_playwright_python.sync_playwright").Axe().run(page)
    assert [url for url in asked if url != "data:,"] == [path.as_uri()]  # "data:,": an icon of nothing, in the file
    assert said == []
    assert [
        (one["id"], [node["target"] for node in one["nodes"]])
        for one in found.response["violations"]
        if one["impact"] in ("serious", "critical")
    ] == []


@pytest.mark.parametrize("width", [360, 1200])
def test_it_fits_the_width_of_a_screen(browser, ur5, width):
    with opened(browser, width, 400) as page:
        page.goto(ur5.as_uri())
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_paper_is_white_in_dark_mode_too(browser, ur5):
    with opened(browser, 600, 400, color_scheme="dark") as page:
        page.goto(ur5.as_uri())
        colour = "getComputedStyle(document.body).backgroundColor"
        assert page.evaluate(colour) != "rgb(255, 255, 255)"
        page.emulate_media(media="print")
        assert page.evaluate(colour) == "rgb(255, 255, 255)"
        assert page.pdf().startswith(b"%PDF-")
