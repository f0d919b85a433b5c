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
from equipoise.notebook import Shown
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


def test_a_balance_shows_its_verdict_picture_springs_and_torques():
    balance = eq.check(pendulum())
    shown = Text(balance._repr_html_())
    for text in ("EXACT", "196.2", "N m", "Schematic of", balance.coordinates[0]):
        assert text in shown.words
    assert balance._repr_svg_() == to_text(balance.mechanism)


def test_a_design_says_how_far_from_the_best_it_is():
    design = eq.design(lee_chen(), span=3, radius=0.2)
    shown = Text(design._repr_html_())
    for text in ("method convex", "rms torque", "of the best", "EXACT"):
        assert text in shown.words
    assert ElementTree.fromstring(design._repr_svg_()).tag.endswith("svg")
    assert design._repr_svg_() == to_text(design.mechanism)


def test_pictures_of_different_mechanisms_do_not_share_identifiers():
    one, two = (Text(eq.check(pendulum(k))._repr_html_()).ids for k in (196.2, 100.0))
    assert one
    assert not set(one) & set(two)


@pytest.mark.parametrize("name", ZOO)
def test_all_of_the_zoo(name):
    assert ZOO[name]().mechanism.name in Text(eq.check(ZOO[name]().mechanism, samples=64)._repr_html_()).words


def test_names_cannot_break_out():
    evil = "</svg><b>x"
    mechanism = pendulum().with_springs([eq.Spring(evil, "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2)])
    html = eq.check(mechanism)._repr_html_()
    assert "<b>" not in html
    assert evil in Text(html).words


def test_nothing_without_springs_or_joints_breaks_it():
    for mechanism in (eq.Mechanism("empty"), pendulum().with_springs([])):
        assert mechanism.name in Text(eq.check(mechanism)._repr_html_()).words


def test_what_does_not_know_how_to_show_itself_says_so():
    with pytest.raises(TypeError, match="Odd does not show itself"):
        type("Odd", (Shown,), {})()._repr_html_()


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
