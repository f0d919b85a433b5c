"""Compiled functions: kept, out of date when what they call has changed, and compiled anew where nothing is kept."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from equipoise.model.compiled import Compiled

SOURCE = Path(__file__).parents[1] / "src"


def twice(x):
    return 2 * x


def test_a_spoilt_cache_is_passed_by(monkeypatch):
    def spoilt(*_):
        raise EOFError("ran out of input")

    function = Compiled(twice)
    function.__dict__["_kept"] = spoilt
    monkeypatch.setattr(Compiled, "broken", type(Compiled.broken)())
    assert function(3.0) == 6.0
    assert Compiled.broken.is_set()


def test_a_change_of_what_is_called_is_seen(tmp_path):
    """The caller's own file is the same: numba alone would load what it has kept."""
    (tmp_path / "outer.py").write_text(
        "import inner\nfrom equipoise.model.compiled import Compiled\n"
        "def outer(x):\n    return inner.inner(x)\nouter = Compiled(outer, inner)\n"
    )
    found = []
    for factor in (2.0, 3.0):
        (tmp_path / "inner.py").write_text(
            f"from numba.extending import register_jitable\n@register_jitable\ndef inner(x):\n    return {factor} * x\n"
        )
        environment = {**os.environ, "PYTHONPATH": f"{SOURCE}{os.pathsep}{tmp_path}", "PYTHONDONTWRITEBYTECODE": "1"}
        environment["NUMBA_CACHE_DIR"] = str(tmp_path / "kept")
        command = [sys.executable, "-c", "from outer import outer; print(outer(1.0))"]
        found.append(
            subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.strip()
        )
    assert list((tmp_path / "kept").rglob("*.nbi"))
    assert found == ["2.0", "3.0"]
