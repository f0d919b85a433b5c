"""From batches to rows: whatever happens to workers, no row is lost and none is there twice."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from random import Random

import pytest

from equipoise.model.errors import EquipoiseError, InputError
from equipoise.study.batch import Batch, Rows
from equipoise.study.dataset import Dataset
from equipoise.study.drive import drive, duration
from equipoise.study.make import trial
from equipoise.study.plan import Plan
from equipoise.study.read import read
from equipoise.study.workers import WorkerLost

COUNT = 60


class Fake:
    """Workers that die as `dies` says, and work when they are waited for."""

    def __init__(self, plan: Plan, dies: Callable[[Batch], bool], room: int = 3) -> None:
        self.plan, self.dies, self.room = plan, dies, room
        self.given: list[Batch] = []
        self.batches: dict[Future[Rows], Batch] = {}
        self.most, self.closed = 0, False

    def submit(self, batch: Batch) -> Future[Rows]:
        future: Future[Rows] = Future()
        self.given.append(batch)
        self.batches[future] = batch
        self.most = max(self.most, len(self.batches))
        future.set_result([])
        return future

    def taken(self, future: Future[Rows]) -> Rows:
        batch = self.batches.pop(future)
        if self.dies(batch):
            raise WorkerLost
        return [self.plan.row(number) for number in range(*batch)]

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def plan() -> Plan:
    return read({"run": {"wait": None}, "vary": {"wait.seconds": {"uniform": [0, 1e-9], "count": COUNT}}})


@pytest.fixture
def dataset(tmp_path: Path, plan: Plan) -> Dataset:
    return Dataset.begin(tmp_path / "out", plan, trial(plan).columns)


def rows(dataset: Dataset) -> list[tuple[int, str]]:
    table = dataset.table()
    return list(zip(table.column("design").to_pylist(), table.column("status").to_pylist(), strict=True))


def ok(*but: int) -> list[tuple[int, str]]:
    return [(number, "failed" if number in but else "ok") for number in range(COUNT)]


def never(batch: Batch) -> bool:
    return False


def test_all_rows_are_written_and_few_batches_are_on_their_way(dataset, plan):
    workers = Fake(plan, never)
    said = list[tuple[str, float]]()
    drive(plan, dataset, workers, 7, lambda what, share: said.append((what, share)))
    assert rows(dataset) == ok()
    assert (workers.most, workers.closed) == (3, True)
    assert len(workers.given) == 9
    assert said[0] == ("0 of 60 designs", 0.0)
    assert " a second, " in said[-1][0]


def test_only_what_is_missing_is_made(dataset, plan):
    dataset.write((7, 30), [plan.row(number) for number in range(7, 30)])
    workers = Fake(plan, never)
    drive(plan, dataset, workers, 10, lambda *_: None)
    assert rows(dataset) == ok()
    assert sorted(workers.given) == [(0, 7), (30, 40), (40, 50), (50, 60)]


@pytest.mark.parametrize("seed", range(5))
def test_workers_that_die_now_and_then(dataset, plan, seed):
    rng = Random(seed)
    drive(plan, dataset, Fake(plan, lambda batch: rng.random() < 0.2 and batch[1] - batch[0] > 1), 8, lambda *_: None)
    assert rows(dataset) == ok()


def test_a_design_that_kills_its_worker_is_a_row_and_takes_no_other_with_it(dataset, plan):
    workers = Fake(plan, lambda batch: batch[0] <= 13 < batch[1] or batch[0] <= 59 < batch[1])
    drive(plan, dataset, workers, 20, lambda *_: None)
    assert rows(dataset) == ok(13, 59)
    assert dataset.table().column("error").to_pylist()[13] == (
        "the process that worked on it died, 2 times: is there enough memory?"
    )
    assert len(workers.given) < 30


def test_it_gives_up_where_every_worker_dies(dataset, plan):
    with pytest.raises(EquipoiseError, match="die one after the other"):
        drive(plan, dataset, Fake(plan, lambda batch: True), 20, lambda *_: None)
    assert all(status == "failed" for _, status in rows(dataset))


@pytest.mark.parametrize("end", [KeyboardInterrupt, SystemExit, EquipoiseError])
def test_what_is_done_is_written_whatever_ends_it(dataset, plan, end):
    workers, count = Fake(plan, never), 0

    def stop(what: str, share: float) -> None:
        nonlocal count
        count += 1
        if count == 3:
            raise end

    with pytest.raises(end):
        drive(plan, dataset, workers, 5, stop)
    assert workers.closed
    done = [number for number, _ in rows(dataset)]
    assert len(done) == len(set(done)) == 5 * len(workers.given)
    drive(plan, dataset, Fake(plan, never), 9, lambda *_: None)
    assert rows(dataset) == ok()


def test_a_full_disk_ends_it_with_what_was_written(dataset, plan, monkeypatch):
    whole = Dataset.write

    def full(self: Dataset, batch: Batch, found: Rows) -> None:
        if batch[0] >= 30:
            raise InputError("cannot be written: no space left on device")
        whole(self, batch, found)

    monkeypatch.setattr(Dataset, "write", full)
    workers = Fake(plan, never)
    with pytest.raises(InputError, match="no space left"):
        drive(plan, dataset, workers, 10, lambda *_: None)
    assert workers.closed
    assert [number for number, _ in rows(dataset)] == list(range(30))


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.04, "0.04 s"), (59, "59 s"), (130, "2 min"), (7300, "2 h"), (3e5, "3 days"), (119, "119 s")],
)
def test_times_as_people_say_them(seconds, text):
    assert duration(seconds) == text
