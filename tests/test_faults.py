"""Killed, stopped, without room or without a reader: nothing half-written, one last line, the usual exit code."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO

import pytest

from equipoise.io import files

ROOT = Path(__file__).parents[1]
ARM = ROOT / "examples" / "mechanisms" / "lin2010_balanced.yaml"
UR5 = ROOT / "examples" / "robots" / "ur5.urdf"
PENDULUM = ROOT / "examples" / "mechanisms" / "pendulum.yaml"
BALANCED = str(ARM)

WRITERS: dict[str, tuple[str, ...]] = {
    "design": ("design", str(UR5), "--span", "1", "--springs", "1", "-o", "OUT.yaml"),
    "plot": ("tolerance", BALANCED, "--builds", "100", "--poses", "10", "--plot", "OUT.svg"),
    "export": ("export", BALANCED, "--to", "yaml", "-o", "OUT.yaml"),
    "drawing": ("export", BALANCED, "--to", "svg", "-o", "OUT.svg"),
    "model": ("export", BALANCED, "--to", "mjcf", "-o", "OUT.xml"),
    "report": ("report", BALANCED, "--with", "none", "--samples", "64", "-o", "OUT.html"),
    "layouts": ("layouts", "3", "-o", "OUT"),
    "reproduce": ("reproduce", "lenzo2017", "-o", "OUT"),
    "hardware": ("hardware", str(PENDULUM), "-o", "OUT.csv"),
    "list": ("made-up", "--count", "500", "-o", "OUT.csv"),
    "columns": ("made-up", "--count", "500", "-o", "OUT.parquet"),
}
"""Every command that writes, with what it writes as OUT."""
FAST = ("export", "list", "columns")


def command(name: str) -> list[str]:
    return [sys.executable, "-m", "equipoise", *WRITERS[name]]


def ended(name: str, folder: Path, before: Callable[[], None] | None = None) -> tuple[int, str]:
    """The exit code and the last line of a command in a folder; `before` limits its process."""
    done = subprocess.run(command(name), cwd=folder, capture_output=True, text=True, preexec_fn=before, timeout=300)
    assert "Traceback" not in done.stderr
    return done.returncode, (done.stderr.splitlines() or [""])[-1]


def whole(folder: Path) -> bool:
    """Whether every file there is complete, and none is a temporary one."""
    for path in folder.rglob("*"):
        if path.is_file():
            data = path.read_bytes()
            ends = {".yaml": b"\n", ".svg": b"</svg>", ".xml": b"</mujoco>", ".html": b"</html>", ".csv": b"\n"}
            end = ends.get(path.suffix, b"")
            if path.name.endswith(files.OURS) or not data.rstrip(b"\n" if end != b"\n" else b"").endswith(end):
                return False
    return True


def names(only: Sequence[str]) -> list[object]:
    """All writers; those that are not in `only` are slow."""
    slow = pytest.mark.slow(reason="starts the command anew for every fault")
    return [pytest.param(name, marks=() if name in only else slow) for name in WRITERS]


@pytest.mark.parametrize("name", names(FAST))
def test_a_file_that_may_not_grow(name, tmp_path):
    """As on a full disk."""
    code, last = ended(name, tmp_path, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64)))
    assert code == 2
    assert last.startswith("error: ")
    assert "file too large" in last
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


@pytest.mark.parametrize("name", names(FAST))
def test_a_full_disk(name, tmp_path):
    """A file system of a few kilobytes; skipped where nobody may mount one."""
    place = tmp_path / "small"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=4k", "tmpfs", str(place)]
    if os.geteuid() or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("no small file system can be mounted here")
    try:
        (place / "rest").write_bytes(b"x" * 4096)
        code, last = ended(name, place)
        assert code == 2
        assert last.startswith("error: ")
        assert "no space left" in last
        assert [path.name for path in place.rglob("*") if path.is_file()] == ["rest"]
    finally:
        subprocess.run(["umount", str(place)], check=True)


@pytest.mark.parametrize("name", names(FAST))
def test_a_place_that_is_no_folder(name, tmp_path):
    (tmp_path / "file").write_text("")
    changed = [part.replace("OUT", "file/OUT") for part in command(name)]
    done = subprocess.run(changed, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("error: file/OUT")
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_command_that_is_told_to_stop(number, tmp_path):
    searching = [sys.executable, "-m", "equipoise", "layouts", "6", "-o", "OUT"]

    def heard() -> None:  # what a shell starts in the background ignores SIGINT
        signal.signal(number, signal.SIG_DFL)

    pipe = subprocess.PIPE
    child = subprocess.Popen(searching, cwd=tmp_path, stderr=pipe, stdout=pipe, text=True, preexec_fn=heard)
    assert child.stderr is not None
    assert child.stderr.readline().startswith("note: ")  # it is at work
    child.send_signal(number)
    out, err = child.communicate(timeout=120)
    assert (child.returncode, out) == (128 + number, "")
    assert err == {signal.SIGINT: "interrupted\n", signal.SIGTERM: "terminated\n"}[number]
    assert os.listdir(tmp_path) == []


STUCK = """
import os, sys
from equipoise.io import files
def replace(*_):
    print("written", flush=True)
    sys.stdin.read()
os.replace = replace
files.write_text("OUT.yaml", "a" * 10_000)
"""  # a run that waits between its temporary file and the end


def stuck(folder: Path) -> subprocess.Popen[str]:
    child = subprocess.Popen(
        [sys.executable, "-c", STUCK], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "written\n"
    return child


def test_the_next_run_clears_what_a_killed_one_has_left(tmp_path):
    child = stuck(tmp_path)
    child.kill()
    child.communicate()
    (left,) = tmp_path.iterdir()
    assert left.name.endswith(files.OURS)
    files.write_text(tmp_path / "other.yaml", "text")
    assert os.listdir(tmp_path) == ["other.yaml"]


def test_the_next_run_leaves_what_another_is_writing(tmp_path):
    child = stuck(tmp_path)
    files.write_text(tmp_path / "other.yaml", "text")
    assert len(list(tmp_path.iterdir())) == 2
    child.communicate("")
    files.write_text(tmp_path / "other.yaml", "text")
    assert os.listdir(tmp_path) == ["other.yaml"]


def test_files_of_others_stay(tmp_path):
    for name in (".other.tmp", "a.equipoise.tmp", ".a.yaml.x.tmp"):
        (tmp_path / name).write_text("")
    files.write_text(tmp_path / "a.yaml", "text")
    assert len(list(tmp_path.iterdir())) == 4


@pytest.mark.slow(reason="starts and kills the command again and again")
@pytest.mark.parametrize("name", ["export", "layouts", "list"])
def test_killed_at_any_moment(name, tmp_path):
    """What is there after a kill is whole, and the next run leaves nothing else."""
    begun = time.monotonic()
    ended(name, tmp_path)
    lasts = time.monotonic() - begun
    for k in range(12):
        child = subprocess.Popen(command(name), cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(lasts * (0.4 + 0.05 * k))
        child.kill()
        child.wait()
        for path in tmp_path.rglob(f"*{files.OURS}"):
            path.rename(path.with_name(path.name + ".seen"))  # so that `whole` speaks of the others
        assert whole(tmp_path)
        for path in tmp_path.rglob("*.seen"):
            path.rename(path.with_name(path.name.removesuffix(".seen")))
    assert ended(name, tmp_path)[0] == 0
    assert whole(tmp_path)


@pytest.mark.slow(reason="five processes at once")
def test_runs_at_the_same_time_write_whole_files(tmp_path):
    children = [subprocess.Popen(command("export"), cwd=tmp_path, stderr=subprocess.DEVNULL) for _ in range(5)]
    assert [child.wait(300) for child in children] == [0] * 5
    assert os.listdir(tmp_path) == ["OUT.yaml"]
    assert whole(tmp_path)


def piped(arguments: Sequence[str], stdout: IO[str]) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "equipoise", *arguments]
    return subprocess.run(command, stdout=stdout, stderr=subprocess.PIPE, text=True, timeout=300)


def test_a_reader_that_has_gone(tmp_path):
    reading, writing = os.pipe()
    os.close(reading)
    with open(writing, "w") as stream:
        done = piped(["export", BALANCED, "--to", "yaml"], stdout=stream)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("arguments", [["export", BALANCED, "--to", "yaml"], ["made-up", "-o", "/dev/full"]])
def test_standard_output_without_room(arguments):
    with open("/dev/full", "w") as full:
        done = piped(arguments, stdout=full)
    assert done.returncode == 2
    assert done.stderr.endswith("no space left on device\n")
    assert len(done.stderr.splitlines()) == 1


CACHED = """
import sys
import numpy as np, equipoise as eq
from equipoise.energy.kernel.kernel import Kernel
m = eq.load(sys.argv[1])
print(float(Kernel(m)(np.zeros((10, 6)), tier="generic").energy[0]))
"""


@pytest.mark.slow(reason="compiles the kernel again and again")
def test_a_cache_that_is_broken_or_full(tmp_path):
    """The answer is the same, whatever has become of the compiled kernel."""

    def answer(room: int | None = None) -> str:
        limit = None if room is None else lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
        place = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
        code = [sys.executable, "-c", CACHED, BALANCED]
        return subprocess.run(code, env=place, capture_output=True, text=True, check=True, preexec_fn=limit).stdout

    right = answer(2048)  # the disk is full from the beginning
    assert json.loads(right) > 0
    assert answer() == right
    kept = [path for path in tmp_path.rglob("*") if path.suffix in (".nbi", ".nbc")]
    assert kept
    for spoil in (lambda data: data[:100], lambda _: b"garbage", lambda _: b"", lambda data: data[:-1] + b"x"):
        for path in kept:
            if path.exists():
                path.write_bytes(spoil(path.read_bytes()))
        assert answer() == right
