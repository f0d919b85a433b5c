"""One family of errors: what this package raises is an `EquipoiseError`, and a bad argument is a `ValueError` too."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import typer
from zoo import pendulum

import equipoise as eq
from equipoise.energy import NoFourierForm, Potential
from equipoise.energy.kernel import Kernel
from equipoise.model import errors
from equipoise.model.errors import EquipoiseError, InputError, UnsupportedError
from equipoise.model.units import quantity, share, to_si
from equipoise.study.workers import WorkerLost
from equipoise.synthesis.delta.legs import NotDelta

SOURCE = Path(eq.__file__).parent
ALONE = "proof/verify.py"
"""A program that shares nothing with the others, their errors included: what it raises ends as its own answer."""

PROTOCOLS = {
    ("__init__.py", AttributeError),  # what Python asks of a module's `__getattr__`
    ("cli", typer.Exit),  # an exit code, not an error
    ("study", WorkerLost),  # what workers and their driver tell each other
}


def makers() -> set[str]:
    """Names of the functions that make an error of the family: they are annotated to return one."""
    found = set()
    for tree in map(ast.parse, (path.read_text(encoding="utf-8") for path in SOURCE.rglob("*.py"))):
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and node.returns is not None:
                found |= {node.name} if ast.unparse(node.returns) in ("InputError", "EquipoiseError") else set()
    return found


def strangers() -> Iterator[str]:
    """Every `raise` of something else."""
    made = makers()
    for path in sorted(SOURCE.rglob("*.py")):
        inside = path.relative_to(SOURCE)
        name = ".".join(("equipoise", *inside.with_suffix("").parts)).removesuffix(".__init__")
        if inside.name == "__main__.py" or inside.as_posix() == ALONE:
            continue  # the one runs the command line when it is imported
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Raise) or node.exc is None:  # a bare raise passes on what came
                continue
            what = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
            if isinstance(node.exc, ast.Call) and ast.unparse(what).rpartition(".")[2] in made:
                continue
            if isinstance(what, ast.Attribute) and what.attr == "__context__":
                continue  # passes on what came too
            known = {**vars(errors), **vars(importlib.import_module(name))}  # some import them where they need them
            kind = eval(ast.unparse(what), known)
            if not issubclass(kind, Exception):
                continue  # a signal, not an error
            if not issubclass(kind, EquipoiseError) and not {(inside.parts[0], kind)} & PROTOCOLS:
                yield f"{inside}:{node.lineno} raises {kind.__name__}"


def test_nothing_else_is_raised() -> None:
    assert makers() >= {"error", "fault"}
    assert list(strangers()) == []


def test_what_the_file_does_not_cover_is_unsupported() -> None:
    assert issubclass(NoFourierForm, UnsupportedError)
    assert issubclass(NotDelta, UnsupportedError)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Potential(pendulum())(np.zeros((3, 2))), r"q has shape \(3, 2\), expected \(N, 1\)"),
        (lambda: Kernel.of(pendulum())(np.zeros((3, 2))), r"q has shape \(3, 2\), expected \(N, 1\)"),
        (lambda: Kernel.of(pendulum())(np.zeros((3, 1)), out=np.zeros((9, 3))), r"out has shape \(9, 3\)"),
        (lambda: Kernel.of(pendulum())(np.zeros((3, 1)), tier="numba"), "tier: there is no tier 'numba'"),  # type: ignore[arg-type]
        (lambda: to_si("5 kg", "length"), r"expected a number \[m\] or text with a unit of length \(m\), found '5 kg'"),
        (lambda: quantity("5 kg", "length", "radius"), r"^radius: expected a number \[m\]"),
        (lambda: quantity(None, "length", "regions", "arm"), r"^regions.arm: expected a number \[m\].*, found nothing"),
        (lambda: share("105%", "preload"), "^preload: expected a share from 0 to 1 such as 0.02 or 2%, found '105%'"),
        (lambda: share(True, "preload"), "^preload: expected a share from 0 to 1 .* found true"),
    ],
)
def test_bad_arguments_are_value_errors_of_the_family(call, message) -> None:
    with pytest.raises(ValueError, match=message) as error:
        call()
    assert isinstance(error.value, InputError)


@pytest.mark.parametrize("value", [0.15, np.float64(0.15), np.float32(0.15), "0.15", "150 mm", "15cm"])
def test_numbers_of_any_kind_and_texts_with_units(value) -> None:
    assert quantity(value, "length", "radius") == pytest.approx(0.15, rel=1e-7)


@pytest.mark.parametrize("value", [0.02, "0.02", "2%", "2 %", np.float32(0.02)])
def test_shares(value) -> None:
    assert share(value, "preload") == pytest.approx(0.02, rel=1e-7)
