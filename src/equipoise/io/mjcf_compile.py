"""Compiles MJCF with MuJoCo in a process of its own: a few letters can make it work for hours and take gigabytes."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's names come from a compiled module that ships no type stubs)

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ..model.errors import Fault, InputError
from . import files, mjcf_child
from .xmltree import Document

SECONDS, WITH_ASSETS = 0.7, 30.0  # of processor time, without and with files of meshes, textures and the like
PATIENCE = 60.0  # [s] for a child that neither works nor ends
SMALLER = "leave out what is drawn and copied"


def compiled(name: str) -> Any:
    """The compiled model of a file.

    Raises:
        InputError: the engine is missing or does not compile the file; the file, or one that it includes, is no regular
            file, no XML or too large; or the compiler takes more time or memory than the limits.
    """
    assets = _assets(name)
    try:
        import mujoco
    except ImportError:
        message = "an MJCF file is read through MuJoCo, which comes with: pip install 'equipoise[sim]'"
        raise InputError(Fault((), message, file=name)) from None
    data = _run(name, WITH_ASSETS if assets else SECONDS)
    return mujoco.MjModel.from_binary_path("model.mjb", {"model.mjb": data})


def _assets(name: str) -> bool:
    """Whether the file, or one that it includes, names files of another kind; all that are named are regular files."""
    folder, waiting, seen = Path(name).parent, [name], {name}
    folders, assets = {folder}, set()
    while waiting:
        file = waiting.pop()
        for element in Document(files.read_text(file), file).root.walk():
            named = {key: value for key, value in element.attributes.items() if key.startswith("file")}  # also fileup
            if element.tag == "compiler":
                folders |= {folder / value for key, value in element.attributes.items() if key.endswith("dir")}
            elif element.tag != "include":
                assets |= set(named.values())
            elif (path := os.fspath(folder / named.get("file", ""))) not in seen:
                seen.add(path)
                waiting.append(path)
    for path in (place / asset for place in folders for asset in assets):
        files.check_regular(path)
    return bool(assets)


def _run(name: str, seconds: float) -> bytes:
    command = [sys.executable, "-P", mjcf_child.__file__, os.path.abspath(name), str(seconds)]
    limits = {"OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "2"}  # memory that is reserved counts
    with TemporaryDirectory() as folder:  # the engine keeps a log where it runs
        try:
            done = subprocess.run(
                command, cwd=folder, env=os.environ | limits, capture_output=True, timeout=PATIENCE, check=False
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise _fault(name, f"takes MuJoCo more than {PATIENCE:g} s to compile: {SMALLER}") from None
    if done.returncode == 0:
        return done.stdout
    reason = " ".join(done.stderr.decode(errors="replace").split())
    if done.returncode == mjcf_child.REFUSED:
        raise _fault(name, f"MuJoCo does not compile it: {reason.removeprefix('Error: ')}")
    if done.returncode == -mjcf_child.TIMER:
        raise _fault(name, f"takes MuJoCo more than {seconds:g} s to compile: {SMALLER}")
    last = reason.rpartition("Error: ")[2] or f"signal {-done.returncode}"
    most = f"MuJoCo fails on it ({last}); it has {mjcf_child.MEGABYTES} MB of memory"
    raise _fault(name, f"{most}: {SMALLER}")


def _fault(name: str, message: str) -> InputError:
    return InputError(Fault((), message, file=name))
