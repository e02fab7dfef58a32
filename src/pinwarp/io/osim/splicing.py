"""Editing a document by splicing its bytes: what is not edited stays as it is, to the byte."""

from __future__ import annotations

import re
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import ArrayLike

from pinwarp.io.osim.document import Document, Element

_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_INDENT = re.compile(rb"(\r\n|\n|\r)[ \t]*\Z")


class Splicer:
    """Collects edits of a document and applies them all at once.

    Parameters
    ----------
    document
        That the elements are of.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.io.osim.document import read_document
    >>> document = read_document(Path("a.osim"), b"<a><!-- kept --><b>1</b><c/></a>")
    >>> splicer, root = Splicer(document), document.root
    >>> splicer.set_numbers(root, "b", [0.1, 2])
    >>> splicer.set_text(root, "c", "R & D")
    >>> splicer.set_text(root, "d", "new")
    >>> splicer.spliced().decode()
    '<a><d>new</d><!-- kept --><b>0.1 2.0</b><c>R &amp; D</c></a>'
    """

    def __init__(self, document: Document) -> None:
        self._document, self._data = document, document.text
        self._edits: dict[tuple[int, int], bytes] = {}
        # What is missing in an element is put in where it begins.
        self._added: dict[Element, dict[str, str]] = {}

    def set_numbers(self, element: Element, tag: str, numbers: ArrayLike) -> None:
        """Set a property to numbers, in the fewest digits that read back exactly."""
        self.set_text(element, tag, numbers_text(numbers))

    def set_text(self, element: Element, tag: str, text: str) -> None:
        """Set the text of a property; where OpenSim left it out it is put in."""
        child = element.child(tag)
        if child is None:
            self._added.setdefault(element, {})[tag] = text
            return
        safe = escape(text).encode("ascii", "xmlcharrefreplace")
        if child.is_closed:
            self.replace(child, b"<%b>%b</%b>" % (tag.encode(), safe, tag.encode()))
            return
        comments = b"".join(_COMMENT.findall(self._data, child.inner, child.close))
        self._edits[child.inner, child.close] = safe + comments

    def replace(self, element: Element, xml: bytes) -> None:
        """Put something else in the place of an element."""
        self._edits[element.begin, element.end] = xml

    def indent_of(self, element: Element) -> bytes:
        """Return the line end and blanks that an element stands behind; empty within a line."""
        line = _INDENT.search(self._data, max(0, element.begin - 400), element.begin)
        return line[0] if line else b""

    def spliced(self) -> bytes:
        """Return the bytes of the document's file with all edits."""
        edits = dict(self._edits)
        for element, added in self._added.items():
            place, new = self._addition(element, added)
            edits[place] = new + edits.get(place, b"")
        out, done = [], 0
        for (begin, end), new in sorted(edits.items()):
            assert begin >= done, "edits do not overlap"
            out += [self._data[done:begin], new]
            done = end
        return self._document.as_file(b"".join([*out, self._data[done:]]))

    def _addition(self, element: Element, added: dict[str, str]) -> tuple[tuple[int, int], bytes]:
        indent = self.indent_of(element)
        lines = (
            (indent and indent + b"\t")
            + f"<{tag}>{escape(text)}</{tag}>".encode("ascii", "xmlcharrefreplace")
            for tag, text in added.items()
        )
        new = b"".join(lines)
        if not element.is_closed:
            return (element.inner, element.inner), new
        # The slash of <a/> makes room for an end.
        slash = element.inner - 2
        return (slash, element.inner), b">%b%b</%b>" % (new, indent, element.tag.encode())


def numbers_text(numbers: ArrayLike) -> str:
    """Return numbers as OpenSim reads them, each in the fewest digits that read back exactly.

    Examples
    --------
    >>> numbers_text([0.1, 3, -0.0])
    '0.1 3.0 0.0'
    """
    # A zero has no sign here, where most of them come from rounding.
    return " ".join(repr(float(x) + 0.0) for x in np.atleast_1d(np.asarray(numbers, dtype=float)))
