"""Reading and writing text files: whole or not at all, with a clear error."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from equipoise import io
from equipoise.io import files
from equipoise.model.errors import InputError
from equipoise.model.mechanism import Mechanism


def test_write_replaces_and_keeps_the_permissions(tmp_path):
    path = tmp_path / "é.txt"
    files.write_text(path, "one\n")
    assert path.stat().st_mode & 0o777 == 0o666 & ~files._umask()
    path.chmod(0o640)
    files.write_text(str(path), "twö\r\n")
    assert path.read_bytes() == "twö\r\n".encode()
    assert path.stat().st_mode & 0o777 == 0o640
    assert os.listdir(tmp_path) == ["é.txt"]


def test_write_follows_a_link(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "there" / "file.txt")
    files.write_text(tmp_path / "link", "text")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "there" / "file.txt").read_text() == "text"


def test_write_to_a_device():
    files.write_text(os.devnull, "text")
    assert not os.path.isfile(os.devnull)


@pytest.mark.parametrize("step", ["replace", "fsync", "chmod"])
@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, step, error):
    path = tmp_path / "file.txt"
    path.write_text("old")

    def fail(*_):
        raise error

    monkeypatch.setattr(os, step, fail)
    with pytest.raises(InputError if isinstance(error, OSError) else KeyboardInterrupt) as caught:
        files.write_text(path, "new")
    if isinstance(error, OSError):
        assert str(caught.value) == f"{path}: cannot be written: no space left on device"
    assert os.listdir(tmp_path) == ["file.txt"]
    assert path.read_text() == "old"


def test_text_that_is_not_unicode_leaves_nothing_behind(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        files.write_text(tmp_path / "file.txt", "\ud800")
    assert os.listdir(tmp_path) == []


def test_places_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    for path, reason in {
        tmp_path: "it is a folder",
        tmp_path / "missing" / "file.txt": "no such file or folder",
        tmp_path / "file" / "file.txt": "not a directory",
        tmp_path / "nul\0": "null",
    }.items():
        with pytest.raises(InputError, match=f"cannot be written: .*({reason})"):
            files.write_text(path, "text")


def test_unwritable_folder(tmp_path, monkeypatch):
    def refuse(*_args, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(files.tempfile, "mkstemp", refuse)  # a superuser may write anywhere
    with pytest.raises(InputError, match=r"file\.yaml: cannot be written: permission denied"):
        io.save(Mechanism("empty"), tmp_path / "file.yaml")


def test_save_and_load(tmp_path):
    io.save(Mechanism("empty"), tmp_path / "file.yml")
    assert io.load(tmp_path / "file.yml") == Mechanism("empty")
    with pytest.raises(InputError, match=r"saved as YAML, not as '\.urdf' \(valid: \.yaml, \.yml\)"):
        io.save(Mechanism("empty"), tmp_path / "file.urdf")


def test_files_that_cannot_be_read(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "MAX_BYTES", 2_000_000)
    (tmp_path / "large").write_bytes(b"a" * 2_000_001)
    (tmp_path / "empty").write_text(" \n")
    (tmp_path / "binary").write_bytes(b"one\ntwo \xff")
    for name, message in {
        "missing": "missing: cannot be read: no such file or folder",
        ".": ": cannot be read: it is a folder",
        "large": "large: is larger than 2 MB",
        "empty": "empty: the file is empty",
        "binary": "binary:2:5: is not UTF-8 text: byte 0xff here; save the file as UTF-8",
    }.items():
        with pytest.raises(InputError) as caught:
            files.read_text(tmp_path / name)
        assert str(caught.value).endswith(message)


def test_importing_io_is_light():
    code = "import sys, equipoise.io; print(sorted({'pydantic', 'ruamel', 'ruamel.yaml', 'pint'} & sys.modules.keys()))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() in ("[]", "['ruamel']")  # 'ruamel' may be a namespace made at start-up
