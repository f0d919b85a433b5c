"""A mechanism as YAML text: items in blocks, vectors on one line, defaults left out, every number exact."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Mapping
from numbers import Integral, Real
from typing import Any

from ..model.elements import Element, Spring
from ..model.elements.laws import Law
from ..model.elements.laws.profile import CamSpring, Profile
from ..model.errors import Fault, InputError, Path
from ..model.mechanism import SINGLE, Joint, Mechanism
from .attachment_items import written
from .schema import SCHEMA
from .yaml_positions import MAX_DEPTH, resolve

_PLAIN = re.compile(r"[^\W\d_](?:[\w ./()+-]*[\w./()+-])?")
_OTHER_YAML = re.compile(r"y|n|yes|no|on|off", re.IGNORECASE)  # booleans to readers of YAML 1.1
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}
_LONG_KEY = 200  # YAML limits what may stand before a plain ':'


class _Line(dict[str, Any]):
    """A mapping that is written on one line."""


def to_text(mechanism: Mechanism) -> str:
    """The mechanism as a file of schema 1 in SI units; reading it gives an equal mechanism.

    Raises:
        InputError: the provenance holds something that is not text, a number, a bool, None, a list or a mapping.
    """
    sections = ("bodies", "joints", "couplings", "loops", "springs", "masses", "capsules", "shapes")
    defaults = {f.name: f.default for f in dataclasses.fields(Mechanism)}
    document: dict[str, Any] = {"schema": SCHEMA, "name": mechanism.name}
    if mechanism.gravity != defaults["gravity"]:
        document["gravity"] = _numbers(mechanism.gravity)
    for section in sections:
        if items := getattr(mechanism, section):
            document[section] = [_item(item) for item in items]
    if mechanism.attachments:
        document["attachments"] = [written(one) for one in mechanism.attachments]
    if mechanism.independent:
        document["independent"] = list(mechanism.independent)
    if mechanism.assembly:
        document["assembly"] = {name: float(value) for name, value in mechanism.assembly}
    if mechanism.workspace != defaults["workspace"]:
        document["workspace"] = _item(mechanism.workspace)
    if mechanism.goal:
        document["goal"] = mechanism.goal.to_dict()
    if mechanism.provenance:
        document["provenance"] = _checked(mechanism.provenance, ("provenance",))
    lines: list[str] = []
    for key, value in document.items():
        if lines and isinstance(value, (list, dict)) and key != "gravity":
            lines.append("")
        lines += _block({key: value})
    return "\n".join(lines) + "\n"


def _item(item: Any) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for f in dataclasses.fields(item):
        value = getattr(item, f.name)
        always = f.name == "axis" and isinstance(item, Joint) and item.type in SINGLE
        if not always and value == f.default:
            continue
        if f.name == "name" and isinstance(item, Element) and not isinstance(item, Spring):
            out |= {"name": value, "kind": item.kind}
        elif isinstance(value, Law | Profile):
            out |= _item(value)
        elif isinstance(value, CamSpring):
            out[f.name] = _Line({"kind": value.law.kind, **_item(value)})
        elif dataclasses.is_dataclass(value):
            out[f.name] = _Line(_item(value))
        elif f.name == "joints" and [ratio for _, ratio in value] == [1.0]:
            out["joint"] = value[0][0]
        elif f.name in ("terms", "joints"):
            out[f.name] = _Line((name, float(ratio)) for name, ratio in value)
        elif isinstance(value, str):
            out[f.name] = value
        elif isinstance(value, tuple):
            out[f.name] = [_listed(one) for one in value]
        else:
            out[f.name] = int(value) if f.name == "samples" else float(value)
    return out


def _listed(value: Any) -> Any:
    """An entry of a list: a number, a pair of them, or an item on one line."""
    if isinstance(value, tuple):
        return _numbers(value)
    return _Line(_item(value)) if dataclasses.is_dataclass(value) else float(value)


def _numbers(values: Any) -> list[float]:
    return [float(value) for value in values]


def _checked(value: Any, path: Path) -> Any:
    """Plain data, from what may hold tuples and numpy numbers."""
    if len(path) >= MAX_DEPTH and isinstance(value, (list, tuple, Mapping)):
        raise InputError(Fault(path[:3], f"nested more than {MAX_DEPTH} deep"))
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real):
        return float(value)
    if isinstance(value, (list, tuple)):
        return [_checked(element, (*path, i)) for i, element in enumerate(value)]
    if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        return {key: _checked(element, (*path, key)) for key, element in value.items()}
    found = "a mapping with keys that are not text" if isinstance(value, Mapping) else f"a {type(value).__name__}"
    choices = ("text", "number", "true", "false", "null", "list", "mapping with text keys")
    raise InputError(Fault(path, f"cannot be written to a file: {found}", choices))


def _block(value: Any) -> list[str]:
    """The lines of a mapping or list."""
    lines: list[str] = []
    if isinstance(value, dict):
        for key, element in value.items():
            if not _is_block(element):
                lines.append(f"{_text(key)}: {_inline(element)}")
            else:
                lines += [f"{_text(key)}:", *(f"  {line}" for line in _block(element))]
    else:
        for element in value:
            first, *more = _block(element) if _is_block(element) else [_inline(element)]
            lines += [f"- {first}", *(f"  {line}" for line in more)]
    return lines


def _is_block(value: Any) -> bool:
    if isinstance(value, dict):
        return bool(value) and not isinstance(value, _Line) and all(len(key) <= _LONG_KEY for key in value)
    return isinstance(value, list) and any(_is_block(element) for element in value)


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        pairs = (f"{'? ' * (len(key) > _LONG_KEY)}{_text(key)}: {_inline(v)}" for key, v in value.items())
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_inline(element) for element in value) + "]"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "null"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else f"{'-' if value < 0 else ''}.inf"
    return repr(value)


def _text(text: str) -> str:
    """A text as it is where that reads back as the same text, else in double quotes."""
    if _PLAIN.fullmatch(text) and text.isprintable() and resolve(text) == text and not _OTHER_YAML.fullmatch(text):
        return text
    return '"' + "".join(_ESCAPES.get(c) or (c if c.isprintable() else _escape(ord(c))) for c in text) + '"'


def _escape(code: int) -> str:
    if code <= 0xFF:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"
