"""The README's example runs as printed, and prints what is printed there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
EXAMPLE, OUTPUT = re.findall(r"```(?:python|text)\n(.*?)```", README, flags=re.DOTALL)[:2]


@pytest.mark.filterwarnings("ignore:links with identical inertials")  # the robot's own, shown on standard error
def test_the_example_prints_what_the_readme_says(tmp_path, monkeypatch, capsys):
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    exec(compile(EXAMPLE, "README.md", "exec"), {})
    printed = capsys.readouterr().out.splitlines()
    expected = OUTPUT.splitlines()
    assert len(printed) == len(expected)
    for found, wanted in zip(printed, expected, strict=True):
        if "N/m from" in wanted:  # which of several equally good designs is found may depend on the machine's rounding
            assert re.fullmatch(r" +\d+ N/m from \w+ to \w+", found)
        else:
            assert found == wanted
    assert (tmp_path / "ur5-balanced.yaml").exists()


def test_the_example_is_fifteen_lines():
    assert len(EXAMPLE.splitlines()) <= 15


def test_every_link_of_the_readme_leads_somewhere():
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
