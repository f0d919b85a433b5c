"""Reading and writing files whole, with errors that say what to change."""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from pathlib import Path
from secrets import token_hex
from typing import IO

from ..model.errors import Fault, InputError

try:
    import fcntl
except ImportError:  # Windows: nobody can tell whose a temporary file is, and none is cleared
    fcntl = None

MAX_BYTES = 20_000_000
NO_FILE = "is a pipe or a device, not a file: save what it gives to a file first"
OURS = ".equipoise.tmp"  # how the names of our temporary files end


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """What is in a regular file of at most 20 MB; a pipe or a device would make the reader wait for ever.

    Raises:
        InputError: no such file, no regular file, unreadable or too large.
    """
    name = os.fspath(path)
    try:
        with open(name, "rb", opener=_unblocked) as stream:
            if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
                raise _fault(name, NO_FILE)
            data = stream.read(MAX_BYTES + 1)
    except InputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise _fault(name, f"cannot be read: {_reason(error)}") from error
    if len(data) > MAX_BYTES:
        raise _fault(name, f"is larger than {MAX_BYTES // 1_000_000} MB")
    return data


def check_regular(path: str | os.PathLike[str]) -> None:
    """Whether another program that reads there would not wait for ever; nothing at all is fine.

    Raises:
        InputError: it is a pipe or a device.
    """
    name = os.fspath(path)
    if _special(name) and not os.path.isdir(name):
        raise _fault(name, NO_FILE)


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a UTF-8 file of at most 20 MB.

    Raises:
        InputError: as `read_bytes`; empty, or not UTF-8 (with the line and column).
    """
    name, data = os.fspath(path), read_bytes(path)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        line, column = before.count(b"\n") + 1, error.start - (before.rfind(b"\n") + 1) + 1
        fault = Fault((), f"is not UTF-8 text: byte 0x{data[error.start]:02x} here; save the file as UTF-8")
        raise InputError(fault.at(name, line, column)) from error
    if not text.strip():
        raise _fault(name, "the file is empty")
    return text


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a UTF-8 file whole or not at all; see `write_bytes`."""
    try:
        data = text.encode()
    except UnicodeEncodeError as error:  # half of a surrogate pair
        raise _fault(os.fspath(path), f"cannot be written: {error.reason}") from error
    write_bytes(path, data)


def write_bytes(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file whole or not at all: into a temporary file beside it, which then takes its place.

    A file that exists keeps its permissions, a symbolic link stays one, and a device such as /dev/stdout is written to.

    Raises:
        InputError: the folder is missing or cannot be written to, the path is a folder, or the disk is full.
    """
    name = os.fspath(path)
    if os.path.isdir(name):
        raise _fault(name, "cannot be written: it is a folder")
    try:
        if _special(name):
            Path(name).write_bytes(data)
        else:
            _replace(Path(os.path.realpath(name)), data)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        raise _fault(name, f"cannot be written: {_reason(error)}") from error


def check_writable(path: str | os.PathLike[str]) -> None:
    """Whether `write_text` could write there, asked before long work.

    Raises:
        InputError: the folder is missing or cannot be written to, or the path is a folder.
    """
    name = os.fspath(path)
    if os.path.isdir(name):
        raise _fault(name, "cannot be written: it is a folder")
    if _special(name):
        return
    folder = Path(os.path.realpath(name)).parent
    if not folder.is_dir():
        raise _fault(name, "cannot be written: no such file or folder")
    if not os.access(folder, os.W_OK):  # the folder, because a new file takes the place of the old one
        raise _fault(name, "cannot be written: permission denied")


def make_folder(path: str | os.PathLike[str]) -> None:
    """Make a folder, unless it exists.

    Raises:
        InputError: it cannot be made.
    """
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _fault(os.fspath(path), f"cannot be made: {_reason(error)}") from error


def _unblocked(name: str, flags: int) -> int:
    """Open without waiting for the other end of a pipe."""
    return os.open(name, flags | getattr(os, "O_NONBLOCK", 0))


def _special(name: str) -> bool:
    """Whether it is a pipe or a device, such as /dev/stdout: written to as it is, not replaced."""
    return os.path.exists(name) and not os.path.isfile(name)


def _replace(target: Path, data: bytes) -> None:
    _clear(target.parent)
    stream, temporary = _temporary(target)
    try:
        with stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
            if fcntl is None:
                stream.close()  # Windows moves no open file
            if target.exists():
                os.chmod(temporary, target.stat().st_mode & 0o7777)
            os.replace(temporary, target)
    except BaseException:  # also when interrupted: nothing is left behind
        with suppress(FileNotFoundError):
            os.unlink(temporary)
        raise


def _temporary(target: Path) -> tuple[IO[bytes], str]:
    """A new file beside the target; who writes it holds its lock, so that others can tell it from a leftover."""
    while True:
        name = str(target.with_name(f".{target.name[:100]}.{token_hex(8)}{OURS}"))
        stream = open(name, "xb")  # noqa: SIM115  # the caller closes it
        if fcntl is None:
            return stream, name
        with suppress(OSError):  # a file system without locks: others cannot lock it either, and leave it alone
            fcntl.flock(stream, fcntl.LOCK_EX)
        if os.path.exists(name):  # else another run has just cleared it, before the lock
            return stream, name
        stream.close()


def _clear(folder: Path) -> None:
    """Remove the temporary files of ours that a killed run has left: nobody holds their lock."""
    if fcntl is None:
        return
    for path in folder.glob(f".*{OURS}"):
        with suppress(OSError), open(path, "rb", opener=_unblocked) as stream:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()


def _reason(error: Exception) -> str:
    if isinstance(error, IsADirectoryError):
        return "it is a folder"
    if isinstance(error, FileNotFoundError):
        return "no such file or folder"
    return (getattr(error, "strerror", None) or str(error)).lower()


def _fault(name: str, message: str) -> InputError:
    return InputError(Fault((), message, file=name))
