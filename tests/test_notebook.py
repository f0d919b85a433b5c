"""Designs and verdicts as notebooks show them."""

from __future__ import annotations

import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
from robots import lee_chen
from zoo import ZOO, pendulum

import equipoise as eq
from equipoise.model.notebook import Shown
from equipoise.report.schematic import to_text

PENDULUM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"


class Text(HTMLParser):
    """The words of a piece of HTML, and its identifiers."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.words, self.ids, self.depth = "", [], 0
        self.feed(html)
        assert self.depth == 0

    def handle_starttag(self, tag, attrs):
        self.depth += 1
        self.ids += [value for name, value in attrs if name == "id"]

    def handle_endtag(self, tag):
        self.depth -= 1

    def handle_data(self, data):
        self.words += data


def html(value: Shown) -> str:
    found = value._repr_html_()
    assert found is not None
    return found


def test_a_balance_shows_its_verdict_picture_springs_and_torques():
    balance = eq.check(pendulum())
    shown = Text(html(balance))
    for text in ("EXACT", "196.2", "N m", "Schematic of", balance.coordinates[0]):
        assert text in shown.words
    assert balance._repr_svg_() == to_text(balance.mechanism)


def test_a_design_says_how_far_from_the_best_it_is():
    design = eq.design(lee_chen(), span=3, radius=0.2)
    shown = Text(html(design))
    for text in ("method convex", "rms torque", "of the best", "EXACT"):
        assert text in shown.words
    assert ElementTree.fromstring(design._repr_svg_() or "").tag.endswith("svg")
    assert design._repr_svg_() == to_text(design.mechanism)


def test_pictures_of_different_mechanisms_do_not_share_identifiers():
    one, two = (Text(html(eq.check(pendulum(k)))).ids for k in (196.2, 100.0))
    assert one
    assert not set(one) & set(two)


@pytest.mark.parametrize("name", ZOO)
def test_all_of_the_zoo(name):
    assert ZOO[name]().mechanism.name in Text(html(eq.check(ZOO[name]().mechanism, samples=64))).words


def test_names_cannot_break_out():
    evil = "</svg><b>x"
    mechanism = pendulum().with_springs([eq.Spring(evil, "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2)])
    shown = html(eq.check(mechanism))
    assert "<b>" not in shown
    assert evil in Text(shown).words


def test_nothing_without_springs_or_joints_breaks_it():
    for mechanism in (eq.Mechanism("empty"), pendulum().with_springs([])):
        assert mechanism.name in Text(html(eq.check(mechanism))).words


def test_of_what_nobody_draws_a_notebook_prints_the_text():
    odd = type("Odd", (Shown,), {})()
    assert odd._repr_html_() is None
    assert odd._repr_svg_() is None


def test_the_first_value_that_is_shown_loads_the_report_and_nothing_else_does():
    code = (
        "import sys, equipoise as eq\n"
        f"balance = eq.check(eq.load({str(PENDULUM)!r}), samples=64)\n"
        "assert not any(name.startswith('equipoise.report') for name in sys.modules)\n"
        "assert 'EXACT' in balance._repr_html_() and 'equipoise.report' in sys.modules\n"
        "print('shown')\n"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (found.stdout, found.stderr) == ("shown\n", "")


def test_it_needs_no_extra():
    code = (
        "import sys\n"
        "for name in ('matplotlib', 'jinja2', 'typst', 'mujoco', 'ezdxf'): sys.modules[name] = None\n"
        "import equipoise as eq\n"
        f"design = eq.check(eq.load({str(PENDULUM)!r}))\n"
        "assert 'EXACT' in design._repr_html_() and '<svg' in design._repr_svg_()\n"
        "print('shown')\n"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (found.stdout, found.stderr) == ("shown\n", "")
