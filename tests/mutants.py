"""Mutation testing: `make mutants` breaks the source at places drawn at random, and asks the tests of each module.

    .venv/bin/python tests/mutants.py --count 400 --seed 0

One mutant is one operator, comparison, number or truth value of a function that becomes another one, in a copy of the
source. Its tests are those that name its module or its folder, and those that import it. A mutant that no test fails is
a survivor; those of `tests/survivors.txt` have a reason, the others make the command exit 1.
"""

from __future__ import annotations

import argparse
import ast
import copy
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCE, TESTS = ROOT / "src" / "equipoise", ROOT / "tests"
PLACES = ("energy", "balance.py", "synthesis", "hardware")
REASONS = TESTS / "survivors.txt"
LIMIT = 400  # [s] for the tests of one mutant; what takes longer has been noticed
SWAPS: dict[type, type] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult, ast.Pow: ast.Mult,
    ast.Mod: ast.Mult, ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.And: ast.Or,
    ast.Or: ast.And,
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """In a module's function, the n-th place: `old` becomes `new`."""

    module: str
    function: str
    place: int
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.module}: {self.function}: {self.old} -> {self.new}"


def changed(node: ast.AST) -> Iterator[ast.AST]:
    """What may stand instead of a node."""
    if isinstance(node, (ast.BinOp, ast.AugAssign, ast.BoolOp)) and type(node.op) in SWAPS:
        other = copy.copy(node)
        other.op = SWAPS[type(node.op)]()
        yield other
    elif isinstance(node, ast.Compare):
        for i, op in enumerate(node.ops):
            other = copy.copy(node)
            other.ops = [SWAPS[type(op)]() if j == i else one for j, one in enumerate(node.ops)]
            yield other
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
        yield node.operand
    elif isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        yield ast.copy_location(ast.Constant(not node.value if isinstance(node.value, bool) else node.value + 1), node)
    elif isinstance(node, ast.IfExp):
        yield node.body
        yield node.orelse


def places(tree: ast.Module) -> Iterator[tuple[str, ast.AST, str, int | None, ast.AST]]:
    """(function, parent, field, index, node) of what is inside functions; not in annotations, messages and defaults."""

    def inside(name: str, parent: ast.AST) -> Iterator[tuple[str, ast.AST, str, int | None, ast.AST]]:
        for field, value in ast.iter_fields(parent):
            if field in (
                "annotation",
                "returns",
                "decorator_list",
                "args" if isinstance(parent, ast.FunctionDef) else "",
            ):
                continue
            several = value if isinstance(value, list) else [value]
            for i, node in enumerate(several):
                if isinstance(node, ast.AST) and not isinstance(node, (ast.Raise, ast.Assert, ast.JoinedStr)):
                    yield name, parent, field, i if isinstance(value, list) else None, node
                    yield from inside(name, node)

    for one in tree.body:
        several = [(one.name, one)] if isinstance(one, ast.FunctionDef) else []
        if isinstance(one, ast.ClassDef):
            several = [(f"{one.name}.{f.name}", f) for f in one.body if isinstance(f, ast.FunctionDef)]
        for name, function in several:
            yield from inside(name, function)


def mutants(path: Path) -> list[Mutant]:
    """All of a module."""
    tree, module, found = ast.parse(path.read_text(encoding="utf-8")), path.relative_to(SOURCE).as_posix(), []
    for function, _, _, _, node in places(tree):
        for other in changed(node):
            old, new = (" ".join(ast.unparse(one).split()) for one in (node, other))
            found.append(Mutant(module, function, len(found), old, new))
    return found


def source_of(mutant: Mutant) -> str:
    """The module's text with the mutant in it."""
    tree = ast.parse((SOURCE / mutant.module).read_text(encoding="utf-8"))
    every = [(parent, field, i, other) for _, parent, field, i, node in places(tree) for other in changed(node)]
    parent, field, i, other = every[mutant.place]
    if i is None:
        setattr(parent, field, other)
    else:
        getattr(parent, field)[i] = other
    return ast.unparse(ast.fix_missing_locations(tree))


def modules(only: str) -> list[Path]:
    found = [SOURCE / place for place in PLACES]
    every = [one for path in found for one in (sorted(path.rglob("*.py")) if path.is_dir() else [path])]
    return [path for path in every if re.search(only, path.relative_to(SOURCE).as_posix())]


@cache
def tests_of(module: str) -> tuple[str, ...]:
    """The test files that name a module, itself or as part of its folder; else those of the modules that import it."""
    stem, dotted = (
        Path(module).stem,
        "equipoise." + module.removesuffix(".py").replace("/", ".").removesuffix(".__init__"),
    )
    texts = {path: path.read_text(encoding="utf-8") for path in sorted(TESTS.glob("test_*.py"))}
    folder, _, name = dotted.rpartition(".")
    named = (
        rf"from {re.escape(dotted)} import|import {re.escape(dotted)}\b|from {re.escape(folder)} import .*\b{name}\b"
    )
    own = {f"test_{stem}", f"test_{Path(module).parent.name}"}
    found = [path for path, text in texts.items() if path.stem in own or re.search(named, text)]
    found = found or [path for path, text in texts.items() if f"{folder}." in text]
    return tuple(path.relative_to(ROOT).as_posix() for path in found)


def passes(source: Path, tests: tuple[str, ...], limit: float = LIMIT) -> bool:
    """Whether tests pass on a source."""
    asked = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-m", "not slow", *tests]
    environment = {**os.environ, "PYTHONPATH": str(source)}
    try:
        done = subprocess.run(asked, cwd=ROOT, env=environment, capture_output=True, timeout=limit, check=False)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def reasons() -> dict[str, str]:
    """Of known survivors: the mutant as it is printed -> why it changes nothing that can be seen."""
    lines = REASONS.read_text(encoding="utf-8").splitlines() if REASONS.exists() else []
    return dict(line.split("  # ", 1) for line in lines if "  # " in line)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="modules whose path has this pattern")
    parser.add_argument("--list", action="store_true", help="only list them")
    given = parser.parse_args()
    every = [mutant for path in modules(given.only) for mutant in mutants(path)]
    drawn = random.Random(given.seed).sample(every, min(given.count, len(every)))
    print(f"{len(drawn)} of {len(every)} mutants in {len(modules(given.only))} modules, seed {given.seed}", flush=True)
    known, survivors, killed, whole = reasons(), [], 0, {}
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "src"
        shutil.copytree(ROOT / "src", source)  # with what is compiled
        for number, mutant in enumerate(drawn, 1):
            tests, start = tests_of(mutant.module), time.monotonic()
            if given.list:
                print(mutant, *tests)
                continue
            copied = source / "equipoise" / mutant.module
            copied.write_text(source_of(mutant), encoding="utf-8")
            survived = not tests or passes(source, tests)
            shutil.copy2(SOURCE / mutant.module, copied)
            if not survived and tests not in whole:  # tests that fail by themselves kill nothing
                whole[tests] = passes(source, tests)
            survived = survived or not whole[tests]
            killed += not survived
            if survived:
                survivors.append(mutant)
            what = "survived" if survived else "killed"
            print(f"{number}/{len(drawn)} {time.monotonic() - start:.0f} s {what}: {mutant}", flush=True)
    if given.list:
        return 0
    unknown = [mutant for mutant in survivors if str(mutant) not in known]
    for mutant in survivors:
        print(f"survivor: {mutant}: {known.get(str(mutant), 'NO REASON')}; asked {' '.join(tests_of(mutant.module))}")
    counted = killed + len(unknown)
    print(f"killed {killed} of {counted} mutants that change something: {killed / max(1, counted):.1%}")
    return 1 if unknown else 0


if __name__ == "__main__":
    sys.exit(main())
