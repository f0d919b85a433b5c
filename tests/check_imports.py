"""Is there a circle of imports? `python tests/check_imports.py`, a part of `make lint`; it looks within packages too.

An import counts wherever it stands: at the top, in a function, or as a string that names one of our modules. One that
is for types only (under TYPE_CHECKING) does not count: a circle of such imports is told, and allowed.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import grimp

SOURCE, PACKAGE = Path(__file__).parents[1] / "src", "equipoise"
ALLOWED = {
    ("equipoise.kinematics.tree", "equipoise.kinematics.linkage"): "`Tree.of` gives the mechanism with loops its own",
}
"""Imports (from, to) that may close a circle, and why they must."""

Edges = dict[str, set[str]]


def main() -> None:
    """Prints the circles, each with its shortest ring; exit code 1 when one is not allowed."""
    sys.path.insert(0, str(SOURCE))  # this checkout, whichever is installed
    graph = grimp.build_graph(PACKAGE, cache_dir=None, exclude_type_checking_imports=True)
    every = grimp.build_graph(PACKAGE, cache_dir=None)
    edges = {a: graph.find_modules_directly_imported_by(a) | set(named(a, graph.modules)) for a in graph.modules}
    faults = [
        f"ALLOWED has {a} -> {b}, which closes no circle: take it off the list"
        for a, b in ALLOWED
        if b not in edges.get(a, ()) or not any({a, b} <= set(circle) for circle in circles(edges))
    ]
    strict = {a: {b for b in edges[a] if (a, b) not in ALLOWED} for a in edges}
    found = circles(strict)
    for circle in found:
        faults.append(f"{len(circle)} modules import each other: {listed(circle)}; the shortest ring:")
        shortest = min((ring(a, strict) for a in circle), key=len)
        for a, b in pairwise(shortest):
            lines = graph.get_import_details(importer=a, imported=b)
            faults += [f"    {a}, " + (f"line {lines[0]['line_number']}: imports {b}" if lines else f"a string: {b}")]
    for circle in circles({a: strict[a] | every.find_modules_directly_imported_by(a) - edges[a] for a in strict}):
        if not any(set(circle) & set(one) for one in found):
            print(f"for types only, and allowed: {listed(circle)}")
    print("\n".join(faults) or f"no circle among the imports of {len(edges)} modules, {len(ALLOWED)} imports excepted")
    sys.exit(bool(faults))


def listed(names: list[str], most: int = 8) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def named(module: str, modules: set[str]) -> Iterator[str]:
    """The modules that a module names in its strings."""
    path = SOURCE / module.replace(".", "/")
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in modules - {PACKAGE}:
            yield node.value


def circles(edges: Edges) -> list[list[str]]:
    """The sets of modules that all reach each other (Tarjan 1972)."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(a: str) -> None:
        number[a] = low[a] = len(number)
        stack.append(a)
        for b in edges[a]:
            if b not in number:
                visit(b)
            if b in stack:
                low[a] = min(low[a], low[b])
        if low[a] == number[a]:
            at = stack.index(a)
            circle, stack[at:] = sorted(stack[at:]), []
            if len(circle) > 1 or a in edges[a]:
                found.append(circle)

    for a in sorted(edges):
        if a not in number:
            visit(a)
    return sorted(found)


def ring(start: str, edges: Edges) -> list[str]:
    """The shortest way from a module of a circle back to itself."""
    ways = [[start]]
    seen: set[str] = set()
    for way in ways:  # which grows
        for b in sorted(edges[way[-1]] - seen):
            if b == start:
                return [*way, b]
            seen.add(b)
            ways.append([*way, b])
    raise ValueError(f"{start} is in no circle")


if __name__ == "__main__":
    main()
