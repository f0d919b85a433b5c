"""YAML 1.2 text to plain data that knows its places: the line and column of every key and value.

Built on the parser's events, so nothing in a file is constructed, expanded or evaluated: aliases, anchors and tags
are refused, and the nesting is limited.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from math import inf
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.reader import ReaderError

from ..model.errors import Fault, InputError, Path

MAX_DEPTH = 50
MAX_LENGTH = 1_000_000  # characters; the parser takes about a second for a hundred thousand
MAX_VALUES = 30_000  # keys and values: more than the largest mechanism needs
DIGITS = 1000  # of a whole number; Python itself refuses to write more than some thousand
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(
    r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
)
_WORDS: dict[str, bool | None] = {"": None, "~": None}
_WORDS |= dict.fromkeys(("null", "Null", "NULL"))
_WORDS |= dict.fromkeys(("true", "True", "TRUE"), True)
_WORDS |= dict.fromkeys(("false", "False", "FALSE"), False)
_BREAK = re.compile("\r\n|[\r\n\x85\u2028\u2029]")  # what the parser counts as a line

Position = tuple[int, int]  # line and column, from 1


@dataclass
class Located:
    """The data of a file, with the places of its values and keys and the faults found so far."""

    file: str
    lines: list[str]
    data: Any = None
    values: dict[Path, Position] = field(default_factory=dict)
    keys: dict[Path, Position] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)

    def locate(self, fault: Fault, on_key: bool = False) -> Fault:
        """The fault with its place: of its value (or key), or else of the nearest thing that encloses it."""
        if fault.file is not None:
            return fault
        path = fault.path
        place = self.keys.get(path) if on_key else None
        while place is None and path:
            place = self.values.get(path)
            path = path[:-1]
        line, column = place or self.values.get((), (1, 1))
        return self.at(fault, line, column)

    def at(self, fault: Fault, line: int, column: int) -> Fault:
        """The fault at a line and column of this file, with the line shown."""
        source = self.lines[line - 1] if line <= len(self.lines) else ""
        return fault.at(self.file, line, column, source if len(source) <= 160 else source[:157] + "...")

    def error(self, faults: Iterable[Fault] = ()) -> InputError:
        """The error that reports these faults and those found while parsing, in the order of the file."""
        located = (self.locate(fault) for fault in (*self.faults, *faults))
        return InputError(sorted(located, key=lambda f: (f.file != self.file, f.line or 0, f.column or 0)))


def resolve(text: str) -> Any:
    """The value of a plain scalar: None, bool, int, float, or the text itself (the core schema of YAML 1.2)."""
    if text in _WORDS:
        return _WORDS[text]
    if _INT.fullmatch(text):
        if len(text) > DIGITS:
            return -inf if text[0] == "-" else inf
        return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
    if _FLOAT.fullmatch(text):
        return float(text.lower().replace(".inf", "inf").replace(".nan", "nan"))
    return text


def parse(text: str, file: str) -> Located:
    """Parse YAML text; a key given twice is kept as a fault in the result, and its first value counts.

    Raises:
        InputError: it is not YAML, has no or several documents, uses an alias, an anchor or a tag, nests too deep, or
            is too long.
    """
    if len(text) > MAX_LENGTH:
        raise InputError(Fault((), f"has {len(text):,} characters, at most {MAX_LENGTH:,} are read", file=file))
    located = Located(file, _BREAK.split(text))
    refused: list[Fault] = []
    builder = _Builder(located, refused)
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            builder.take(event)
            if builder.stop:
                break
    except MarkedYAMLError as error:
        raise located.error([*refused, _syntax(located, error)]) from error
    except ReaderError as error:
        before = _BREAK.split(text[: error.position])
        fault = Fault((), f"not valid YAML: the character U+{ord(text[error.position]):04X} is not allowed in a file")
        raise located.error([located.at(fault, len(before), len(before[-1]) + 1)]) from error
    except (YAMLError, ValueError, OverflowError, AssertionError) as error:  # what the parser does not foresee
        fault = Fault((), "not valid YAML: a number in a \\U escape or a % directive is out of range, here or below")
        raise located.error([*refused, located.at(fault, *builder.place)]) from error
    if refused:
        raise located.error(refused)
    if not builder.documents:
        raise InputError(Fault((), "the file is empty", file=file))
    return located


@dataclass
class _Frame:
    """A collection being filled. `path` is None inside the value of a key that is ignored."""

    items: dict[str, Any] | list[Any]
    path: Path | None
    key: str | None = None  # of a mapping: the key whose value comes next
    ignored: bool = False  # that key was given before


class _Builder:
    """Builds the data from the parser's events with a stack of its own: no recursion, whatever the nesting."""

    def __init__(self, located: Located, refused: list[Fault]) -> None:
        self.located = located
        self.refused = refused
        self.documents = 0
        self.stop = False
        self._taken = 0
        self.place: Position = (1, 1)  # of the last event
        self._stack: list[_Frame] = []

    def take(self, event: Any) -> None:
        kind = type(event).__name__
        self.place = _place(event)
        self._taken += 1
        if self._taken > MAX_VALUES:
            self._refuse(event, f"has more than {MAX_VALUES:,} keys and values, the last of them here", stop=True)
        elif kind == "DocumentStartEvent":
            self.documents += 1
            if self.documents > 1:
                self._refuse(event, "a second document starts here; a mechanism file holds one", stop=True)
        elif kind in ("MappingEndEvent", "SequenceEndEvent"):
            self._stack.pop()
        elif kind == "AliasEvent":
            self._refuse(event, f"the alias '*{event.anchor}' is not accepted; write the value out")
            self._scalar(event, "")
        elif kind in ("ScalarEvent", "MappingStartEvent", "SequenceStartEvent"):
            if event.anchor is not None:
                self._refuse(event, f"the anchor '&{event.anchor}' is not accepted; remove it")
            if event.tag is not None:
                tag = event.tag.replace("tag:yaml.org,2002:", "!!")
                self._refuse(event, f"the tag '{tag}' is not accepted; write a plain value")
            if kind == "ScalarEvent":
                plain = event.style is None and event.tag is None
                self._scalar(event, event.value, plain)
            else:
                self._open(event, {} if kind == "MappingStartEvent" else [])

    def _scalar(self, event: Any, text: str, plain: bool = True) -> None:
        frame = self._stack[-1] if self._stack else None
        if frame is None or isinstance(frame.items, list) or frame.key is not None:
            self._add(event, resolve(text) if plain else text)
            return
        frame.key, frame.ignored = text, text in frame.items
        if frame.path is not None:
            path = (*frame.path, text)
            if frame.ignored:
                message = f"duplicate key, first given on line {self.located.keys[path][0]}"
                self.located.faults.append(self._at(event, Fault(path, message)))
            else:
                self.located.keys[path] = _place(event)

    def _open(self, event: Any, items: dict[str, Any] | list[Any]) -> None:
        frame = self._stack[-1] if self._stack else None
        if len(self._stack) >= MAX_DEPTH:
            self._refuse(event, f"nested more than {MAX_DEPTH} deep", stop=True)
        elif frame is not None and isinstance(frame.items, dict) and frame.key is None:
            self._refuse(event, "a key must be plain text, not a list or a mapping", stop=True)
        else:
            self._stack.append(_Frame(items, self._add(event, items)))

    def _add(self, event: Any, value: Any) -> Path | None:
        """Put a value where it belongs and remember its place; returns its path."""
        if not self._stack:
            self.located.data = value
            self.located.values[()] = _place(event)
            return ()
        frame, ignored = self._stack[-1], False
        if isinstance(frame.items, list):
            index: int | str = len(frame.items)
            frame.items.append(value)
        else:
            index, ignored = frame.key or "", frame.ignored
            if not ignored:
                frame.items[index] = value
            frame.key = None
        if frame.path is None or ignored:
            return None
        path = (*frame.path, index)
        # a block starts on the line after its key, and so may nothing: the key is the better place to point at
        block = getattr(event, "flow_style", None) is False
        nothing = value is None and getattr(event, "value", None) == ""
        self.located.values[path] = self.located.keys.get(path, _place(event)) if block or nothing else _place(event)
        return path

    def _refuse(self, event: Any, message: str, stop: bool = False) -> None:
        path = next((frame.path for frame in reversed(self._stack) if frame.path is not None), ())
        if self._stack and self._stack[-1].key is not None:
            path = (*path, self._stack[-1].key)
        self.refused.append(self._at(event, Fault(path if len(path) < 10 else path[:1], message)))
        self.stop = self.stop or stop

    def _at(self, event: Any, fault: Fault) -> Fault:
        return self.located.at(fault, *_place(event))


def _place(event: Any) -> Position:
    return event.start_mark.line + 1, event.start_mark.column + 1


def _syntax(located: Located, error: MarkedYAMLError) -> Fault:
    problem = str(error.problem or error.context)
    mark = error.problem_mark or error.context_mark
    for found, plain in _PLAIN.items():
        if found in problem:
            problem = plain
            break
    if error.context_mark is not None and mark is not None and error.context_mark.line != mark.line:
        problem += f" ({error.context}, which starts on line {error.context_mark.line + 1})"
    fault = Fault((), f"not valid YAML: {problem}")
    return fault if mark is None else located.at(fault, mark.line + 1, mark.column + 1)


_PLAIN = {
    "'\\t' that cannot start any token": "a tab; indent with spaces",
    "mapping values are not allowed here": "a second ':' in one value; put a text that holds ': ' in quotes, "
    "and check the indentation",
    "expected <block end>": "the indentation does not fit the lines above",
    "could not find expected ':'": "a key without ':'",
    "expected ',' or ']'": "a list that is not closed: expected ',' or ']'",
    "expected ',' or '}'": "a mapping that is not closed: expected ',' or '}'",
    "cannot start any token": "a text that starts with one of @ ` % must be in quotes",
}
