"""Methods side by side: rows agree with the methods themselves, end in time, and say why not."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path

import pytest
from zoo import pendulum

import equipoise as eq
from equipoise.report.compare import row_line, save_comparison
from equipoise.study.compare import UNKNOWN, Compared, Comparison, plan, worked_out

PENDULUM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"


def test_rows_are_what_the_methods_give():
    m = pendulum()
    rows = [row for row in plan(m, (1,)) if row.name in ("convex, span 1", "bevel")]
    found = {row.name: row for row in worked_out(m, rows, 60.0)}
    row, design = found["convex, span 1"], eq.design(m, span=1)
    assert row.exact is True
    assert row.rms == pytest.approx(design.residual / design.unbalanced, abs=1e-9)
    assert row.force == pytest.approx(max(use.max_force for use in design.balance.use), rel=1e-6)
    assert row.energy == pytest.approx(design.balance.springs[1], rel=1e-6)
    assert row.buildable is True
    assert row.mass == pytest.approx(eq.hardware(design.balance).mass, rel=1e-6)
    assert found["bevel"].springs is None
    assert "roll-pitch" in found["bevel"].note
    assert row_line(row).plain.startswith("convex, span 1     0, proved")


def test_a_row_ends_with_its_time():
    m = pendulum()
    began = time.monotonic()
    (row,) = worked_out(m, [row for row in plan(m) if row.name == "convex, span 1"], 0.05)
    assert row.note == UNKNOWN
    assert time.monotonic() - began < 20


def test_spans_beyond_the_arm_are_one_row():
    assert [row.name for row in plan(pendulum(), (1, 2, 3)) if row.method == "convex"] == ["convex, span 1"]


def test_the_picture_and_the_text(tmp_path):
    row = Compared("planar", "planar", exact=False, left=0.1, rms=0.05, bound=0.04, springs=2, force=10.0, energy=1.0)
    rows = (row, replace(row, name="delta", springs=None, note="it has no loops"))
    found = Comparison(pendulum(), rows)
    save_comparison(found, tmp_path / "methods.svg")
    assert (tmp_path / "methods.svg").stat().st_size > 1000
    assert "no: it has no loops" in str(found)
    assert found.to_dict()["rows"][0]["bound"] == 0.04


def test_command_line(run):
    code, out, _ = run("compare", PENDULUM, "--spans", "1", "--seconds", "1e-3", "--json")
    assert code == 1
    assert {row["method"] for row in json.loads(out)["rows"]} >= {"convex", "planar", "delta"}
    assert run("compare", PENDULUM, "--spans", "0")[0] == 2
    assert run("compare", PENDULUM, "--seconds", "0")[0] == 2
