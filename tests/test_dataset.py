"""The folder of a study: what is there, what is missing, and what is said of files that are spoilt."""

from __future__ import annotations

import json
import os
import resource
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from equipoise.model.errors import InputError
from equipoise.study.batch import pieces
from equipoise.study.dataset import Dataset
from equipoise.study.make import trial
from equipoise.study.plan import Plan
from equipoise.study.read import read

WAIT = {"run": {"wait": None}, "vary": {"wait.seconds": {"uniform": [0, 1e-9], "count": 60}}}


@pytest.fixture
def plan() -> Plan:
    return read(WAIT)


@pytest.fixture
def dataset(tmp_path: Path, plan: Plan) -> Dataset:
    return Dataset.begin(tmp_path / "out", plan, trial(plan).columns)


def write(dataset: Dataset, plan: Plan, *batches: tuple[int, int]) -> None:
    for batch in batches:
        dataset.write(batch, [plan.row(number) for number in range(*batch)])


def test_what_is_written_is_read(dataset, plan):
    write(dataset, plan, (10, 20), (0, 10))
    table = dataset.table()
    assert table.column("design").to_pylist() == list(range(20))
    assert table.column("seconds").type == table.column("waited").type == "double"
    assert table.column_names == list(dataset.columns)
    again = Dataset.open(dataset.folder)
    assert (again.hash, again.designs, again.missing()) == (plan.hash, 60, [(20, 60)])


@given(st.sets(st.integers(0, 59)), st.integers(1, 17))
def test_what_is_missing_is_the_rest(present, size):
    class Names(Dataset):
        def files(self):
            return {(number, number + 1): Path() for number in sorted(present)}

    missing = Names(Path(), "", 60, {}, {}).missing()
    cut = list(pieces(missing, size))
    assert sorted(number for batch in cut for number in range(*batch)) == sorted({*range(60)} - present)
    assert all(0 < stop - start <= size for start, stop in cut)


def test_a_query_sees_all_rows_and_says_what_is_wrong(dataset, plan):
    assert dataset.query("SELECT count(*) AS n FROM rows").to_pylist() == [{"n": 0}]
    write(dataset, plan, (0, 30), (30, 60))
    assert dataset.query("SELECT count(DISTINCT design) AS n FROM rows").to_pylist() == [{"n": 60}]
    for sql in ("SELECT waitd FROM rows", "SELEC"):
        with pytest.raises(InputError, match="--show"):
            dataset.query(sql)


@pytest.mark.parametrize("how", ["cut", "flipped", "empty", "text", "other rows"])
def test_a_spoilt_file_is_named_and_the_others_stay(dataset, plan, how):
    write(dataset, plan, (0, 30), (30, 60))
    first, second = dataset.files().values()
    good = second.read_bytes()
    data = first.read_bytes()
    half = len(data) // 3
    first.write_bytes({
        "cut": data[:half], "flipped": data[:half] + bytes([data[half] ^ 255]) + data[half + 1 :], "empty": b"",
        "text": b"hello", "other rows": good,
    }[how])  # fmt: skip
    if how == "other rows":
        write(dataset, plan, (0, 10))
        (dataset.folder / "rows" / "00000" / "0000000000-0000000010.parquet").replace(first)
    for look in (dataset.verify, dataset.table):
        with pytest.raises(InputError) as error:
            look()
        (fault,) = error.value.faults
        assert fault.file == str(first)
        assert "delete it, and --resume makes its designs again, 0 to 29" in fault.message
    assert second.read_bytes() == good
    first.unlink()
    assert dataset.missing() == [(0, 30)]


def test_a_spoilt_manifest(dataset):
    path = dataset.folder / "manifest.json"
    good = path.read_text()
    for text in (good[:50], "[]", good.replace('"hash": "', '"hash": "0'), good.replace('"wait"', '"wiat"')):
        path.write_text(text)
        with pytest.raises(InputError, match="is spoilt"):
            Dataset.open(dataset.folder)
    path.unlink()
    with pytest.raises(InputError, match="holds no study"):
        Dataset.open(dataset.folder)


def test_one_study_in_a_folder_at_a_time(dataset, plan):
    with dataset.held(), pytest.raises(InputError, match="a study is running in it already"), dataset.held():
        pass
    with pytest.raises(InputError, match="holds a study already: --resume"):
        Dataset.begin(dataset.folder, plan, {})


def test_a_folder_of_other_things_is_left_alone(tmp_path, plan):
    (tmp_path / "thesis.txt").write_text("years")
    with pytest.raises(InputError, match="is not empty"):
        Dataset.begin(tmp_path, plan, {})


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written_to(tmp_path, plan):
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="permission denied"):
        Dataset.begin(tmp_path / "out", plan, {})


def test_a_folder_that_cannot_be_made(tmp_path, plan):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        Dataset.begin(tmp_path / "file" / "out", plan, {})


def test_a_full_disk_leaves_nothing_half_written(dataset, plan):
    write(dataset, plan, (0, 30))
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(InputError, match="cannot be written: file too large"):
            write(dataset, plan, (30, 60))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert dataset.missing() == [(30, 60)]
    assert [path.name for path in (dataset.folder / "rows" / "00000").iterdir()] == [
        next(iter(dataset.files().values())).name
    ]
    dataset.verify()


def test_values_of_another_kind_are_left_out(dataset, plan):
    row = plan.row(0)
    dataset.write((0, 2), [row | {"waited": "long"}, row | {"waited": 3, "error": {"a": 1}}])
    assert dataset.table().column("waited").to_pylist() == [None, 3.0]
    assert dataset.table().column("error").to_pylist() == [None, json.dumps({"a": 1})]
