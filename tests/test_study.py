"""The command `study`, with real processes, real clusters and real kills."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import equipoise as eq
from equipoise.study import cluster
from equipoise.study.dataset import Dataset

PENDULUM = Path(__file__).parents[1] / "examples" / "mechanisms" / "pendulum.yaml"
SPAWNS = "starts processes that import everything"


def write(folder: Path, wait: float, designs: int) -> Path:
    path = folder / "s.yaml"
    path.write_text(f"run: {{wait: {{}}}}\nvary:\n  wait.seconds: {{uniform: [{wait}, {wait}], count: {designs}}}\n")
    return path


def command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "equipoise", "study", *map(str, arguments)]


@contextmanager
def started(*arguments: object) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(command(*arguments), stderr=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


def until_files(folder: Path, count: int) -> None:
    for _ in range(1200):
        if len(list(folder.glob("rows/*/*.parquet"))) >= count:
            return
        time.sleep(0.05)
    raise AssertionError("nothing is written")


def children(of: int) -> list[int]:
    """The processes that a process has started and that work, the tracker of resources apart."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
            text = (path.parent / "cmdline").read_text()
        except OSError:
            continue
        if int(fields[1]) == of and "spawn_main" in text:
            found.append(int(path.parent.name))
    return found


def each_once(folder: Path, count: int) -> None:
    sql = (
        "SELECT count(*) AS rows, count(DISTINCT design) AS designs, min(design) AS low, max(design) AS high FROM rows"
    )
    (found,) = Dataset.open(folder).query(sql).to_pylist()
    assert found == {"rows": count, "designs": count, "low": 0, "high": count - 1}


def test_from_the_file_to_rows_a_plot_and_a_design(tmp_path, run):
    study, folder = tmp_path / "arms.yaml", tmp_path / "arms"
    study.write_text(
        f"mechanism: {PENDULUM}\nvary: {{bodies.arm.mass: [1, 2, -1], span: [1]}}\n"
        "run: {design: {springs: 1}}\nrecord: [residual, bound, springs]\n"
    )
    code, out, err = run("study", study, "-o", folder, "--workers", 1, "--json")
    assert code == 0, err
    facts = json.loads(out)
    assert (facts["designs"], facts["status"]) == (3, {"ok": 2, "failed": 1})
    each_once(folder, 3)
    code, out, _ = run("study", folder, "--show", "SELECT design, residual < 1e-9 AS good FROM rows", "--json")
    assert sorted(json.loads(out), key=lambda row: row["design"]) == [
        {"design": 0, "good": True}, {"design": 1, "good": True}, {"design": 2, "good": None},
    ]  # fmt: skip
    assert run("study", folder, "--plot", "bodies.arm.mass", "residual", "-o", tmp_path / "a.svg")[0] == 0
    assert (tmp_path / "a.svg").read_text().startswith("<?xml")
    assert run("study", folder, "--export", 1, "-o", tmp_path / "d.yaml")[0] == 0
    design = eq.load(tmp_path / "d.yaml")
    assert (design.bodies[0].mass, len(design.springs), eq.check(design).exact) == (2, 1, True)
    assert run("study", study, "-o", folder)[2].count("--resume goes on with it") == 1
    code, out, _ = run("study", folder, "--resume")
    assert (code, out) == (0, "arms: 3 rows, 2 ok, 1 failed\n")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["s.yaml"], "--output: missing"),
        (["s.yaml", "-o", "s.yaml"], "cannot be made: "),
        (["s.yaml", "-o", "out", "--resume"], "holds no study"),
        (["s.yaml", "--show", "SELECT 1"], "looks at a study that was run"),
        ([".", "--show", "SELECT 1"], "holds no study"),
        (["."], "say what to do: --show"),
        (["none.yaml", "--dry-run"], "no such file"),
        (
            ["s.yaml", "-o", "out", "--scheduler", "tcp://127.0.0.1:1"],
            "no Dask scheduler answers at 'tcp://127.0.0.1:1'",
        ),
    ],
)
def test_mistakes(tmp_path, monkeypatch, run, arguments, message):
    write(tmp_path, 0, 3)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cluster, "ANSWER", 0.3)
    code, _, err = run("study", *arguments)
    assert code == 2
    assert message in err
    assert not list(tmp_path.glob("out/rows/*/*"))


def test_python_returns_the_rows(tmp_path):
    table = eq.study({"run": {"wait": None}, "vary": {"wait.seconds": [0.0, 0.0]}}, workers=1)
    assert table.column("design").to_pylist() == [0, 1]
    assert table.column("status").to_pylist() == ["ok", "ok"]


@pytest.mark.slow(reason=SPAWNS)
def test_a_worker_that_is_killed_loses_nothing(tmp_path):
    study, folder = write(tmp_path, 0.01, 600), tmp_path / "out"
    with started(study, "-o", folder, "--workers", 2, "--batch", 50) as process:
        until_files(folder, 2)
        for child in children(process.pid):
            os.kill(child, signal.SIGKILL)
        assert process.wait(120) == 0
    each_once(folder, 600)


@pytest.mark.slow(reason=SPAWNS)
@pytest.mark.parametrize(("sent", "code"), [(signal.SIGKILL, -9), (signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_study_that_is_ended_goes_on_later(tmp_path, run, sent, code):
    study, folder = write(tmp_path, 0.01, 600), tmp_path / "out"
    with started(study, "-o", folder, "--workers", 2, "--batch", 20) as process:
        until_files(folder, 2)
        workers = children(process.pid)
        process.send_signal(sent)
        assert process.wait(20) == code
        assert process.stderr is not None
        assert code < 0 or "rows are in" in process.stderr.read()
    assert workers
    for _ in range(200):
        if not any(Path(f"/proc/{number}").exists() for number in workers):
            break
        time.sleep(0.05)
    assert not any(Path(f"/proc/{number}").exists() for number in workers)  # they end with the study
    written = len(Dataset.open(folder).table())
    assert 40 <= written < 600
    assert run("study", study, "-o", folder, "--resume", "--workers", 1, "--batch", 200)[0] == 0
    each_once(folder, 600)
