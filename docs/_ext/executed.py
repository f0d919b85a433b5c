"""Directives that run equipoise while the documentation is built, so that what a page shows is what the program says.

- ``{run}``: command lines, one each, or Python with the argument ``python``; with what they print. They run in a folder
  of the page, where ``examples`` is. ``:exit:`` the code that the last one ends with; ``:head:``, ``:tail:`` how many
  lines of its output are shown; ``:picture:`` a file that it made, with ``:alt:``.
- ``{file}``: a file of the page's folder, shown as it is written, for the commands after it.
- ``{element}``: the lines of one spring in a mechanism file, with its picture on an arm, what `check` says of it, and
  its force over its length or angle.
- ``{paper}``: a paper's published and computed numbers, errata and figures.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from docutils.statemachine import StringList
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

DOCS = Path(__file__).resolve().parents[1]
MADE = "_generated"  # what the pages make, below the documentation's folder
COLUMNS = 92


class Executed(SphinxDirective):
    """What both need."""

    @property
    def folder(self) -> Path:
        """Where this page's commands run."""
        folder = DOCS / MADE / self.env.docname
        folder.mkdir(parents=True, exist_ok=True)
        examples = folder / "examples"
        if not examples.exists():
            examples.symlink_to(DOCS.parent / "examples")
        return folder

    def execute(self, command: list[str], code: int = 0) -> str:
        """Its output; the build ends where it does not exit with `code`."""
        beside = {"COLUMNS": str(COLUMNS), "NO_COLOR": "1", "TERM": "dumb", "PYTHONPATH": str(DOCS.parent / "src")}
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
        done = subprocess.run(
            command, cwd=self.folder, env={**os.environ, **beside, "PATH": path}, text=True, check=False,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        if done.returncode != code:
            place = f"{self.env.docname}, line {self.lineno}"
            raise ExtensionError(f"{place}: exit code {done.returncode}, not {code}: {command}\n{done.stdout}")
        return done.stdout.rstrip() + "\n"

    def picture(self, name: str, alt: str) -> list[nodes.Node]:
        path = self.folder / name
        if not path.is_file():
            raise ExtensionError(f"{self.env.docname}, line {self.lineno}: '{name}' was not made")
        return self.markdown(f"![{alt}](/{path.relative_to(DOCS).as_posix()})")

    def markdown(self, text: str) -> list[nodes.Node]:
        node = nodes.container()
        self.state.nested_parse(StringList(text.splitlines(), self.env.docname), self.content_offset, node)
        return node.children


class Run(Executed):
    has_content = True
    optional_arguments = 1
    option_spec: ClassVar[dict[str, Any]] = {
        "exit": directives.nonnegative_int,
        "head": directives.nonnegative_int,
        "tail": directives.nonnegative_int,
        "picture": directives.unchanged_required,
        "alt": directives.unchanged_required,
    }

    def run(self) -> list[nodes.Node]:
        code = self.options.get("exit", 0)
        if self.arguments == ["python"]:
            script = "\n".join(self.content)
            shown = nodes.literal_block(script, script, language="python")
            output = self._part(self.execute([sys.executable, "-c", script], code))
            found: list[nodes.Node] = [shown, nodes.literal_block(output, output, language="text")]
        else:
            *before, last = [line for line in self.content if line.strip()]
            lines = []
            for line in before:
                lines += [f"$ {line}", *self.execute(shlex.split(line)).splitlines()]
            lines += [f"$ {last}", self._part(self.execute(shlex.split(last), code))]
            text = "\n".join(lines)
            found = [nodes.literal_block(text, text, language="text")]
        if "picture" in self.options:
            found += self.picture(self.options["picture"], self.options.get("alt", "what the command drew"))
        return found

    def _part(self, output: str) -> str:
        lines = output.splitlines()
        head, tail = (self.options.get(key) for key in ("head", "tail"))
        if head is not None and len(lines) > head:
            lines = [*lines[:head], "..."]
        if tail is not None and len(lines) > tail:
            lines = ["...", *lines[-tail:]]
        return "\n".join(lines) + "\n"


class File(Executed):
    has_content = True
    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        (name,) = self.arguments
        text = "\n".join(self.content) + "\n"
        (self.folder / name).write_text(text)
        return [nodes.literal_block(text, text, language=Path(name).suffix[1:])]


ARM = """\
schema: 1
name: an arm
bodies: [{name: arm, mass: 1, com: [0.2, 0, 0]}]
joints: [{name: hinge, type: revolute, parent: world, child: arm, axis: [0, -1, 0], range: [-70 deg, 70 deg]}]
springs:
"""


class Element(Executed):
    has_content = True
    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        (name,) = self.arguments
        lines = "\n".join(self.content)
        file = self.folder / f"{name}.yaml"
        file.write_text(ARM + "\n".join(f"  {line}" for line in self.content) + "\n")
        self.execute(["equipoise", "export", file.name, "--to", "svg", "-o", f"{name}.svg"])
        curve = str(Path(__file__).with_name("force_curve.py"))
        self.execute([sys.executable, curve, file.name, f"{name}-force.svg"])
        said = self.execute(["equipoise", "check", file.name], 1).partition("worst pose:")[2].partition("\n")[2]
        said = said.partition("next:")[0]
        return [
            nodes.literal_block(lines, lines, language="yaml"),
            *self.picture(f"{name}.svg", f"{name} on an arm"),
            nodes.literal_block(said, said, language="text"),
            *self.picture(f"{name}-force.svg", f"The force of {name}"),
        ]


class Paper(Executed):
    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        (key,) = self.arguments
        self.execute(["equipoise", "reproduce", key, "-o", "."])
        report = (self.folder / f"{key}.md").read_text()
        _, _, body = report.partition("\n")  # the page has a title of its own
        made = "/" + self.folder.relative_to(DOCS).as_posix()
        return self.markdown(body.strip().replace(f"]({key}-", f"]({made}/{key}-"))


def setup(app: Any) -> dict[str, bool]:
    app.add_directive("file", File)
    app.add_directive("run", Run)
    app.add_directive("element", Element)
    app.add_directive("paper", Paper)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
