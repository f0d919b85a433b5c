"""Every case of the verification manual holds, and notices its mutation."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from campaign import some
from test_mutations import SOURCE, mutate
from verification import CASES, FIELD, HANDBOOK, PAGE, PAPERS, page

NUMBERS = range(1, len(CASES) + 1)


def asked(number: int, folder: Path) -> int:
    """The exit code of one case with a source."""
    command = [sys.executable, str(Path(__file__).with_name("verification.py")), "--only", str(number)]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    return subprocess.run(command, env=environment, capture_output=True, timeout=300, check=False).returncode


@pytest.mark.parametrize("number", range(1, len(HANDBOOK) + 1))
def test_handbook_cases_hold(number):
    assert CASES[number - 1].holds()


@pytest.mark.slow(reason="reproduces sections of five papers, 20 s")
@pytest.mark.parametrize("number", range(len(HANDBOOK) + 1, len(CASES) + 1))
def test_the_other_cases_hold(number):
    assert CASES[number - 1].holds()


def test_there_are_forty_of_all_kinds():
    assert len(CASES) >= 40
    assert min(len(HANDBOOK), len(FIELD), len(PAPERS)) >= 8
    assert len({one.mutation for one in CASES}) == len(CASES)


@pytest.mark.slow(reason="reproduces sections of five papers, 20 s")
def test_the_page_is_what_the_command_makes():
    assert PAGE.read_text(encoding="utf-8").splitlines() == list(page())


@pytest.mark.deep
@pytest.mark.parametrize("number", some(NUMBERS, here=[1, 13, 15]))
def test_a_case_notices_its_mutation(number, tmp_path):
    assert asked(number, SOURCE) == 0
    copy = tmp_path / "src"
    shutil.copytree(SOURCE, copy)
    mutate(CASES[number - 1].mutation, copy)
    assert asked(number, copy) == 1
