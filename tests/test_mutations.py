"""`equipoise reproduce` notices when the source is broken: each mutation of a copy makes it exit 1 and name a row.

A mutation says in which function which expression becomes what. The function is looked for in all of the source, so
that modules may move; the expression has to be there exactly once.
"""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from campaign import some

SOURCE = Path(__file__).parents[1] / "src"
LIMIT = 900  # [s] for one reproduction


@dataclass(frozen=True)
class Mutation:
    """In `function`, a qualified name, the expression `old` becomes `new`; `paper` has to notice."""

    paper: str
    function: str
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.paper}: {self.function}: {self.old} -> {self.new}"


GROSS = (  # the first six that went unnoticed
    Mutation("lin2010", "Builder.build", "K", "0.7 * K"),
    Mutation(
        "lenzo2017",
        "springs",
        "fill(_products(arm, lift), known, _defaults(arm, layout, a2))",
        "(lambda v: v if layout == 'b' else v | {'k2': 1.5 * v['k2']})("
        "fill(_products(arm, lift), known, _defaults(arm, layout, a2)))",
    ),
    Mutation("simionescu2015", "Guide.stiffness_11", "self.BF / (2 * self.CS)", "3.0"),
    Mutation("simionescu2015", "full", "(leg.load + guide.mass + link_2p / 2) * leg.B + leg.moment_2",
             "1.4 * ((leg.load + guide.mass + link_2p / 2) * leg.B + leg.moment_2)"),
    Mutation("simionescu2015", "best_springs", "_least_squares(on_axis[:, 1:3])",
             "1.3 * _least_squares(on_axis[:, 1:3])"),
    Mutation("cho2012", "_disk_spring", "vec3(B)", "vec3(1.3 * B)"),
)  # fmt: skip
LIN = (
    ("Builder.build", "a * up", "1.2 * a * up"),
    ("Builder.build", "C + b * towards", "C - b * towards"),
    ("moments", "mass + beyond[i]", "beyond[i]"),
    ("moments", "beyond[i] * link.tip", "0.9 * beyond[i] * link.tip"),
    ("Module.lumps", "(self.coupler, self.centre)", "(0.0, self.centre)"),
    ("Module.lumps", "(self.mass, self.com)", "(self.mass, 1.5 * self.com)"),
    ("mobility", "freedoms - modules", "freedoms"),
    ("mobility", "3 * spherical", "2 * spherical"),
    ("CubicMove.at", "3 - 2 * s", "3 - s"),
    ("design", "g * float(np.linalg.norm(whole[i].vector))", "1.1 * g * float(np.linalg.norm(whole[i].vector))"),
)
LENZO = (
    ("springs", "arm.l1 + values['b2'] * arm.x2", "arm.l1 - values['b2'] * arm.x2"),
    ("springs", "values['a2'] * up", "1.05 * values['a2'] * up"),
    ("springs", "arm.l1 + values['a12'] * arm.x2", "arm.l1 + 0.9 * values['a12'] * arm.x2"),
    ("springs", "values['b12'] * x1", "1.1 * values['b12'] * x1"),
    ("_products", "S2 / lift", "1.2 * S2 / lift"),
    ("_lift", "arm.chain.weight * link.along", "1.02 * arm.chain.weight * link.along"),
    ("_spring_1", "float(left @ _along(left, x1))", "0.5 * float(left @ _along(left, x1))"),
    ("fewest_springs", "2 if link.off_line(chain.near) else 1", "2"),
    ("springs", "_End(last, k, D, g * last.moment / (k * D))", "_End(last, k, D, 1.3 * g * last.moment / (k * D))"),
    ("_sign_of_a2", "_sign(lift)", "-_sign(lift)"),
)
SIMIONESCU = (
    ("Guide.stiffness_10", "self.CS * 2 * self.BF", "self.CS * self.BF"),
    ("Guide.stiffness_11", "self.link_9 + self.m3Q", "self.link_9"),
    ("TwoAxisRocker.coupling", "2 * ratio", "1.5 * ratio"),
    ("rocker_spring", "size + share * m7 * AV", "size"),
    (
        "DeltaLeg.actuator",
        "self.upper ** 2 + reach ** 2 - lower ** 2",
        "self.upper ** 2 + reach ** 2 - 0.9 * lower ** 2",
    ),
    ("DeltaRobot._bodies", "self.upper / 2", "self.upper / 3"),
    ("_springs", "size / AW", "1.1 * size / AW"),
    ("_left", "torques[..., 2:2 + len(p)] @ p", "0.9 * (torques[..., 2:2 + len(p)] @ p)"),
    ("Box.at", "-self.heights[1]", "-0.9 * self.heights[1]"),
    ("_Judged.peak", "found.argmax()", "found.argmin()"),
)
CHO = (
    ("_disk_spring", "cos(pi + phase)", "cos(phase)"),
    ("differential", "-gear_ratio", "gear_ratio"),
    ("differential", "[roll, -1.0]", "[roll, 1.0]"),
    ("stiffness", "weight / 2", "weight"),
    ("single_stiffness", "weight / (b * h)", "weight / (b + h)"),
    ("gravity_torque", "c[..., 0] * s[..., 1]", "c[..., 0] * c[..., 1]"),
    ("stretch_squared", "2 * b * h", "b * h"),
    ("disk_torque", "np.sin(theta_b)", "np.cos(theta_b)"),
    ("balanced_spring_energy", "k * (b ** 2 + h ** 2)", "2 * k * (b ** 2 + h ** 2)"),
    ("_cosines", "s.weight / 2", "s.weight / 1.9"),
)
LEE = (
    ("StiffnessBlocks.gravity", "-1j * arm.gravity", "-0.9j * arm.gravity"),
    ("vector", "-one.a / arm.lengths[one.i - 1]", "one.a / arm.lengths[one.i - 1]"),
    ("Equations.blocks", "self.arm.gravity * self.arm.moments[1:]", "1.1 * self.arm.gravity * self.arm.moments[1:]"),
    ("exchanged", "end == 'lower'", "end != 'lower'"),
    ("turned", "one.b * exp(1j * angle)", "one.b"),
    ("resized", "a * b", "a + b"),
    ("span", "k - i", "k - i + 1"),
    ("_rank", "len(layout) < n - 1", "len(layout) < n"),
    ("sign_failures", "beyond <= 0", "beyond >= 0"),
    ("upward", "1j if i == 1 else 1.0", "1.0"),
)
BY_PAPER = {"lin2010": LIN, "lenzo2017": LENZO, "simionescu2015": SIMIONESCU, "cho2012": CHO, "lee2014": LEE}
MUTATIONS = (*GROSS, *(Mutation(paper, *rest) for paper, found in BY_PAPER.items() for rest in found))
QUICK = (GROSS[0], GROSS[1], GROSS[5])  # a twentieth, made every time


def functions(tree: ast.Module) -> Iterator[tuple[str, ast.AST]]:
    """The functions of a module by their qualified names."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, node
        if isinstance(node, ast.ClassDef):
            yield from ((f"{node.name}.{one.name}", one) for one in node.body if isinstance(one, ast.FunctionDef))


class Replace(ast.NodeTransformer):
    """Expressions that read `old` become `new`; `count` says how many did."""

    def __init__(self, old: str, new: str) -> None:
        self.old, self.new, self.count = ast.unparse(ast.parse(old, mode="eval")), new, 0

    def visit(self, node: ast.AST) -> ast.AST:
        read = not isinstance(getattr(node, "ctx", None), (ast.Store, ast.Del))
        if isinstance(node, ast.expr) and read and ast.unparse(node) == self.old:
            self.count += 1
            return ast.parse(self.new, mode="eval").body
        return self.generic_visit(node)


def mutate(mutation: Mutation, folder: Path) -> None:
    """Make a mutation in a copy of the source."""
    made = 0
    for path in sorted((folder / "equipoise").rglob("*.py")):
        if f"def {mutation.function.rpartition('.')[2]}(" not in (text := path.read_text(encoding="utf-8")):
            continue
        tree = ast.parse(text)
        for name, function in functions(tree):
            if name == mutation.function:
                edit = Replace(mutation.old, mutation.new)
                edit.visit(function)
                made += edit.count
                if edit.count:
                    path.write_text(ast.unparse(ast.fix_missing_locations(tree)), encoding="utf-8")
    assert made == 1, f"{mutation}: '{mutation.old}' is there {made} times"


def reproduce(paper: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "equipoise", "reproduce", paper, "--json"],
        env={**os.environ, "PYTHONPATH": str(folder)}, capture_output=True, text=True, timeout=LIMIT, check=False,
    )  # fmt: skip


def test_there_are_the_six_and_ten_for_each_paper():
    assert len(set(MUTATIONS)) == len(MUTATIONS) == 6 + 10 * len(BY_PAPER)
    assert len(QUICK) >= len(MUTATIONS) // 20


@pytest.mark.deep
@pytest.mark.parametrize("mutation", some(MUTATIONS, here=QUICK), ids=str)
def test_a_broken_source_is_noticed(mutation, tmp_path):
    copy = tmp_path / "src"
    shutil.copytree(SOURCE, copy)
    mutate(mutation, copy)
    found = reproduce(mutation.paper, copy)
    assert found.returncode == 1, found.stderr[-2000:]
    assert f"FAILS: {mutation.paper}, " in found.stderr


@pytest.mark.deep
@pytest.mark.parametrize("paper", some(BY_PAPER, here=["lenzo2017"]))
def test_the_unbroken_source_passes(paper):
    found = reproduce(paper, SOURCE)
    assert found.returncode == 0, found.stderr[-2000:]
