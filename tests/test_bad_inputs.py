"""Every broken file in `bad_inputs` gives exactly the message in the .txt beside it."""

from __future__ import annotations

from pathlib import Path

import pytest

from equipoise import io
from equipoise.model.errors import InputError

FOLDER = Path(__file__).parent / "bad_inputs"
FILES = sorted(FOLDER.glob("*.yaml"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_message(path):
    with pytest.raises(InputError) as caught:
        io.load(path)
    message = str(caught.value).replace(f"{FOLDER}/", "")
    assert message + "\n" == path.with_suffix(".txt").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_command_line_says_it_with_exit_code_2_and_writes_nothing(run, path, tmp_path):
    before = sorted(FOLDER.iterdir())
    code, out, err = run("design", path, "-o", tmp_path / "out.yaml", "--plot", tmp_path / "out.svg")
    assert (code, out) == (2, "")
    assert err.replace(f"{FOLDER}/", "") == f"error: {path.with_suffix('.txt').read_text(encoding='utf-8')}"
    assert not list(tmp_path.iterdir())
    assert sorted(FOLDER.iterdir()) == before


def test_every_message_has_its_file():
    assert {path.stem for path in FILES} == {path.stem for path in FOLDER.glob("*.txt")}


@pytest.mark.parametrize("name", ["arm.stl", "arm.json", "arm"])
def test_other_suffixes_are_refused_with_the_choices(name):
    with pytest.raises(InputError, match=r"valid: \.yaml, \.yml, \.urdf, \.xml, \.mjcf"):
        io.load(name)


@pytest.mark.parametrize(("name", "tool"), [("arm.sdf", "sdf2mjcf"), ("arm.urdf.xacro", "xacro FILE > robot.urdf")])
def test_what_can_be_turned_into_a_mechanism_file_is_refused_with_the_tool(name, tool):
    with pytest.raises(InputError, match=f"a mechanism file cannot be .*: .*{tool}"):
        io.load(name)
