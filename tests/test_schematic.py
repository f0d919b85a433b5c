"""The schematic: what stands in it, where it stands, and that it can be read."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from loop_zoo import four_bar
from robots import lee_chen, lee_chen_springs, robot
from zoo import pendulum

import equipoise as eq
from equipoise.kinematics import Tree
from equipoise.report.poses import choose
from equipoise.report.schematic import HEIGHT, WIDTH, schematic, symbols, to_text
from equipoise.report.skeleton import Skeleton
from equipoise.report.style import spring_colour

EXAMPLES = sorted((Path(__file__).parents[1] / "examples" / "mechanisms").glob("*.yaml"))


def zigzags(mechanism: eq.Mechanism) -> list[np.ndarray]:
    """(points, 2) [mm] of each spring."""
    lines = schematic(mechanism, legend=False).lines
    colours = [spring_colour(i) for i in range(len(mechanism.springs))]
    return [np.array(line.points) for colour in colours for line in lines if line.colour == colour and not line.filled]


def flat_ends(mechanism: eq.Mechanism) -> np.ndarray:
    """(springs, 2, 2) [m] where the ends are in the picture."""
    skeleton = Skeleton.of(mechanism)
    view, q = choose(mechanism, skeleton)
    return view.flat(skeleton.ends(Tree.of(mechanism).poses(q[1:])))[0]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_is_drawn_inside_its_sheet_with_a_letter_for_each_end(path):
    mechanism = eq.load(path)
    drawing = schematic(mechanism, legend=False)
    for line in drawing.lines:
        x, y = np.array(line.points).T
        assert 0 <= x.min() <= x.max() <= WIDTH
        assert 0 <= y.min() <= y.max() <= HEIGHT
    letters = [text for letter in "abk" for text in symbols(mechanism, letter)]
    assert sorted(label.text for label in drawing.labels) == sorted(letters)
    for label in drawing.labels:
        assert 0 < label.at[0] < WIDTH
        assert 0 < label.at[1] < HEIGHT


@pytest.mark.parametrize("mechanism", [pendulum(), lee_chen_springs()], ids=["one spring", "three springs"])
def test_springs_lead_from_end_to_end_to_scale(mechanism):
    ends, drawn = flat_ends(mechanism), zigzags(mechanism)
    assert len(drawn) == len(mechanism.springs)
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    on_sheet = np.array([np.linalg.norm(path[0] - path[-1]) for path in drawn])
    scale = on_sheet / lengths
    assert scale == pytest.approx(scale[0], rel=1e-9)
    offset = drawn[0][0] - scale[0] * ends[0, 0]
    for path, (a, b) in zip(drawn, ends, strict=True):
        assert path[0] == pytest.approx(scale[0] * a + offset)
        assert path[-1] == pytest.approx(scale[0] * b + offset)


def test_the_ground_is_hatched_below_the_base():
    drawing = schematic(pendulum(), legend=False)
    slanted = [
        line for line in drawing.lines if len(line.points) == 2 and line.points[0][0] < line.points[1][0]
        and line.points[0][1] < line.points[1][1]
    ]  # fmt: skip
    assert len(slanted) >= 8


@pytest.mark.parametrize("make", [pendulum, lee_chen_springs], ids=["pendulum", "lee_chen"])
def test_letters_do_not_cover_each_other(make):
    labels = schematic(make(), legend=False).labels
    for a, b in combinations(labels, 2):
        wide = 0.62 * a.size * (len(a.text) + len(b.text)) / 2
        assert abs(a.at[0] - b.at[0]) > wide or abs(a.at[1] - b.at[1]) > 0.9 * a.size, (a.text, b.text)


def test_the_legend_gives_stiffness_bodies_and_places():
    drawing = schematic(lee_chen_springs())
    assert drawing.height > HEIGHT
    said = " | ".join(label.text for label in drawing.labels)
    for i, spring in enumerate(lee_chen_springs().springs):
        assert f"{spring.stiffness:.5g} N/m" in said
        assert symbols(lee_chen_springs(), "k")[i] in said
        assert f"{spring.body_b} (" in said
    assert all(0 < label.at[1] < drawing.height for label in drawing.labels)


def test_long_names_do_not_run_into_each_other_in_the_legend():
    long = "a name that is longer than any column"
    springs = [eq.Spring(long, "world", (0, 0, 0.2), long, (-0.0531, -0.0681, 0.1403), 12345.6)]
    joint = replace(pendulum().joints[0], child=long)
    drawing = schematic(eq.Mechanism("long", (eq.Body(long, 2.0, (0.3, 0, 0)),), (joint,), springs=tuple(springs)))
    row = sorted((label for label in drawing.labels if label.size < 3), key=lambda label: label.at[0])
    for y in {label.at[1] for label in row}:
        ends = [(-1.0, 0.0)]
        for label in (label for label in row if label.at[1] == y):
            wide = 0.62 * label.size * len(label.text)  # DejaVu Sans has about this
            left = label.at[0] - (wide if label.anchor == "end" else 0)
            assert left >= ends[-1][1], label.text
            ends.append((left, left + wide))
        assert ends[-1][1] <= WIDTH


def test_svg_is_well_formed_and_the_same_each_time():
    texts = {to_text(robot("ur5")) for _ in range(2)}
    assert len(texts) == 1
    assert ElementTree.fromstring(texts.pop()).tag.endswith("svg")


def test_names_are_escaped_and_symbols_are_numbered():
    spring = eq.Spring("<a&b>", "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2)
    assert "<a&b>" in "".join(ElementTree.fromstring(to_text(pendulum().with_springs([spring]))).itertext())


@pytest.mark.parametrize(
    ("names", "letters"),
    [
        (["k2", "k12"], ["k₂", "k₁₂"]),
        (["link 2 spring", "link 3 spring"], ["k₂", "k₃"]),
        (["spring 1 (1-3)", "spring 2 (1-4)", "spring 3 (1-4)"], ["k₁₃", "k₁₄,₁", "k₁₄,₂"]),
        (["left spring", "right spring"], ["k₁", "k₂"]),
        (["spring 7 1", "spring 7 2"], ["k₁", "k₂"]),
    ],
)
def test_springs_have_the_letters_of_their_names(names, letters):
    springs = [eq.Spring(name, "world", (0, 0, 0.2), "arm", (0.15, 0, 0), 196.2) for name in names]
    assert symbols(pendulum().with_springs(springs), "k") == letters


@pytest.mark.parametrize("mechanism", [eq.Mechanism("empty"), lee_chen()], ids=["empty", "without springs"])
def test_without_springs_there_is_no_legend(mechanism):
    drawing = schematic(mechanism)
    assert drawing.height == HEIGHT
    assert not drawing.labels


def test_export_writes_it(run, tmp_path):
    out = tmp_path / "arm.svg"
    assert run("export", EXAMPLES[0], "--to", "svg", "-o", out)[0] == 0
    assert out.read_text() == to_text(eq.load(EXAMPLES[0]))
    code, said, err = run("export", EXAMPLES[0], "--to", "sgv")
    assert (code, said) == (2, "")
    assert "did you mean 'svg'?" in err


@pytest.mark.parametrize("to", ["svg", "dxf"])
def test_loops_that_cannot_close_are_an_error(run, tmp_path, to):
    (loop,) = (bar := four_bar()).loops
    open_bar = replace(
        bar,
        loops=(replace(loop, p_b=(100.0, 0.0, 0.0)),),
        springs=(eq.Spring("s", "world", (0, 0, 0.2), bar.bodies[0].name, (0.1, 0, 0), 50.0),),
    )
    eq.save(open_bar, tmp_path / "broken.yaml")
    code, said, err = run("export", tmp_path / "broken.yaml", "--to", to, "-o", tmp_path / f"out.{to}")
    assert (code, said) == (2, "")
    assert "\nerror: " in f"\n{err}"
    assert [path.name for path in tmp_path.iterdir()] == ["broken.yaml"]
