"""The folder of a study: a manifest, and the rows as Parquet files, one for each batch, written whole or not at all.

The name of a file says which designs are in it: what is missing can be told after any end, and nothing is there twice.
"""

from __future__ import annotations

import io
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._version import __version__
from ..io.files import check_writable, make_folder, read_text, write_bytes, write_text
from ..model.errors import Fault, InputError
from .batch import Batch, Rows
from .plan import Plan

if TYPE_CHECKING:
    import pyarrow as pa

try:
    import fcntl
except ImportError:  # Windows: two studies in one folder are not told apart
    fcntl = None

MANIFEST, ROWS, LOCK = "manifest.json", "rows", ".lock"
SCHEMA = 1
TOGETHER = 100_000  # designs whose files share a folder
_NAME = re.compile(r"(\d+)-(\d+)\.parquet")
MISSING = "a study needs pyarrow and duckdb: pip install 'equipoise[study]'"


@dataclass(frozen=True)
class Dataset:
    """A folder that holds a study.

    Attributes:
        hash: of the study.
        designs: how many it has.
        columns: name -> type, in their order.
        document: the study itself.
    """

    folder: Path
    hash: str
    designs: int
    columns: Mapping[str, str]
    document: Mapping[str, Any]

    @staticmethod
    def begin(folder: Path, plan: Plan, columns: Mapping[str, str]) -> Dataset:
        """A new one.

        Raises:
            InputError: the folder holds a study already, or cannot be written to.
        """
        check_free(folder)
        make_folder(folder / ROWS)
        found = Dataset(folder, plan.hash, len(plan), columns, plan.document)
        manifest = {
            "schema": SCHEMA,
            "program": f"equipoise {__version__}",
            "hash": found.hash,
            "designs": found.designs,
            "columns": dict(columns),
            "study": plan.document,
        }
        write_text(folder / MANIFEST, json.dumps(manifest, indent=1) + "\n")
        return found

    @staticmethod
    def open(folder: Path) -> Dataset:
        """The one that is there.

        Raises:
            InputError: there is none, or its manifest cannot be read.
        """
        path = folder / MANIFEST
        if not path.is_file():
            raise InputError(Fault((), "holds no study: there is no manifest.json in it", file=str(folder)))
        try:
            m = json.loads(read_text(path))
            found = Dataset(folder, m["hash"], m["designs"], m["columns"], m["study"])
            whole = Plan.of(found.document).hash == found.hash
        except (ValueError, KeyError, TypeError):
            whole, found = False, None
        if found is None or not whole:
            message = "is spoilt: take it from a copy, or run the study anew in another folder"
            raise InputError(Fault((), message, file=str(path)))
        return found

    @contextmanager
    def held(self) -> Iterator[None]:
        """Nobody else writes into the folder meanwhile.

        Raises:
            InputError: somebody does.
        """
        if fcntl is None:
            yield
            return
        with open(self.folder / LOCK, "wb") as stream:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise InputError(Fault((), "a study is running in it already", file=str(self.folder))) from None
            except OSError:  # a file system without locks
                pass
            yield

    def files(self) -> dict[Batch, Path]:
        """The batches that are there, in their order."""
        found = {}
        for path in (self.folder / ROWS).glob("*/*.parquet"):
            if name := _NAME.fullmatch(path.name):
                found[int(name[1]), int(name[2])] = path
        return dict(sorted(found.items()))

    def missing(self) -> list[Batch]:
        """The intervals of designs that have no rows."""
        found, next_ = [], 0
        for start, stop in self.files():
            if start > next_:
                found.append((next_, start))
            next_ = max(next_, stop)
        return [*found, (next_, self.designs)] if next_ < self.designs else found

    def verify(self) -> None:
        """Read every file.

        Raises:
            InputError: with a fault for each that is spoilt.
        """
        faults = list(self._spoilt())
        if faults:
            raise InputError(faults)

    def write(self, batch: Batch, rows: Rows) -> None:
        """Add the rows of a batch.

        Raises:
            InputError: they cannot be written; nothing of them is there then.
        """
        import pyarrow.parquet as pq

        start, stop = batch
        path = self.folder / ROWS / f"{start // TOGETHER:05d}" / f"{start:010d}-{stop:010d}.parquet"
        make_folder(path.parent)
        buffer = io.BytesIO()
        pq.write_table(as_table(rows, self.columns), buffer, compression="zstd", write_page_checksum=True)
        write_bytes(path, buffer.getvalue())

    def table(self) -> pa.Table:
        """All rows, in the order of the designs.

        Raises:
            InputError: a file is spoilt.
        """
        import pyarrow as pa

        tables = [_read(path, batch) for batch, path in self.files().items()]
        return pa.concat_tables(tables) if tables else as_table([], self.columns)

    def query(self, sql: str) -> pa.Table:
        """What a query of the table ``rows`` gives.

        Raises:
            InputError: the query is wrong, or a file is spoilt.
        """
        import duckdb

        with duckdb.connect() as connection:
            if self.files():
                pattern = str(self.folder / ROWS / "*" / "*.parquet").replace("'", "''")
                connection.execute(f"CREATE VIEW rows AS SELECT * FROM read_parquet('{pattern}')")
            else:
                connection.register("rows", as_table([], self.columns))
            try:
                found = connection.sql(sql)
                if found is not None:
                    return found.to_arrow_table()
                message = "gives no rows: ask for some with SELECT ... FROM rows"
            except duckdb.Error as error:
                self.verify()
                message = str(error).split("\n\n")[0].split("\nLINE")[0]
            raise InputError(Fault(("--show",), message, tuple(self.columns)))

    def _spoilt(self) -> Iterator[Fault]:
        for batch, path in self.files().items():
            try:
                _read(path, batch)
            except InputError as error:
                yield from error.faults


def check_free(folder: Path) -> None:
    """Whether a new study could be written into a folder, asked before long work.

    Raises:
        InputError: it holds one already, or it cannot be made or written to.
    """
    if (folder / MANIFEST).exists():
        raise InputError(Fault((), "holds a study already: --resume goes on with it", file=str(folder)))
    if folder.is_dir() and any(path.name != LOCK for path in folder.iterdir()):
        raise InputError(Fault((), "is not empty: a study gets a folder of its own", file=str(folder)))
    make_folder(folder)
    check_writable(folder / MANIFEST)


def as_table(rows: Iterable[Mapping[str, Any]], columns: Mapping[str, str]) -> pa.Table:
    """Rows as a table of these columns; a value of another kind than its column's is left out."""
    try:
        import pyarrow as pa
    except ImportError:
        raise InputError(MISSING) from None
    rows = list(rows)
    types = {name: pa.type_for_alias(kind) for name, kind in columns.items()}
    arrays = [pa.array([_fitting(row.get(name), columns[name]) for row in rows], kind) for name, kind in types.items()]
    return pa.table(arrays, names=list(types))


def _fitting(value: Any, kind: str) -> Any:
    """The value as a column of this kind takes it."""
    if value is None:
        return None
    with suppress(TypeError, ValueError, OverflowError):
        if kind == "double":
            return float(value)
        if kind == "int64":
            return int(value)
        if kind == "bool":
            return bool(value)
        return value if isinstance(value, str) else json.dumps(value)
    return None


def _read(path: Path, batch: Batch) -> pa.Table:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        found = pq.ParquetFile(path, page_checksum_verification=True).read()
    except (pa.ArrowException, OSError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(_fault(path, batch, f"cannot be read ({reason[:100]})")) from None
    if found.num_rows != batch[1] - batch[0]:
        raise InputError(_fault(path, batch, f"has {found.num_rows} rows, not {batch[1] - batch[0]}"))
    return found


def _fault(path: Path, batch: Batch, what: str) -> Fault:
    again = f"delete it, and --resume makes its designs again, {batch[0]} to {batch[1] - 1}"
    return Fault((), f"{what}: {again}", file=os.fspath(path))


def needed() -> None:
    """Whether what reads and writes the rows is installed.

    Raises:
        InputError: it is not.
    """
    try:
        import duckdb  # noqa: F401
        import pyarrow  # noqa: F401
    except ImportError:
        raise InputError(MISSING) from None
