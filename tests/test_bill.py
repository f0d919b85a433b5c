"""`equipoise hardware`, `stock` and `made-up` as a user meets them, and the sheets they draw."""

import csv
import json
import xml.etree.ElementTree as ET
from itertools import pairwise

import ezdxf.filemanagement
import pytest
from robots import lee_chen, lee_chen_springs

import equipoise as eq
from equipoise.hardware import Envelope, Options
from equipoise.hardware.realise.bill import bill
from equipoise.report import drawing
from equipoise.report.drawing import Drawing, save_drawing
from equipoise.report.sheet import sheet
from equipoise.report.style import clean

BARE = ("--safety", "1", "--fatigue", "0")  # no more than the list says
ROOM = ("--outer", "40mm", "--length", "1.2m", "--pulley", "5mm")


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.yaml"
    eq.save(lee_chen_springs(), path)
    return path


def test_bill_of_materials(run, arm, tmp_path) -> None:
    table, drawing = tmp_path / "bill.csv", tmp_path / "springs.svg"
    code, out, err = run("hardware", arm, *ROOM, "-o", table, "--sheet", drawing)
    assert code == 0
    for text in ("telescope", "eyelet", "free length", "fatigue", "margin", "behind A", "as built", "assumed", "N m"):
        assert text in out
    assert f"wrote {table}" in err
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [row["kind"] for row in rows] == ["telescope", "eyelet", "eyelet"]
    assert float(rows[0]["rate"]) == pytest.approx(590)
    ET.fromstring(drawing.read_text())


def test_json(run, arm) -> None:
    code, out, _ = run(
        "hardware", arm, *ROOM, "--json", "--wire", "SH,1.4310", "--fatigue", "1", "--limit", "extension=0.4"
    )
    found = json.loads(out)
    assert code == 0
    assert found["complete"]
    assert found["limits"]["extension"]["value"] == 0.4
    assert "EN 13906-2" in found["limits"]["extension"]["source"]
    for spring in found["springs"]:
        way = spring["realisations"][0]
        assert way["kind"] == spring["chosen"]
        assert way["fatigue_margin"] >= 1 - 1e-9
        assert way["wire"] in ("EN 10270-1 SH", "EN 10270-3 1.4310")
        assert {"static_margin", "natural_frequency", "index", "residual_share", "mass"} <= way.keys()
    assert len(found["residual"]["built"]) == 3


def test_exit_code_one_when_a_spring_cannot_be_made(run, arm) -> None:
    code, out, _ = run("hardware", arm, *ROOM, "--realise", "direct")
    assert code == 1
    assert "INCOMPLETE" in out
    assert "cannot be made: the attachments come as near as" in out
    assert "What would help" in out
    code, out, _ = run("hardware", arm, "--outer", "5mm", "--length", "0.2", "--most", "1", "--json")
    assert code == 1
    assert json.loads(out)["residual"].keys() == {"design", "design_share"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--wire", "1.4130"), "did you mean '1.4310'"),
        (("--wire", "oil-hardened"), "must be given"),
        (("--strength", "5 kg"), "--strength"),
        (("--outer", "0"), "more than 0 m"),
        (("--outer", "1mm"), "no preferred DH wire"),
        (("--pulley", "-1"), "--pulley"),
        (("--realise", "rope"), "unknown realisation"),
        (("--limit", "beauty=1"), "unknown limit"),
        (("--limit", "extension"), "NAME=VALUE"),
        (("--friction", "pulley=200%"), "--friction"),
        (("--friction", "rope=1%"), "unknown realisation"),
        (("--sheet", "springs.pdf"), "cannot be written as '.pdf'"),
        (("-o", "bill.txt"), "written as .csv"),
    ],
)
def test_bad_options(run, arm, arguments, message) -> None:
    code, out, err = run("hardware", arm, *arguments)
    assert (code, out) == (2, "")
    assert message in err


def test_a_mechanism_without_springs(run, tmp_path) -> None:
    eq.save(lee_chen(), tmp_path / "bare.yaml")
    code, _, err = run("hardware", tmp_path / "bare.yaml")
    assert code == 2
    assert "has none" in err
    code, _, err = run("stock", tmp_path / "bare.yaml", tmp_path / "none.csv")
    assert code == 2


def test_stock(run, arm, tmp_path) -> None:
    listed, moved = tmp_path / "list.csv", tmp_path / "moved.yaml"
    code, _, err = run("made-up", "-o", listed, "--count", 60, "--seed", 3)
    assert code == 0
    assert "all made up" in err
    # a few that fit among many that do not
    rows = listed.read_text().splitlines()
    fits = [
        f"FIT-{k},extension,{k},{f},0,0.2,0.02,0.0015,{m},1"
        for k, f, m in ((590, 156, 0.05), (78, 48, 0.06), (160, 68, 0.07))
    ]
    listed.write_text("\n".join([*rows, *fits]) + "\n")
    code, out, err = run("stock", arm, listed, "-o", moved, "--travel", "0.5:2", *BARE)
    assert code == 0
    assert "PROVEN" in out
    assert "EXACT" in out
    assert eq.check(eq.load(moved)).exact
    taken = [(spring.part, spring.realisation) for spring in eq.load(moved).springs]
    assert all(part and realisation in ("eyelet", "telescope") for part, realisation in taken)
    code, out, _ = run("stock", arm, listed, "--travel", "0.5:2", *BARE, "--json")
    found = json.loads(out)
    assert found["proven"]
    assert found["balance"]["exact"]
    assert found["cost"] <= 0.18 + 1e-9
    code, _, err = run("stock", arm, listed, "--travel", "0.999:1.001", "--reach", "1mm")
    assert (code, err) == (0, "") or "error" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--travel", "x"), "LOW:HIGH"),
        (("--travel", "2:3"), "low <= 1"),
        (("--goal", "x"), "unknown goal"),
        (("--column", "x"), "NAME=VALUE"),
    ],
)
def test_bad_stock_options(run, arm, tmp_path, arguments, message) -> None:
    run("made-up", "-o", tmp_path / "list.csv", "--count", 10)
    code, out, err = run("stock", arm, tmp_path / "list.csv", *arguments)
    assert (code, out) == (2, "")
    assert message in err


def made():
    return bill(eq.check(lee_chen_springs(), samples=200), Options(envelope=Envelope(0.04, 1.2)))


def test_sheet_shows_every_spring_with_its_dimensions_inside_the_frame() -> None:
    found = made()
    drawn = sheet(found)
    texts = [one.text for one in drawn.labels]
    for item in found.items:
        spring = item.ways[0].winding.spring
        assert f"L0 = {spring.free_length * 1e3:.4g}" in texts
        assert f"De = {spring.outer * 1e3:.4g}" in texts
        assert any(item.spring.name in text for text in texts)
    for line in drawn.lines:
        for x, y in line.points:
            assert 0 <= x <= drawn.width
            assert 0 <= y <= drawn.height
    root = ET.fromstring(drawn.svg())
    assert root.get("viewBox") == f"0 0 {drawn.width:g} {drawn.height:g}"
    assert drawn.svg() == sheet(found).svg()


def test_dimension_lines_are_as_long_as_what_they_measure() -> None:
    drawing = Drawing(200, 100)
    drawing.dimension((20, 30), (120, 30), 10, "100")
    drawing.dimension((130, 20), (130, 70), 8, "50")
    straight = [line.points for line in drawing.lines if len(line.points) == 2]
    lengths = [abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in straight]
    assert 100 in lengths
    assert 50 in lengths


def test_dxf(tmp_path) -> None:
    found = sheet(made())
    save_drawing(found, tmp_path / "springs.dxf")
    document = ezdxf.filemanagement.readfile(tmp_path / "springs.dxf")
    assert not document.audit().errors
    assert document.units == 4  # mm
    texts = {text.dxf.text for text in document.modelspace().query("TEXT")}
    assert {clean(one.text, 200) for one in found.labels} <= texts
    lines = sum(len(list(pairwise(line.points))) for line in found.lines if not line.filled and len(line.points) == 2)
    assert len(document.modelspace().query("LINE")) == lines


def test_dxf_without_ezdxf_says_what_to_install(run, arm, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(drawing, "find_spec", lambda name: None)
    code, _, err = run("hardware", arm, *ROOM, "--sheet", tmp_path / "springs.dxf")
    assert code == 2
    assert "pip install 'equipoise[cad]'" in err


def test_what_would_help_does_help(arm) -> None:
    mechanism = eq.load(arm)
    hard = Options(envelope=Envelope(0.006, 1.2), most=1)
    item = bill(eq.check(mechanism, samples=200), hard).items[0]
    assert not item.chosen
    assert "stress" in item.hopeless
    wider = next(text for text in item.remedies if "--outer" in text)
    outer = float(wider.split("outer diameter of ")[1].split(" mm")[0]) / 1000
    helped = bill(eq.check(mechanism, samples=200), Options(envelope=Envelope(outer + 1e-4, 1.2), most=1))
    assert helped.items[0].chosen
