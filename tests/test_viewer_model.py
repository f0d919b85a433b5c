"""What the viewer changes: a weight's mass, its effect on the residual, and what is saved."""

from __future__ import annotations

import pytest
from peers import peer
from robots import planar_arm

import equipoise as eq
from equipoise.viewer.model import Model

HINGE = planar_arm([2.0], [0.5], [0.3]).with_masses([eq.PointMass("weight", "link2", 1.0, (-0.2, 0, 0))])


def test_a_weight_can_be_changed():
    model = Model(HINGE)
    before = model.residual()
    assert before.rms == pytest.approx(before.unbalanced)
    model.weigh(0, 3.0)
    assert model.edited
    assert model.residual().rms < 1e-12
    saved = model.saved()
    assert saved.masses[0].mass == 3.0
    assert eq.check(saved).exact
    model.weigh(0, 0.0)
    assert model.residual().unbalanced == pytest.approx(1.5 * before.unbalanced)


def test_a_weight_has_a_slider(tmp_path):
    peer("viser")
    from equipoise.viewer.server import Viewer

    viewer = Viewer(HINGE, tmp_path / "mine.yaml", port=8160)
    try:
        (slider,) = viewer.panel.weights
        assert slider.value == pytest.approx(1.0, abs=slider.step)
        slider.value = slider.max  # three times what it is
        viewer.panel._weigh(0)
        assert viewer.model.masses[0].mass == pytest.approx(3.0)
        assert len(viewer.scene.skeleton.masses) == 1  # it is drawn
    finally:
        viewer.close()
