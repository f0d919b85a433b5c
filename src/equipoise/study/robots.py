"""The mechanisms of a study: the data of their files, in which any field can be set."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any

from ..io import YAML_SUFFIXES, models, read
from ..io.files import read_text
from ..io.schema import MechanismFile, defaults
from ..io.yaml import built, to_text
from ..io.yaml_positions import Located, parse
from ..model.errors import Fault, InputError, Path, nearest, shorten
from ..model.mechanism import Mechanism

SUFFIXES = (*YAML_SUFFIXES, *models.MODEL_SUFFIXES)
SECTIONS = tuple(field.alias or name for name, field in MechanismFile.model_fields.items())


@dataclass(frozen=True)
class Robot:
    """A mechanism as the text of its file."""

    name: str
    text: str

    @staticmethod
    def of(path: str | os.PathLike[str]) -> Robot:
        """A mechanism file as it stands there, or a model as `export --to yaml` writes it.

        Raises:
            InputError: as `load`.
        """
        mechanism, path = read(path, None), FilePath(path)
        if path.suffix.lower() in YAML_SUFFIXES:
            text = read_text(path)
            data = parse(text, str(path)).data
            if "model" not in data and not any("file" in spring for spring in data.get("springs", ())):
                return Robot(path.stem, text)  # it needs no other file
        return Robot(path.stem, to_text(mechanism))

    @cached_property
    def data(self) -> dict[str, Any]:
        """The file as plain data."""
        return parse(self.text, self.name).data

    def place(self, dotted: str) -> Path:
        """Where in the data a field is, such as ``bodies.forearm_link.mass`` or ``joints.elbow.xyz.0``.

        Raises:
            InputError: there is none; the message says what there is instead.
        """
        parts, node, path = dotted.split("."), self.data, ()
        while parts:
            key, parts = _step(node, path, parts, self.data)
            node = _inside(node, key, path, self.data)
            path = (*path, key)
        return path

    def mechanism(self, changes: Mapping[Path, Any]) -> Mechanism:
        """The mechanism with other values in some fields.

        Raises:
            InputError: it is none then; the message says which field of it is wrong.
        """
        if not changes:
            return self._mechanism
        data = copy.deepcopy(self.data)
        for path, value in changes.items():
            node: Any = data
            for i, key in enumerate(path[:-1]):
                if isinstance(node, dict) and key not in node:
                    node[key] = copy.deepcopy(_inside(node, key, path[:i], data))
                node = node[key]
            node[path[-1]] = value
        try:
            return built(Located(self.name, [], data))
        except InputError as error:  # no line of the file is to blame
            plain = (replace(fault, file=None, line=None, column=None, source=None) for fault in error.faults)
            raise InputError(plain) from None

    @cached_property
    def _mechanism(self) -> Mechanism:
        return built(Located(self.name, [], self.data))


def files(given: str, folder: FilePath) -> list[FilePath]:
    """A mechanism file, or all those in a folder.

    Raises:
        InputError: there is none.
    """
    path = folder / given
    if not path.is_dir():
        return [path]
    found = sorted(file for file in path.iterdir() if file.suffix.lower() in SUFFIXES)
    if not found:
        raise InputError(Fault((), f"no mechanism file in the folder '{given}'", SUFFIXES))
    return found


def _step(node: Any, path: Path, parts: list[str], data: Any) -> tuple[str | int, list[str]]:
    """The next key of a path and what follows; a name may have dots of its own."""
    if isinstance(node, list):
        names = list(_names(node))
        for used in range(len(parts), 0, -1):
            name = ".".join(parts[:used])
            if name in names:
                return names.index(name), parts[used:]
        choices = names if any(isinstance(one, dict) for one in node) else [str(i) for i in range(len(node))]
        if parts[0].isdecimal() and int(parts[0]) < len(node):
            return int(parts[0]), parts[1:]
        raise InputError(Fault((), f"there is no {nearest(parts[0], choices)} in '{_dotted(path)}'", shorten(choices)))
    if not isinstance(node, dict):
        raise InputError(f"'{_dotted(path)}' is a value: there is no '{parts[0]}' in it")
    if parts[0] not in node:
        choices = tuple(dict.fromkeys((*_defaults(path, data), *map(str, node))))
        if parts[0] not in choices:
            where = f"'{_dotted(path)}'" if path else "the file"
            raise InputError(Fault((), f"there is no {nearest(parts[0], choices)} in {where}", choices))
    return parts[0], parts[1:]


def _inside(node: Any, key: str | int, path: Path, data: Any) -> Any:
    if isinstance(node, list):
        return node[int(key)]
    if key in node:
        return node[key]
    return _defaults(path, data).get(str(key))


def _defaults(path: Path, data: Any) -> dict[str, Any]:
    try:
        return defaults(path, data)
    except (KeyError, IndexError, TypeError):  # deeper than the items of a section
        return {}


def _names(items: list[Any]) -> Iterator[str]:
    for i, item in enumerate(items):
        named = isinstance(item, dict) and (item.get("name") or item.get("joint"))
        yield str(named or i)


def _dotted(path: Path) -> str:
    return ".".join(map(str, path))
