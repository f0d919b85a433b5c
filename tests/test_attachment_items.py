"""Attachments in a mechanism file: read, written and wrong."""

import pytest

import equipoise as eq
from equipoise.io.yaml import to_text
from equipoise.model.errors import InputError

LAMP = """\
schema: 1
name: lamp
bodies: [{{name: lower, mass: 1, com: [0.2, 0, 0]}}, {{name: upper, mass: 1, com: [0.2, 0, 0]}}]
joints:
  - {{name: base, type: revolute, parent: world, child: lower, axis: [0, 1, 0]}}
  - {{name: elbow, type: revolute, parent: lower, child: upper, xyz: [0.4, 0, 0], axis: [0, 1, 0]}}
attachments:
{}
"""


def lamp(tmp_path, *lines: str) -> eq.Mechanism:
    path = tmp_path / "lamp.yaml"
    path.write_text(LAMP.format("\n".join(f"  - {line}" for line in lines)), encoding="utf-8")
    return eq.load(path)


def test_every_shape_is_read_and_written(tmp_path):
    m = lamp(
        tmp_path,
        "{body: world, centre: [0, 0, 100 mm], box: [50 mm, 0, 0.02]}",
        "{body: world, point: true}",
        "{body: lower, centre: elbow, ball: 8 cm}",
    )
    assert [(one.body, one.region) for one in m.attachments] == [
        ("world", eq.Region.box((0.05, 0, 0.02), (0, 0, 0.1))),
        ("world", eq.Region.point()),
        ("lower", eq.Region.ball(0.08, "elbow")),
    ]
    path = tmp_path / "again.yaml"
    path.write_text(to_text(m), encoding="utf-8")
    assert eq.load(path) == m


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("{body: lwer, point: true}", r"lamp.yaml:8:12: attachments\[0\].body: there is no body 'lwer'; did you mean"),
        ("{body: lower, centre: elbw, point: true}", r"8:27: .*no joint 'elbw'; .*'elbow'\? \(valid: elbow, base\)"),
        ("{body: lower, centre: [0, 0], point: true}", r"8:27: .*list of 3 numbers \[m\] or the name of a joint"),
        ("{body: lower, box: [0.1, -1 mm, 0]}", r"8:24: .*box: its size must be at least 0 m, found 0.1, -0.001, 0"),
        ("{body: lower, ball: 0}", "8:25: .*ball: its size must be more than 0 m, found 0"),
        ("{body: lower}", "give one of 'box'"),
        ("{body: lower, ball: 1, point: true}", "give one of 'box'"),
        ("{body: lower, point: false}", "8:26: .*point: expected true, found false"),
        ("{body: lower, bal: 80 mm, point: true}", r"unknown key 'bal'; did you mean 'ball'\?"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_where_it_stands(tmp_path, line, message):
    with pytest.raises(InputError, match=message):
        lamp(tmp_path, line)
