"""What the import contracts of `pyproject.toml` cannot see."""

from __future__ import annotations

import ast
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "equipoise"
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]


def test_the_core_names_nothing_above_it():
    """Import contracts do not see imports by string, so the core has none, and no string with a module of ours."""
    core = [name.partition(".")[2] for name in CONTRACTS[1]["source_modules"]]
    files = [path for name in core for path in [SOURCE / f"{name}.py", *(SOURCE / name).rglob("*.py")] if path.exists()]
    assert len(files) > len(core)
    modules = {path.stem for path in SOURCE.iterdir()}
    for path in files:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            assert not isinstance(node, ast.Name) or node.id not in ("import_module", "__import__"), path
            assert not isinstance(node, ast.Attribute) or node.attr != "import_module", path
            if isinstance(node, ast.Constant) and str(node.value).startswith("equipoise."):
                assert str(node.value).split(".")[1] not in modules, path
