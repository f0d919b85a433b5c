"""Every hostile input ends with exit code 2 and one short message, in time, in little memory, and writes nothing."""

from __future__ import annotations

import json
import os
import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from hostile import KINDS, Case, contents, models, quantities, sizes, tables
from peers import peer

SECONDS, MEGABYTES = 2.0, 500.0
WAIT = 60  # [s] after which an input hangs, however busy the machine is
LONGEST, LINES = 12_000, 45  # of a message: twenty faults with their lines


@contextmanager
def watched() -> Iterator[None]:
    """Fails where the work takes too much processor time or memory, of children too; the alarm ends what hangs."""
    status = Path("/proc/self/status")

    def memory(key: str) -> float:
        line = next(line for line in status.read_text().splitlines() if line.startswith(key))
        return int(line.split()[1]) / 1024

    def stop(*_: object) -> None:
        raise TimeoutError(f"still busy after {WAIT} s")

    linux = status.exists()
    before = memory("VmRSS") if linux else 0.0
    if linux:
        Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    largest = _of_children()  # of other tests
    used = sum(os.times()[:4])
    old = signal.signal(signal.SIGALRM, stop)
    signal.alarm(WAIT)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, old)
    assert sum(os.times()[:4]) - used < SECONDS
    if linux:
        assert memory("VmHWM") - before < MEGABYTES
        # a child begins as a copy of this process, and that counts
        assert _of_children() <= max(largest, MEGABYTES, memory("VmHWM"))


def _of_children() -> float:
    """[MB] that the largest child so far has held."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024


def test_they_are_many():
    assert sum(1 for kind in KINDS for _ in kind()) >= 300
    names = [case.name for kind in KINDS for case in kind()]
    assert len(set(names)) == len(names)


SLOW = (contents, models, tables)  # megabytes, processes of their own, millions of rows
FEW = {quantities: 7}  # of every so many cases one in the fast tests: the fields of a kind share their reader


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in SLOW], ids=lambda kind: kind.__name__)
def test_hostile(run, tmp_path, kind):
    refused(run, tmp_path, islice(kind(), 0, None, FEW.get(kind, 1)))


@pytest.mark.slow(reason="megabytes to read, and a process of its own for every MJCF file")
@pytest.mark.parametrize("kind", [*SLOW, *FEW], ids=lambda kind: kind.__name__)
def test_hostile_and_long(run, tmp_path, kind):
    refused(run, tmp_path, kind())


@pytest.mark.parametrize("every", [pytest.param(1, marks=pytest.mark.slow(reason="two hundred verdicts")), 9])
def test_numbers_of_any_size_are_refused_or_computed(run, tmp_path, every):
    wrong = {}
    for number, case in enumerate(islice(sizes(), 0, None, every)):
        place = tmp_path / str(number)
        place.mkdir()
        code, out, err = run(*case.make(place))
        answer = code == 2 and not out and err.startswith(("error: ", "warning: "))
        if code in (0, 1):
            odd: list[str] = []  # NaN and the like
            json.loads(out, parse_constant=odd.append)
            answer = not odd
        if not answer or "internal error" in err:
            wrong[case.name] = f"{code} {err}"
    assert wrong == {}


def refused(run: Any, folder: Path, cases: Iterator[Case]) -> None:
    """All cases of a kind, so that one fault does not hide the others."""
    peer("mujoco")
    peer("pyarrow")
    nothing = folder / "nothing.yaml"
    nothing.write_text('schema: 1\nname: nothing\ngravity: ["0 m/s^2", 0, -9.81]\n')
    run("check", nothing)  # what is imported is no case's fault
    wrong = {}
    for number, case in enumerate(cases):
        place = folder / str(number)
        place.mkdir()
        command = case.make(place)
        files = sorted(place.iterdir())
        try:
            with watched():
                code, out, err = run(*command)
            assert (code, out) == (2, "")
            message = [line for line in err.splitlines() if not line.startswith(("warning: ", "note: "))]
            assert all(c.isprintable() or c in "\n\t" for c in err)
            assert "internal error" not in err
            assert len(message) <= LINES
            assert len(err) <= LONGEST
            assert sum(line.startswith("error: ") for line in message) <= 1
            assert message
            assert sorted(place.iterdir()) == files
        except (AssertionError, TimeoutError, Warning) as error:
            wrong[case.name] = f"{type(error).__name__} {str(error)[:300]}"
    assert wrong == {}
