"""Text of any program becomes the same lines."""

from __future__ import annotations

import codecs
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.io import text as module
from pinwarp.io.careful_xml import XmlError, parse_xml, xml_tree
from pinwarp.io.text import decoded, filled_lines, lines_of, narrow, stretches_of

# As programs write text; without a mark a wide encoding is told by its zeros.
ENCODINGS: dict[str, Callable[[str], bytes]] = {
    "UTF-8": str.encode,
    "UTF-8 with a mark": lambda text: codecs.BOM_UTF8 + text.encode(),
    "UTF-16": lambda text: text.encode("utf-16"),
    "UTF-16 little": lambda text: text.encode("utf-16-le"),
    "UTF-16 big": lambda text: text.encode("utf-16-be"),
    "UTF-16 big with a mark": lambda text: codecs.BOM_UTF16_BE + text.encode("utf-16-be"),
    "UTF-32": lambda text: text.encode("utf-32"),
    "Windows": lambda text: text.encode("cp1252"),
}
TEXT = "name,x,y,z of the left femur, as written by hand on a Tuesday: länge\r\nb\rc\n"


@pytest.mark.parametrize("encode", ENCODINGS.values(), ids=ENCODINGS)
def test_a_text_is_the_same_in_every_encoding(encode):
    assert decoded(encode(TEXT)) == TEXT


@pytest.mark.parametrize("encode", ENCODINGS.values(), ids=ENCODINGS)
def test_large_text_has_a_byte_for_each_letter_and_no_mark(encode):
    assert narrow(encode("v 0 0 0\nv 1 0 0\n")) == b"v 0 0 0\nv 1 0 0\n"


@given(st.binary(max_size=200))
def test_any_bytes_become_some_text(data):
    assert isinstance(decoded(data), str)
    assert isinstance(narrow(data), bytes)


def test_bytes_that_are_narrow_are_not_copied():
    data = b"v 0 0 0\n" * 1000
    assert narrow(data) is data


@given(st.lists(st.tuples(st.sampled_from(["", "v 0 0 0", "x"]), st.sampled_from("\r\n"))))
def test_stretches_together_are_the_lines_of_the_text(parts):
    text = "".join(line + end for line, end in parts).replace("\n\r", "\n\r\n")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(module, "_CHUNK", 5)
        stretches = list(stretches_of(text.encode()))
    expected = [line.rstrip("\r\n") for line in lines_of(text)]
    found = [line for part in stretches for line in part.data.decode().splitlines()]
    assert found == expected
    starts = [part.first for part in stretches]
    assert starts == [
        1 + sum(len(s.data.splitlines()) for s in stretches[:n]) for n in range(len(starts))
    ]


def test_comments_and_blank_lines_are_passed_over_and_counted():
    text = "\n# by hand\r\n! so\r\rVersion 1.0\n"
    assert list(filled_lines(text, ("#", "!"))) == [(5, "Version 1.0")]


@pytest.mark.parametrize("declared", ["utf-8", "UTF-16", "ISO-8859-1"])
@pytest.mark.parametrize("encode", ENCODINGS.values(), ids=ENCODINGS)
def test_xml_is_read_in_the_encoding_it_is_in_with_blank_lines_in_front(encode, declared):
    text = f'\n \r\n<?xml version="1.0" encoding="{declared}"?>\n<a b="länge"/>'
    assert xml_tree(encode(text)).get("b") == "länge"
    lines = []
    parse_xml(encode(text), lambda _tag, _attributes, line: lines.append(line))
    assert lines == [4]
    with pytest.raises(XmlError) as caught:
        xml_tree(encode(text + "<"))
    assert caught.value.line == 4
