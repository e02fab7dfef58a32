"""The XML of a model with the place of every element in the bytes, to be edited by splicing."""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from pinwarp.core.errors import FileFormatError
from pinwarp.io.careful_xml import XmlError, parse_xml
from pinwarp.io.csv_cells import as_sentence

MOST_ELEMENTS = 1_000_000
_WIDE = (b"\xff\xfe", b"\xfe\xff", b"<\0", b"\0<", b"\0\0")
_START_TAG = re.compile(rb"""<(?:"[^"]*"|'[^']*'|[^"'>])*>""")
_HEAD = re.compile(rb"(?:\xef\xbb\xbf)?[ \t\r\n]*")
_DECLARED = re.compile(rb"""(?:\xef\xbb\xbf)?\s*<\?xml[^>]*?encoding\s*=\s*["']([!-~]+?)["']""")
_UTF8 = "utf-8"
_SAVE = "Open the model in OpenSim and save it again."


class Element:
    """One element: what it says, and where in the bytes.

    Attributes
    ----------
    tag, attributes, line
        What its first tag says, and the line that is on.
    parent, children
        The tree.
    text
        What stands in it between its children.
    number
        Its place in the order of the document.
    begin, inner, close, end
        The bytes from ``begin`` to ``end`` are the element; from ``inner`` to ``close`` what is
        in it. A tag such as ``<a/>`` closes where it ends.
    """

    __slots__ = (
        "attributes",
        "begin",
        "children",
        "close",
        "end",
        "inner",
        "line",
        "number",
        "parent",
        "tag",
        "text",
    )

    def __init__(
        self,
        tag: str,
        attributes: Mapping[str, str],
        parent: Element | None,
        line: int,
        number: int,
    ) -> None:
        self.tag, self.attributes, self.parent = tag, attributes, parent
        self.line, self.number = line, number
        self.children: list[Element] = []
        self.text = ""
        self.begin = self.inner = self.close = self.end = 0

    @property
    def name(self) -> str:
        """Its ``name`` attribute, or nothing."""
        return self.attributes.get("name", "")

    @property
    def is_closed(self) -> bool:
        """Whether its only tag ends it, as ``<a/>`` does."""
        return self.inner == self.end

    def child(self, tag: str) -> Element | None:
        """Return its first child with a tag, or None."""
        return next((child for child in self.children if child.tag == tag), None)

    def walk(self) -> Iterator[Element]:
        """Yield it and all below it, in the order of the document."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))


@dataclass(frozen=True, eq=False)
class Document:
    """A document whose elements know their bytes.

    Parameters
    ----------
    root
        The element that all others are in.
    text
        What the places of elements count in: the document in UTF-8.
    head
        The bytes before that in the file: a mark of the encoding, and blanks.
    encoding
        Of the file.
    """

    root: Element
    text: bytes = field(repr=False)
    head: bytes
    encoding: str

    def as_file(self, text: bytes) -> bytes:
        """Return the bytes of a file with another text in it."""
        if self.encoding == _UTF8:
            return self.head + text
        return self.head + text.decode(_UTF8).encode(self.encoding)


def read_document(path: Path, data: bytes) -> Document:
    """Read the elements of a document.

    Parameters
    ----------
    path
        For messages.
    data
        Its bytes.

    Returns
    -------
    Document

    Raises
    ------
    FileFormatError
        When it is not XML in an encoding that holds ASCII as it is, declares a type or entities,
        is too deep or too long, or keeps a part of it in another file; the message names the line.

    Examples
    --------
    >>> document = read_document(Path("a.osim"), b"<a><b name='x'> 1 2 </b><c/></a>")
    >>> [(e.tag, e.name, e.text, e.begin, e.end) for e in document.root.children]
    [('b', 'x', ' 1 2 ', 3, 24), ('c', '', '', 24, 28)]
    """
    if data.startswith(_WIDE):
        raise FileFormatError(path, "It is saved as UTF-16 or UTF-32. Save it as UTF-8.")
    encoding = _encoding_of(path, data)
    head = _HEAD.match(data)
    start = head.end() if head else 0
    try:
        words = data[start:].decode(encoding)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, start + error.start) + 1
        said = f"It is not in the encoding {encoding} that it says it is in."
        raise FileFormatError(path, f"{said} {_SAVE}", line) from None
    # Whatever the file's own encoding, expat counts in this one when it is handed text.
    text = data[start:] if encoding == _UTF8 else words.encode(_UTF8)
    parser = expat.ParserCreate()
    reader = _Reader(text, parser)
    lines = data.count(b"\n", 0, start)
    try:
        parse_xml(words, reader.begin, reader.leave, reader.hear, parser=parser, most=MOST_ELEMENTS)
    except XmlError as error:
        words = f"{as_sentence(str(error))} {_SAVE}"
        raise FileFormatError(path, words, lines + error.line) from None
    assert reader.root is not None, "what has no element is no XML"
    if lines:
        for element in reader.root.walk():
            element.line += lines
    return Document(reader.root, text, data[:start], encoding)


def _encoding_of(path: Path, data: bytes) -> str:
    """Return the encoding that a document says it is in."""
    said = _DECLARED.match(data)
    name = said[1].decode("ascii") if said else _UTF8
    # What is spliced in is ASCII.
    ascii_text = "".join(map(chr, range(32, 127)))
    try:
        is_plain = ascii_text.encode(name) == ascii_text.encode()
        encoding = codecs.lookup(name).name
    except (LookupError, UnicodeError):
        is_plain = False
    if not is_plain:
        words = f"Its encoding {name!r} is none that can be edited. Save it as UTF-8."
        raise FileFormatError(path, words, 1)
    return encoding


class _Reader:
    """Puts the elements together while expat goes through the bytes."""

    def __init__(self, data: bytes, parser: expat.XMLParserType) -> None:
        self._data, self._parser = data, parser
        self._open: list[Element] = []
        # Put together in the end: a text in a thousand pieces would be copied a thousand times.
        self._texts: list[list[str]] = []
        self._number = 0
        self.root: Element | None = None
        parser.StartDoctypeDeclHandler = self._refuse_type

    def begin(self, tag: str, attributes: Mapping[str, str], line: int) -> None:
        parent = self._open[-1] if self._open else None
        if "file" in attributes:
            raise XmlError(f"the {tag} is kept in another file, {attributes['file']!r}", line)
        element = Element(tag, attributes, parent, line, self._number)
        self._number += 1
        element.begin = self._parser.CurrentByteIndex
        start = _START_TAG.match(self._data, element.begin)
        if start is None:
            raise XmlError("its bytes and what they say do not agree", line)
        element.inner = start.end()
        if parent is None:
            self.root = element
        else:
            parent.children.append(element)
        self._open.append(element)
        self._texts.append([])

    def leave(self, _tag: str) -> None:
        element = self._open.pop()
        element.text = "".join(self._texts.pop())
        if self._data[element.inner - 2 : element.inner] == b"/>":
            element.close = element.end = element.inner
            return
        element.close = self._parser.CurrentByteIndex
        element.end = self._data.index(b">", element.close) + 1

    def hear(self, text: str) -> None:
        if self._texts:
            self._texts[-1].append(text)

    def _refuse_type(self, *_declared: object) -> None:
        words = "it declares a document type, which no model needs"
        raise XmlError(words, self._parser.CurrentLineNumber)
