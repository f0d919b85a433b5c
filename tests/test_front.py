"""The front door: one function for each command, found by its name, and results that print as the command does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import equipoise as eq
from equipoise.cli.app import app

PENDULUM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"
ONLY_A_COMMAND = {"demo", "made-up"}


def payload() -> eq.Payload:
    return eq.Payload.at(eq.load(PENDULUM), (0, 0.5), "arm", (0.3, 0, 0))


def commands() -> set[str]:
    import equipoise.cli  # registers them  # noqa: F401

    return {one.name or one.callback.__name__ for one in app.registered_commands if one.callback}


def test_every_command_is_a_function():
    missing = {name for name in commands() - ONLY_A_COMMAND if not callable(getattr(eq, name, None))}
    assert not missing


@pytest.mark.parametrize("name", ["hardware", "simulate", "report", "clearance", "reproduce"])
def test_a_package_does_not_take_the_place_of_a_command(name):
    script = f"import equipoise as eq, equipoise.{name}; assert callable(eq.{name}); from equipoise.{name} import *"
    subprocess.run([sys.executable, "-c", script], check=True)


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (lambda: eq.check(PENDULUM), ("EXACT: balanced in every pose", "shoulder spring: 196.2 N/m")),
        (lambda: eq.design(PENDULUM), ("leaves nothing of", "EXACT: balanced in every pose")),
        (lambda: eq.hardware(eq.check(PENDULUM)), ("bill of materials", "springs:")),
        (lambda: eq.tolerance(PENDULUM, builds=10, poses=10), ("10 builds",)),
        (lambda: eq.simulate(PENDULUM, seconds=0.1, poses=1, radius="50 mm"), ("STAYS", "control")),
        (lambda: eq.layouts(3), ("13,13",)),
        (
            lambda: eq.adjust(PENDULUM, payload()),
            ("EXACT at both ends",),
        ),
    ],
    ids=["check", "design", "hardware", "tolerance", "simulate", "layouts", "adjust"],
)
def test_a_result_prints_as_its_command_does(result, words):
    found = result()
    for word in words:
        assert word in str(found)
    assert isinstance(found.to_dict(), dict | list)


def test_reasons_and_pictures():
    assert eq.methods(PENDULUM)["planar"] == ()
    assert "no loops" in eq.methods(PENDULUM)["delta"][0]
    assert eq.plot(PENDULUM).axes
    assert eq.export(PENDULUM, "yaml").startswith("schema: 1")
    with pytest.raises(eq.InputError, match="did you mean 'mjcf'"):
        eq.export(PENDULUM, "mjfc")


def test_a_report_is_written(tmp_path):
    assert eq.report(PENDULUM, tmp_path / "arm.html", extras=()).good
    assert "EXACT" in (tmp_path / "arm.html").read_text("utf-8")


def test_what_is_not_there():
    with pytest.raises(AttributeError, match="no attribute 'desgin'"):
        _ = eq.desgin  # type: ignore[attr-defined]
