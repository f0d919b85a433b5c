"""Rows of text from CSV files, and columns of numbers and text from Parquet files, within limits."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping
from io import BytesIO, StringIO
from typing import Any

from ..model.errors import Fault, InputError
from .files import read_bytes, read_text

SEPARATORS = ",;\t"
LONGEST = 1000  # characters of a cell


def csv_rows(path: str | os.PathLike[str], most: int, separators: str = SEPARATORS) -> list[tuple[int, list[str]]]:
    """The rows of a CSV file that are not empty, the header first, each with its line; cells without outer spaces.

    Args:
        most: rows below the header.
        separators: the one that the first line has most of counts.

    Raises:
        InputError: the file cannot be read, has no row or too many, or is no table.
    """
    name, found = os.fspath(path), []
    text = read_text(path).replace("\r\n", "\n").replace("\r", "\n")
    first = text.lstrip("\n").partition("\n")[0]
    lines = csv.reader(StringIO(text), delimiter=max(separators, key=first.count), skipinitialspace=True)
    try:
        for row in lines:
            cells = [cell.strip() for cell in row]
            if any(cells):
                found.append((lines.line_num, cells))
            if len(found) > most + 1:
                raise InputError(Fault((), f"has more than {most:,} rows", file=name))
            if max(map(len, cells), default=0) > LONGEST:
                message = f"is no table: a cell of more than {LONGEST:,} characters"
                raise InputError(Fault((), message, file=name, line=lines.line_num))
    except csv.Error as error:
        raise InputError(Fault((), f"is no table: {error}", file=name, line=lines.line_num)) from None
    if not found:
        raise InputError(Fault((), "has no rows", file=name))
    return found


def heading(text: str) -> tuple[str, str]:
    """The name at the head of a column, and the unit in brackets after it: ``rate [N/mm]``."""
    name, bracket, unit = text.strip().rpartition("[")
    return (name.strip(), unit.removesuffix("]").strip()) if bracket and unit.endswith("]") else (text.strip(), "")


def parquet_columns(path: str | os.PathLike[str], most: int) -> Mapping[str, list[Any]]:
    """The columns of a Parquet file that hold numbers or text; dates, lists and the like are left out.

    Raises:
        InputError: pyarrow is not installed, the file cannot be read, is no Parquet file, or has too many rows.
    """
    name, data = os.fspath(path), BytesIO(read_bytes(path))
    arrow, parquet = pyarrow()
    try:
        file = parquet.ParquetFile(data)
        if file.metadata.num_rows > most:
            message = f"has {file.metadata.num_rows:,} rows, at most {most:,} are read"
            raise InputError(Fault((), message, file=name))
        text = [f.name for f in file.schema_arrow if _is_text(arrow, f.type)]
        plain = [f.name for f in file.schema_arrow if arrow.types.is_integer(f.type) or arrow.types.is_floating(f.type)]
        file = parquet.ParquetFile(data, read_dictionary=text)  # a few letters can stand for gigabytes of the same text
        table = file.read(columns=[*text, *plain])
        for column in text:
            for chunk in table.column(column).chunks:
                longest = arrow.compute.max(arrow.compute.binary_length(chunk.dictionary)).as_py() or 0
                if longest > LONGEST:
                    message = f"column '{column}' has a cell of more than {LONGEST:,} characters"
                    raise InputError(Fault((), message, file=name))
        columns = table.to_pydict()
    except InputError:
        raise
    except (OSError, ValueError, arrow.ArrowException) as error:
        first = (str(error).splitlines() or [""])[0]
        raise InputError(Fault((), f"is no Parquet file: {first}", file=name)) from None
    return {f.name: columns[f.name] for f in file.schema_arrow if f.name in columns}


def _is_text(arrow: Any, kind: Any) -> bool:
    if arrow.types.is_dictionary(kind):
        kind = kind.value_type
    return arrow.types.is_string(kind) or arrow.types.is_large_string(kind)


def parquet_bytes(columns: Mapping[str, list[Any]]) -> bytes:
    """A Parquet file of these columns.

    Raises:
        InputError: pyarrow is not installed.
    """
    arrow, parquet = pyarrow()
    data = BytesIO()
    parquet.write_table(arrow.table(dict(columns)), data)
    return data.getvalue()


def pyarrow() -> tuple[Any, Any]:
    """The package, and its module for Parquet files.

    Raises:
        InputError: it is not installed.
    """
    try:
        import pyarrow
        import pyarrow.compute
        from pyarrow import parquet
    except ImportError:
        raise InputError("a Parquet file needs pyarrow: pip install 'equipoise[study]'") from None
    return pyarrow, parquet
