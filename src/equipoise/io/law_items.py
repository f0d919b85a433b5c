"""Laws as a mechanism file has them: the keys of a law are its fields, see `model.elements.laws`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, fields
from pathlib import Path as FilePath
from typing import Annotated, Any, ClassVar

from pydantic import Field, ValidationInfo, create_model, field_validator

from ..model.elements import Element, JointElement
from ..model.elements.laws import Law, Linear
from ..model.errors import Fault, InputError
from ..model.units import quantity
from .fields import Item, Number, Text, number_of, rows_of
from .tables import csv_rows, heading

LINE = {"path": "length", "force": "force", "energy": "energy"}
JOINT = {"path": "angle", "force": "torque", "energy": "energy"}
"""What the dimensions of a table's columns are on each path."""


class LawItem(Item):
    """The numbers of a law, and `made`, which makes it."""

    law: ClassVar[type[Law]]
    own_noun: ClassVar[bool] = True

    def made(self, folder: FilePath, path: dict[str, str]) -> Law:
        """Its law; the file of a table is relative to the folder of the mechanism file.

        Raises:
            InputError: a table's file cannot be read.
        """
        values = {f.name: getattr(self, f.name) for f in fields(self.law) if f.metadata}
        if (file := getattr(self, "file", None)) is not None:
            if values["points"]:
                raise InputError(Fault(("file",), "give 'file' or 'points', and not both"))
            column = next(f.metadata["columns"] for f in fields(self.law) if f.name == "points")
            values["points"] = points(folder / file, [path[name] for name in column])
        return self.law(**values)


class OnJointsItem(LawItem):
    """A law on joints: they are named in either of two ways."""

    name: Text
    kind: str
    joint: Text | None = None
    joints: dict[str, Number] = Field(default={}, validate_default=True)

    @field_validator("joints")
    @classmethod
    def _either(cls, value: dict[str, float], info: ValidationInfo) -> dict[str, float]:
        if ("joint" in info.data and info.data["joint"] is None) == (not value):
            raise InputError("give 'joint', or 'joints' with a ratio each, and not both")
        return value

    @property
    def terms(self) -> tuple[tuple[str, float], ...]:
        return tuple((self.joints or {str(self.joint): 1.0}).items())


class JointItem(OnJointsItem):
    noun = "an element on a joint"

    def element(self, folder: FilePath) -> Element:
        return JointElement(self.name, self.terms, self.made(folder, JOINT))


def law_model(law: type[Law], base: type[LawItem], path: dict[str, str]) -> type[Item]:
    """The model of a law's file keys on a base; `path` says what the dimensions of a table's columns are."""
    keys: dict[str, Any] = {}
    for f in (f for f in fields(law) if f.metadata):
        columns = [path[name] for name in f.metadata.get("columns", ())]
        if columns:
            from_file = f.name == "points"
            keys[f.name] = (Annotated[Any, rows_of(*columns)], () if from_file else f.default)
            keys |= {"file": (Text, None)} if from_file else {}
        else:
            default = ... if f.default is MISSING else f.default
            keys[f.name] = (Annotated[float, number_of(f.metadata["dimension"])], default)
    made: Any = create_model(f"{law.__name__}Item", __base__=base, **keys)
    made.law = law
    if law is not Linear and base.own_noun:
        made.noun = law.noun
    return made


def points(file: FilePath, dimensions: Sequence[str]) -> tuple[tuple[float, ...], ...]:
    """The rows of a CSV file of two columns; units stand in brackets at the head of a column, or are SI.

    Raises:
        InputError: it cannot be read, or a row has no two numbers; the message gives file and line.
    """
    (line, head), *rows = csv_rows(file, 1000)
    units = [heading(cell)[1] for cell in head]
    found = []
    for line, row in rows:
        try:
            if len(row) != len(dimensions) or len(units) != len(dimensions):
                raise InputError(f"expected {' and '.join(dimensions)}, found {len(row)} columns")
            cells = [f"{cell} {unit}" if unit else cell for cell, unit in zip(row, units, strict=True)]
            found.append(tuple(quantity(cell, name, name) for cell, name in zip(cells, dimensions, strict=True)))
        except InputError as error:
            raise InputError(fault.at(str(file), line) for fault in error.faults) from None
    return tuple(found)
