"""XML with the line of every element, and nothing but elements: no document type, no entities, no network."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from xml.parsers import expat

from ..model.errors import Fault, InputError

CHUNK = 65_536  # characters
MAX_ELEMENTS = 100_000  # the largest robot files have a few thousand


@dataclass(frozen=True)
class XmlElement:
    """An element and its place, both counted from 1, with the text that stands in it."""

    tag: str
    attributes: dict[str, str]
    line: int
    column: int
    children: list[XmlElement] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    def find(self, tag: str) -> XmlElement | None:
        """The first child with this tag."""
        return next(self.find_all(tag), None)

    def find_all(self, tag: str) -> Iterator[XmlElement]:
        """The children with this tag."""
        return (child for child in self.children if child.tag == tag)

    def walk(self) -> Iterator[XmlElement]:
        """This element and everything below it, without recursion: a hostile file can nest without limit."""
        waiting: list[XmlElement] = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))


class Document:
    """A parsed file.

    Args:
        text: the file's text.
        file: its name, for errors.

    Raises:
        InputError: the text is not well-formed XML, has too many elements, or has a document type
            declaration, which could define entities.
    """

    def __init__(self, text: str, file: str) -> None:
        self.file = file
        self._lines = re.split(r"\r\n|\r|\n", text)  # what expat counts as lines; splitlines() counts more
        self.root = self._parse(text)

    def place(self, fault: Fault, element: XmlElement) -> Fault:
        """The fault, at the place of an element."""
        return self._at(fault, element.line, element.column)

    def _at(self, fault: Fault, line: int, column: int) -> Fault:
        source = self._lines[line - 1] if line <= len(self._lines) else ""
        return fault.at(self.file, line, column, source if len(source) <= 160 else source[:157] + "...")

    def _parse(self, text: str) -> XmlElement:
        parser = expat.ParserCreate()
        parser.buffer_text = True
        open_elements = [XmlElement("", {}, 0, 0)]
        count = 0

        def refuse(message: str) -> None:
            place = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
            raise InputError(self._at(Fault((), message), *place))

        def start(tag: str, attributes: dict[str, str]) -> None:
            nonlocal count
            count += 1
            if count > MAX_ELEMENTS:
                refuse(f"has more than {MAX_ELEMENTS:,} elements")
            element = XmlElement(tag, attributes, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
            open_elements[-1].children.append(element)
            open_elements.append(element)

        def end(_tag: str) -> None:
            open_elements.pop()

        def characters(found: str) -> None:
            open_elements[-1].texts.append(found)

        def doctype(*_: object) -> None:
            # expat reports the declaration before it reads any entity inside it
            refuse("a document type declaration (<!DOCTYPE ...>) is not accepted: remove it")

        parser.StartElementHandler = start
        parser.EndElementHandler = end
        parser.CharacterDataHandler = characters
        parser.StartDoctypeDeclHandler = doctype
        try:
            parser.Parse(text, True)
        except expat.ExpatError as error:
            fault = Fault((), f"not well-formed XML: {expat.errors.messages[error.code]}")
            raise InputError(self._at(fault, error.lineno, error.offset + 1)) from None
        return open_elements[0].children[0]


def root_tag(text: str) -> str | None:
    """The tag of the first element, without reading further; None where what comes before it is no XML."""
    parser, found = expat.ParserCreate(), []
    parser.StartElementHandler = lambda tag, _: found.append(tag)
    with suppress(expat.ExpatError):
        for start in range(0, len(text), CHUNK):
            parser.Parse(text[start : start + CHUNK], False)
            if found:
                break
    return found[0] if found else None


def lines(text: str, file: str) -> dict[tuple[str, str], int]:
    """Tag and name -> line of the first such element; a name that is not given is empty. Nothing of a faulty text."""
    try:
        root = Document(text, file).root
    except InputError:
        return {}
    found: dict[tuple[str, str], int] = {}
    for element in root.walk():
        found.setdefault((element.tag, element.attributes.get("name", "")), element.line)
    return found
