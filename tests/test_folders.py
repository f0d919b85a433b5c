"""The README lists the folders that there are, each with the first sentence of its docstring; no module is long."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "equipoise"
MOST_LINES = 300


def folders() -> dict[str, str]:
    """Every folder with what its docstring says first."""
    found = {}
    for path in SOURCE.rglob("__init__.py"):
        name = path.parent.relative_to(SOURCE).as_posix()
        text = " ".join((ast.get_docstring(ast.parse(path.read_text())) or "").split())
        found[name] = re.split(r"(?<=\.) ", text)[0]
    del found["."]
    return found


def section() -> str:
    return (ROOT / "README.md").read_text().partition("## Where things are\n")[2].partition("\n## ")[0]


def test_the_readme_lists_the_folders():
    listed = dict(re.findall(r"^\| `([\w/]+)/` \| (.*) \|$", section(), flags=re.MULTILINE))
    expected = folders()
    rows = "\n".join(f"| `{name}/` | {expected[name]} |" for name in sorted(expected))
    assert listed == expected, (
        f"README, 'Where things are', should have these rows, in an order of your choice:\n{rows}"
    )


def test_the_readme_names_the_files_beside_them():
    listed = re.findall(r"`(\w+)`", section().partition("Beside the folders: ")[2].split("\n\n")[0])
    assert sorted(listed) == sorted(path.stem for path in SOURCE.glob("[!_]*.py"))


def test_no_module_is_long():
    lines = {path.relative_to(SOURCE).as_posix(): len(path.read_text().splitlines()) for path in SOURCE.rglob("*.py")}
    assert [name for name, count in lines.items() if count > MOST_LINES] == []


def test_contributing_names_files_that_exist():
    """`NAME` stands for what is added: then the folder around it exists."""
    text = re.sub(r"```.*?```", "", (ROOT / "CONTRIBUTING.md").read_text(), flags=re.DOTALL)
    paths = re.findall(r"`([\w/]+(?:\.py|\.md|/\w+))(?: OLD NEW)?`", text)
    assert len(paths) > 30
    for path in paths:
        place = path.partition("NAME")[0].rpartition("/")[0] if "NAME" in path else path
        assert (SOURCE / place).exists() or (ROOT / place).exists(), path
