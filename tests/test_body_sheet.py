"""The workshop's drawing: every attachment's distance stands on it, at its place and to scale, as SVG and as DXF."""

import re
from dataclasses import replace
from io import StringIO

import numpy as np
import pytest
import zoo
from peers import peer

import equipoise as eq
from equipoise.model.errors import InputError
from equipoise.model.mechanism import PointMass
from equipoise.report.body_sheet import MM, body_drawings, body_sheet, places


def arm() -> eq.Mechanism:
    m = zoo.pendulum()
    springs = (
        replace(m.springs[0], p_a=(-0.0205, 0.03, 0.12), p_b=(0.11, 0.03, -0.007)),
        eq.Spring("second", "world", (0.04, -0.03, 0.1203), "arm", (0.25, -0.03, 0.06), 100.0),
    )
    return replace(m.with_springs(springs), masses=(PointMass("ball", "arm", 0.5, (-0.1, 0.0, 0.0)),))


def test_every_distance_stands_on_it():
    sheet = body_sheet(arm(), "2026-01-02")
    texts = [label.text for label in sheet.labels]
    for own in places(arm()).values():
        for place in own:
            assert place.mark in texts
            for value in place.p:
                assert texts.count(f"{round(float(value), 2) + 0.0:g}") >= 2  # in the table, and as a dimension
    assert any("2026-01-02" in text for text in texts)
    assert "origin: joint 'shoulder'; scale 1:10" in texts


def test_crosses_are_where_the_attachments_are_and_to_scale():
    """Between the crosses of two places of a view there is their distance times the scale."""
    drawing = body_drawings(arm())["arm"]
    (scale,) = [1 / float(found[1]) for label in drawing.labels if (found := re.search(r"scale 1:(\d+)", label.text))]
    crosses = [np.mean(line.points, axis=0) for line in drawing.lines
               if len(line.points) == 2 and abs(np.ptp([p[0] for p in line.points]) - 2.8) < 1e-9]  # fmt: skip
    own = places(arm())["arm"]
    assert len(crosses) == 2 * len(own)
    first = np.array(crosses[: len(own)])
    expected = scale * np.array([place.p[[0, 2]] for place in own])  # seen along y, the least extent but one
    other = scale * np.array([place.p[[0, 1]] for place in own])
    shown = first - first[0]
    assert any(shown == pytest.approx(x - x[0], abs=1e-6) for x in (expected, other))


def test_it_is_a_dxf_too(run, tmp_path):
    ezdxf = peer("ezdxf")
    eq.save(arm(), tmp_path / "arm.yaml")
    code, out, err = run("export", tmp_path / "arm.yaml", "--to", "sheet-dxf")
    assert code == 0, err
    document = ezdxf.read(StringIO(out))
    texts = {entity.dxf.text for entity in document.modelspace() if entity.dxftype() == "TEXT"}
    assert {"120.3", "-20.5", "110"} <= texts
    code, out, _ = run("export", tmp_path / "arm.yaml", "--to", "sheet")
    assert (code, out.startswith("<svg")) == (0, True)


def test_nothing_to_drill_is_one_error():
    with pytest.raises(InputError, match="nothing is attached"):
        body_sheet(zoo.pendulum().with_springs(()))
    assert MM == 1000
