"""Every hostile input ends with exit code 2 and one short message, in time, in little memory, and writes nothing."""

from __future__ import annotations

import os
import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from hostile import KINDS
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
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024 < MEGABYTES


def test_they_are_many():
    assert sum(1 for kind in KINDS for _ in kind()) >= 300
    names = [case.name for kind in KINDS for case in kind()]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_hostile(run, tmp_path, kind):
    """All of a kind, so that one fault does not hide the others."""
    if kind.__name__ in ("models", "tables", "options"):
        peer("mujoco"), peer("pyarrow")
    warm = YAML_OF_NOTHING(tmp_path)
    run("check", warm)  # imports are nobody's fault
    wrong = {}
    for number, case in enumerate(kind()):
        folder = tmp_path / str(number)
        folder.mkdir()
        command = case.make(folder)
        files = sorted(folder.iterdir())
        try:
            with watched():
                code, out, err = run(*command)
            assert (code, out) == (2, "")
            message = [line for line in err.splitlines() if not line.startswith(("warning: ", "note: "))]
            assert err.isascii() or all(c.isprintable() or c in "\n\t" for c in err)
            assert all(c.isprintable() or c in "\n\t" for c in err)
            assert "internal error" not in err
            assert len(message) <= LINES
            assert len(err) <= LONGEST
            assert sum(line.startswith("error: ") for line in message) <= 1
            assert message
            assert sorted(folder.iterdir()) == files
        except (AssertionError, TimeoutError, Warning) as error:
            wrong[case.name] = f"{type(error).__name__} {str(error)[:300]}"
    assert wrong == {}


def YAML_OF_NOTHING(folder: Path) -> Path:
    path = folder / "nothing.yaml"
    path.write_text('schema: 1\nname: nothing\ngravity: ["0 m/s^2", 0, -9.81]\n')
    return path
