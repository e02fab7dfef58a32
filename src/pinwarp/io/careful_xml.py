"""XML from strangers: nothing that could make a small file endless is followed."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from xml.parsers import expat

from pinwarp.io.text import decoded

DEEPEST = 100
MOST = 200_000
"""Deeper, and more elements, than landmarks or a mesh have: each takes memory of its own."""

_BUFFER = 1 << 20


class XmlError(Exception):
    """What is wrong with the XML, as a clause, and the line."""

    def __init__(self, reason: str, line: int) -> None:
        super().__init__(reason)
        self.line = line


def parse_xml(
    data: str | bytes,
    begin: Callable[[str, Mapping[str, str], int], object],
    end: Callable[[str], object] = lambda _tag: None,
    text: Callable[[str], object] | None = None,
    *,
    most: int | None = None,
    parser: expat.XMLParserType | None = None,
) -> None:
    """Walk through XML.

    Entities, defaults for attributes and whatever else a document can declare of its own are
    refused; nothing outside of it is ever looked at.

    Parameters
    ----------
    data
        All of it, whatever encoding it says; blanks in front of it are passed over.
    begin, end, text
        Called with the tag, attributes and line of an element, with the tag of one that ends, and
        with what stands in between.
    most
        Refuse more elements than this, and without it than :data:`MOST`.
    parser
        One of the caller's, which it can ask for more: where in the text something is, in bytes
        of UTF-8 behind the blanks.

    Raises
    ------
    XmlError
        When it is not XML, declares something, or has too many elements or too deep ones.

    Examples
    --------
    >>> parse_xml('<a><b x="1"/></a>', print)
    a {} 1
    b {'x': '1'} 1
    """
    whole = data if isinstance(data, str) else decoded(data)
    # XML itself allows nothing before its declaration.
    content = whole.lstrip("\ufeff \t\r\n")
    lines_before = whole.count("\n", 0, len(whole) - len(content))
    parser = parser or expat.ParserCreate()
    parser.buffer_text = True
    parser.buffer_size = _BUFFER
    depth = count = 0
    allowed = MOST if most is None else most

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth += 1
        count += 1
        line = lines_before + parser.CurrentLineNumber
        if depth > DEEPEST:
            raise XmlError("its elements are nested too deeply", line)
        if count > allowed:
            raise XmlError(f"it has more than {allowed:,} elements", line)
        begin(tag, attributes, line)

    def leave(tag: str) -> None:
        nonlocal depth
        depth -= 1
        end(tag)

    def refuse(*_declared: object) -> None:
        words = "it declares entities or defaults of its own, which it has no use for"
        raise XmlError(words, lines_before + parser.CurrentLineNumber)

    parser.StartElementHandler = start
    parser.EndElementHandler = leave
    if text is not None:
        parser.CharacterDataHandler = text
    # Defaults of attributes grow a file as entities do: a long one comes with every element.
    parser.EntityDeclHandler = refuse
    parser.AttlistDeclHandler = refuse
    parser.ElementDeclHandler = refuse
    parser.NotationDeclHandler = refuse
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        line = lines_before + error.lineno
        raise XmlError(f"this is not XML, or it was cut off ({reason})", line) from None
    except (ValueError, LookupError) as error:
        # Halves of characters.
        raise XmlError(f"this is not XML, or it was cut off ({error})", 1) from None


def xml_tree(data: str | bytes) -> ET.Element:
    """Return the root of XML, read as by :func:`parse_xml`.

    Raises
    ------
    XmlError
        As :func:`parse_xml`.

    Examples
    --------
    >>> xml_tree("<a><b>text</b></a>")[0].text
    'text'
    """
    builder = ET.TreeBuilder()
    parse_xml(
        data,
        lambda tag, attributes, _line: builder.start(tag, dict(attributes)),
        builder.end,
        builder.data,
    )
    return builder.close()
