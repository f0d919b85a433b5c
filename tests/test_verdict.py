"""Clearance over the workspace in closed form, slack and over-centre poses, and the file's capsules."""

import json
from dataclasses import replace

import numpy as np
import pytest
import zoo

import equipoise as eq
from equipoise.clearance import clearance
from equipoise.model.errors import InputError


def test_the_distance_to_a_post_in_closed_form():
    found = clearance(zoo.with_post(), samples=200)
    assert found.least == pytest.approx(0.1 - 0.01 - 0.01, abs=1e-9)
    assert (found.gaps[0].spring, found.gaps[0].other) == ("shoulder spring", "post")


def test_two_springs_that_cross():
    m = zoo.pendulum()
    other = replace(m.springs[0], name="other", p_a=(0.0, 0.05, 0.2), p_b=(0.15, 0.05, 0.0), diameter=0.01)
    assert clearance(m.with_springs((*m.springs, other)), samples=100).least == pytest.approx(0.045, abs=1e-9)


def test_slack_and_over_centre():
    """Shorter than 0.2 m where cos q' > (a^2 + b^2 - L0^2) / (2 a b); half of all poses pull the other way."""
    found = clearance(zoo.with_post(0.2), samples=20_000).lines[0]
    share = np.arccos((0.2**2 + 0.15**2 - 0.2**2) / (2 * 0.2 * 0.15)) / np.pi
    assert found.slack == pytest.approx(share, abs=0.01)
    assert found.over_centre["shoulder"] == pytest.approx(0.5, abs=0.01)
    assert clearance(zoo.with_post(), samples=100).lines[0].slack == 0


def test_a_limited_joint_does_not_go_over_centre():
    m = zoo.with_post()
    m = replace(m, joints=(replace(m.joints[0], range=(-1.0, 1.0)), *m.joints[1:]))
    assert clearance(m, samples=500).lines[0].over_centre == {}


def test_capsules_in_the_file(tmp_path):
    eq.save(zoo.with_post(), tmp_path / "post.yaml")
    assert eq.load(tmp_path / "post.yaml") == zoo.with_post()
    text = (tmp_path / "post.yaml").read_text()
    (tmp_path / "bad.yaml").write_text(text.replace("body: stand", "body: stnad"))
    with pytest.raises(InputError, match=r"capsules\[0\].body.*'stnad'; did you mean 'stand'"):
        eq.load(tmp_path / "bad.yaml")


def test_without_springs_there_is_nothing_to_say():
    with pytest.raises(InputError, match="no springs"):
        clearance(zoo.pendulum().with_springs(()))


def test_command_line(run, tmp_path):
    file = tmp_path / "post.yaml"
    eq.save(zoo.with_post(0.2), file)
    code, out, _ = run("clearance", file, "--samples", 200)
    assert code == 0
    for text in ("CLEAR: least distance 80 mm", "SLACK", "goes over centre about shoulder", "post"):
        assert text in out
    code, out, _ = run("clearance", file, "--samples", 200, "--least", "90mm", "--json")
    assert code == 1
    assert json.loads(out)["least"] == pytest.approx(0.08)
