"""`equipoise report`: one file, whole and right, whose numbers are those of `check --json`."""

from __future__ import annotations

import json
import re
import shlex
import sys
from dataclasses import replace
from datetime import datetime
from html.parser import HTMLParser
from pathlib import Path

import pytest
from robots import balanced, lee_chen_springs
from zoo import free_length_pendulum, geared_pair, pendulum, vertical_slide

import equipoise as eq
from equipoise.io import files
from equipoise.model.errors import InputError
from equipoise.report.body_sheet import places
from equipoise.report.page import hardware as built
from equipoise.report.page.content import Number
from equipoise.report.page.design import torque_table
from equipoise.report.page.html import page
from equipoise.report.page.make import EXTRAS, make, save_report
from equipoise.report.page.pdf import pdf

MOST = 3_000_000  # bytes of a page
EXAMPLES = Path(__file__).parents[1] / "examples" / "mechanisms"
LIN = EXAMPLES / "lin2010_balanced.yaml"
VOID = {"meta", "link", "br", "img", "hr", "input"}


class Page(HTMLParser):
    """What is in a page: elements (tag, attributes, text below), each element closed by its own tag."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None], list[str]]] = []
        self.open: list[tuple[str, dict[str, str | None], list[str]]] = []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs) -> None:
        element = (tag, dict(attrs), [])
        self.found.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag, attrs) -> None:
        self.found.append((tag, dict(attrs), []))

    def handle_endtag(self, tag) -> None:
        assert self.open.pop()[0] == tag

    def handle_data(self, data) -> None:
        for _, _, texts in self.open:
            texts.append(data)

    def texts(self, tag: str, **attributes: str) -> list[str]:
        return [
            "".join(texts)
            for name, own, texts in self.found
            if name == tag and all(own.get(key) == value for key, value in attributes.items())
        ]

    def attributes(self, tag: str) -> list[dict[str, str | None]]:
        return [own for name, own, _ in self.found if name == tag]

    def data(self, key: str) -> dict:
        (text,) = self.texts("script", id=key)
        return json.loads(text)


def written(mechanism: eq.Mechanism, *extras: str) -> Page:
    return Page(page(make(eq.check(mechanism), extras=extras)))


@pytest.fixture
def report(run, tmp_path):
    """The page that the command line writes."""

    def call(path: Path, *options: object) -> Page:
        out = tmp_path / "report.html"
        code, said, err = run("report", path, "-o", out, *options)
        assert (code, said) == (0, "")
        assert f"wrote {out}" in err
        assert out.stat().st_size < MOST
        return Page(out.read_text("utf-8"))

    return call


# What is in it --------------------------------------------------------------------------------------------------------


def test_everything_is_in_the_page(report):
    today = datetime.now().date().isoformat()
    found = report(EXAMPLES / "pendulum.yaml", "--radius", "50mm")
    assert found.texts("h1") == ["one-link arm"]
    assert found.texts("h2") == [
        "For the workshop", "Mechanism and springs", "Energy and torque", "Certificate, bound and gap", "Simulation",
        "Hardware", "Tolerance", "Assumptions and conventions", "How to reproduce it, and provenance",
    ]  # fmt: skip
    (verdict,) = found.texts("p", **{"class": "verdict good"})
    assert verdict == "EXACT: balanced in every pose, proved; without springs shoulder holds up to 5.886 N m"
    everything = "".join(found.texts("main"))
    for text in (
        "N/m", "[mm]", "[J]", "N m", "Gravity is (0, 0, -9.81) m/s²", "It stays", "spheres of 50 mm", "wire", "builds",
        "SHA-256", "No others could leave less torque",
    ):  # fmt: skip
        assert text in everything
    assert found.texts("code")[0] == "equipoise report pendulum.yaml -o report.html --radius 50mm --date " + today
    captions = found.texts("caption")
    for text in ("Springs, and", "Attachments", "Holding torque of", "Potential energy", "Certificate", "Provenance"):
        assert any(caption.startswith(text) for caption in captions), text


@pytest.fixture(scope="module")
def ur5(tmp_path_factory) -> Path:
    """The UR5 made weightless by three springs."""
    path = tmp_path_factory.mktemp("ur5") / "ur5-balanced.yaml"
    eq.save(balanced().mechanism, path)
    return path


@pytest.mark.parametrize("name", ["ur5", "lin2010"])
def test_its_numbers_are_those_of_check(report, run, ur5, name):
    path = {"ur5": ur5, "lin2010": LIN}[name]
    found = report(path, "--samples", 300, "--seed", 3, "--with", "none")
    _, out, _ = run("check", path, "--json", "--samples", 300, "--seed", 3)
    checked = json.loads(out)
    assert found.data("balance") == checked
    shown = {float(own["value"]) for own in found.attributes("data") if own["value"] is not None}
    for load in (checked["torque"]["unbalanced"], checked["torque"]["residual"]):
        assert shown.issuperset(load["max"] + load["rms"])
    for spring in checked["springs"]:
        assert shown.issuperset([spring["stiffness"], spring["max_length"], spring["max_force"], *spring["p_a"]])
    assert shown.issuperset(checked["energy"]["gravity"] + checked["energy"]["total"] + checked["torque"]["bound"])


def test_each_shown_number_is_its_value_rounded():
    balance = eq.check(free_length_pendulum().mechanism)
    for row in torque_table(balance).rows:
        for cell in row:
            if isinstance(cell, Number):
                assert float(cell.text) == pytest.approx(cell.value, rel=1e-3)


def test_the_results_of_the_extras_are_those_of_their_commands(report, run):
    found = report(EXAMPLES / "pendulum.yaml", "--radius", "50mm")
    length = ("--seconds", built.SECONDS, "--poses", built.POSES, "--radius", "50mm")
    _, out, _ = run("simulate", EXAMPLES / "pendulum.yaml", "--json", *length)
    assert found.data("simulation") == json.loads(out)
    _, out, _ = run("hardware", EXAMPLES / "pendulum.yaml", "--json")
    made, shown = json.loads(out), found.data("hardware")
    assert [s["chosen"] for s in shown["springs"]] == [s["chosen"] for s in made["springs"]]
    assert shown["residual"] == made["residual"]
    assert found.data("tolerance")["builds"] == built.BUILDS


def test_the_command_in_the_page_gives_it_again(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source = Path("two words.yaml")
    eq.save(pendulum(), source)
    assert run("report", source, "-o", "one.html", "--with", "tolerance", "--seed", 2, "--samples", 50)[0] == 0
    before = Path("one.html").read_bytes()
    command = Page(before.decode()).texts("code")[0]
    Path("one.html").unlink()
    assert run(*shlex.split(command)[1:])[0] == 0
    assert Path("one.html").read_bytes() == before


def test_the_file_in_the_page_is_the_mechanism(tmp_path):
    for mechanism in (pendulum(), lee_chen_springs(), eq.load(EXAMPLES / "four_bar.yaml")):
        path = tmp_path / "again.yaml"
        path.write_text(written(mechanism).texts("code")[-1])
        assert eq.load(path) == mechanism


def test_what_cannot_be_run_says_why():
    bare = pendulum().with_springs([])
    found = written(bare, *EXTRAS)
    assert found.texts("p", **{"class": "answer"}).count("Not run.") >= 1
    for name in EXTRAS:
        if "not_run" in found.data(name):
            assert found.data(name)["not_run"] in found.texts("p")


def test_of_many_coordinates_the_most_loaded_ones_are_pictured():
    one = pendulum()
    names = [f"arm {i}" for i in range(14)]
    many = eq.Mechanism(
        "many arms",
        tuple(replace(one.bodies[0], name=name) for name in names),
        tuple(replace(one.joints[0], name=name, child=name) for name in names),
    )
    found = Page(page(make(eq.check(many, samples=50), extras=())))
    assert any("the 12 of 14 most loaded ones" in text for text in found.texts("figcaption"))


def test_what_was_not_asked_for_is_not_there():
    found = written(pendulum())
    assert not {"Simulation", "Hardware", "Tolerance"} & set(found.texts("h2"))
    assert len(found.texts("script")) == 1


@pytest.mark.parametrize(
    ("make_one", "verdict"),
    [
        (lambda: pendulum(190.0), "NOT EXACT"),
        (lambda: free_length_pendulum().mechanism, "NOT EXACT"),
        (lambda: vertical_slide().mechanism, "NOT EXACT"),
        (lambda: geared_pair(), "EXACT"),
        (lambda: replace(pendulum(), gravity=(0.0, 0.0, 0.0)), "NOT BALANCED"),
        (lambda: replace(pendulum(), springs=()), "no springs: shoulder holds up to 5.886 N m"),
        (lambda: replace(pendulum(), gravity=(0.0, 0.0, 0.0), springs=()), "EXACT"),
        (lambda: eq.Mechanism("empty"), "nothing moves"),
        (
            lambda: eq.Mechanism("welded", (eq.Body("a", 1.0),), (eq.Joint("j", "fixed", "world", "a"),)),
            "nothing moves",
        ),
    ],
)
def test_any_verdict_on_the_page_and_in_print(make_one, verdict):
    made = make(eq.check(make_one()), extras=())
    assert made.verdict.startswith(verdict)
    assert Page(page(made)).texts("p", **{"class": "verdict good" if made.good else "verdict"}) == [made.verdict]
    assert pdf(made).startswith(b"%PDF-")


# How it is read -------------------------------------------------------------------------------------------------------


def test_it_has_headings_heads_of_tables_and_texts_for_pictures(report):
    found = report(LIN, "--with", "none")
    ids = [own["id"] for _, own, _ in found.found if "id" in own]
    assert len(ids) == len(set(ids))
    assert {own["href"] for own in found.attributes("a")} <= {f"#{name}" for name in ids}
    assert len(found.texts("caption")) == len(found.texts("table"))
    assert all(own.get("scope") in ("row", "col") for own in found.attributes("th"))
    pictures = found.attributes("svg")
    drilled = len(places(eq.load(LIN)))
    assert len(pictures) == drilled + 5  # where to drill; two poses, schematic, bars, energies, torques
    for own in pictures:
        assert own["role"] == "img"
        for name in ("aria-labelledby", "aria-describedby"):
            tag = "title" if name == "aria-labelledby" else "desc"
            (text,) = found.texts(tag, id=own[name] or "")
            assert len(text) > 10
    assert found.attributes("html") == [{"lang": "en"}]


def test_it_refers_to_nothing_outside_itself(report):
    found = report(EXAMPLES / "pendulum.yaml", "--with", "none")
    for tag, own, _ in found.found:
        for name, value in own.items():
            if value is None or name == "xmlns":
                continue
            assert "://" not in value, (tag, name)
            if name in ("href", "src"):
                assert value.startswith("#") or value == "data:,", (tag, name)
            assert all(part.startswith("#") for part in re.findall(r"url\(([^)]*)", value)), (tag, name)
    (look,) = found.texts("style")
    assert "url(" not in look
    assert "@import" not in look


def test_names_cannot_break_out():
    evil = '</script><script>alert(1)</script><b>"&amp;'
    bodies = (eq.Body(evil, 2.0, (0.3, 0, 0)),)
    joints = (replace(pendulum().joints[0], name=evil, child=evil),)
    springs = (replace(pendulum().springs[0], name=evil, body_b=evil),)
    made = make(eq.check(eq.Mechanism(evil, bodies, joints, springs=springs)), extras=())
    found = Page(page(made))
    assert len(found.texts("script")) == 1
    assert not found.texts("b")
    assert found.data("balance")["mechanism"] == evil
    assert found.texts("h1") == [evil]
    assert pdf(made).startswith(b"%PDF-")


def test_the_pdf_is_the_same_bytes_each_time(run, tmp_path):
    out = tmp_path / "report.pdf"
    data = []
    for _ in range(2):
        assert run("report", EXAMPLES / "pendulum.yaml", "-o", out)[0] == 0
        data.append(out.read_bytes())
    assert data[0].startswith(b"%PDF-")
    assert data[0] == data[1]
    # tagged for screen readers: a language, heads of tables, a text for each of the five pictures
    for text, least in ((b"/StructTreeRoot", 1), (b"/Lang", 1), (b"/TH", 10), (b"/Alt", 5)):
        assert data[0].count(text) >= least, text


def test_json_is_what_the_page_holds(run, tmp_path):
    out = tmp_path / "report.html"
    code, said, _ = run("report", EXAMPLES / "pendulum.yaml", "-o", out, "--with", "hardware,tolerance", "--json")
    found = Page(out.read_text("utf-8"))
    assert code == 0
    assert json.loads(said) == {name: found.data(name) for name in ("balance", "hardware", "tolerance")}


# What can go wrong ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["FILE", "-o", "out.doc"], "a report cannot be written as '.doc' (valid: .html, .pdf)"),
        (["FILE", "-o", "out"], "a report cannot be written as ''"),
        (["FILE", "-o", "missing/out.html"], "no such file or folder"),
        (["FILE", "-o", "folder.html"], "it is a folder"),
        (["FILE", "-o", "out.html", "--with", "simulatoin"], "did you mean 'simulation'?"),
        (["FILE", "-o", "out.html", "--with", ""], "no section ''"),
        (["FILE", "-o", "out.html", "--with", "none,hardware"], "no section 'none'"),
        (["FILE", "-o", "out.html", "--samples", "0"], "--samples"),
        (["FILE", "-o", "out.html", "--radius", "wide"], "--radius"),
        (["FILE", "-o", "out.html", "--radius", "2 kg"], "--radius"),
        (["FILE", "-o", "out.html", "--seed", "-1"], "--seed"),
        (["FILE"], "--output"),
        (["absent.yaml", "-o", "out.html"], "absent.yaml"),
        (["broken.yaml", "-o", "out.html"], "broken.yaml"),
    ],
)
def test_bad_input_is_one_error_and_leaves_nothing(run, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    Path("folder.html").mkdir()
    Path("broken.yaml").write_text("schema: 1\nname: x\nbodies: 3\n")
    before = sorted(tmp_path.iterdir())
    code, out, err = run("report", *(EXAMPLES / "pendulum.yaml" if text == "FILE" else text for text in arguments))
    assert (code, out) == (2, "")
    assert err.lower().count("error") == 1  # the parser's own messages stand in a box named "Error"
    assert message in " ".join(err.split())
    assert sorted(tmp_path.iterdir()) == before


def test_an_unknown_section_is_refused_in_python():
    with pytest.raises(InputError, match="no section 'prices'"):
        make(eq.check(pendulum()), extras=["prices"])


@pytest.mark.parametrize("suffix", [".html", ".pdf"])
def test_nothing_is_left_when_writing_fails(tmp_path, monkeypatch, suffix):
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    made = make(eq.check(pendulum()), extras=())
    monkeypatch.setattr(files.os, "replace", full)
    with pytest.raises(InputError, match="no space left"):
        save_report(made, tmp_path / f"report{suffix}")
    assert not list(tmp_path.iterdir())


def test_it_says_what_to_install(tmp_path, monkeypatch):
    # not by a path from the package: its `report` is the command
    monkeypatch.setattr(sys.modules["equipoise.report.page.make"], "NEEDS", ("jinja2", "not_installed_anywhere"))
    made = make(eq.check(pendulum()), extras=())
    with pytest.raises(InputError, match=r"not_installed_anywhere: pip install 'equipoise\[report\]'"):
        save_report(made, tmp_path / "report.html")


def test_a_page_writes_out_what_would_be_obeyed(run, tmp_path):
    """Of values that the file brings, and of its own name."""
    file = tmp_path / "a\x1b[31m.yaml"
    made = '{method: "\\x1b[31mred <b>", other: "a\\u202eb", program: "bell \\x07 and \\x9b"}'
    arm = (
        'bodies: [{name: "a<script>", mass: 1}]\njoints: [{name: j, type: fixed, parent: world, child: "a<script>"}]\n'
    )
    file.write_text(f"schema: 1\nname: odd\n{arm}provenance: {made}\n")
    code, _, err = run("report", file, "--with", "none", "-o", tmp_path / "o.html")
    text = (tmp_path / "o.html").read_text(encoding="utf-8")
    assert code == 0, err
    assert [c for c in text if not c.isprintable() and c not in "\n\t"] == []
    for written in ("\\x1b[31mred &lt;b&gt;", "a\\u202eb", "bell \\x07 and \\x9b", "a&lt;script&gt;"):
        assert written in text
