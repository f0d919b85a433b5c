"""Every reader takes what a fuzzer makes of the examples: half an hour under `make deep`, a twentieth elsewhere."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from campaign import share
from fuzz import READERS

SECONDS = 1800 // len(READERS)


@pytest.mark.deep
@pytest.mark.parametrize("reader", READERS)
def test_nothing_but_our_errors(reader: str) -> None:
    seconds = share(SECONDS)
    command = [sys.executable, str(Path(__file__).with_name("fuzz.py")), reader, str(seconds)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=seconds + 300, errors="replace")
    assert done.returncode == 0, done.stderr[-3000:]
