"""Elements, where they are in the bytes, and edits that leave all other bytes alone."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError
from pinwarp.io.osim.document import read_document
from pinwarp.io.osim.splicing import Splicer
from tests.osim_models import NAMES, model_file

PLACE = Path("model.osim")
BLANKS = st.sampled_from(["", " ", "\n", "\r\n\t", "<!-- ä > </a> -->", "<?pi > ?>"])
TEXTS = st.sampled_from(["", "1 2 3", " ü ", "<![CDATA[<b>]]>", "&lt;&#228;"])
ATTRIBUTES = st.sampled_from(["", ' name="x"', " name='a>b'", ' x="/>" name="y" '])


@st.composite
def elements(draw, depth=0):
    """Draw the text of an element, as odd as XML allows."""
    tag, attributes = draw(st.sampled_from("abc")), draw(ATTRIBUTES)
    if draw(st.booleans()) and depth:
        return f"<{tag}{attributes}/>"
    inner = draw(TEXTS) + draw(BLANKS)
    for _ in range(draw(st.integers(0, 3)) if depth < 3 else 0):
        inner += draw(elements(depth + 1)) + draw(BLANKS)
    return f"<{tag}{attributes}>{inner}</{tag} >"


def documents():
    """Draw whole documents, with and without a mark of the encoding and a declaration."""
    starts = st.sampled_from(["", "\ufeff", '<?xml version="1.0" encoding="UTF-8"?>\r\n'])
    return st.tuples(starts, elements()).map(lambda parts: "".join(parts).encode())


def as_tree(element: ET.Element):
    """Return what another parser finds, for comparison."""
    text = (element.text or "") + "".join(child.tail or "" for child in element)
    return element.tag, dict(element.attrib), text, [as_tree(child) for child in element]


def as_found(element):
    children = [as_found(child) for child in element.children]
    return element.tag, dict(element.attributes), element.text, children


@given(documents())
def test_elements_are_those_of_another_parser_and_know_their_bytes(data):
    document = read_document(PLACE, data)
    root, text = document.root, document.text
    assert as_found(root) == as_tree(ET.fromstring(data.decode("utf-8-sig").encode()))
    for element in root.walk():
        whole = text[element.begin : element.end]
        assert as_found(read_document(PLACE, whole).root) == as_found(element)
        inner = text[element.inner : element.close]
        assert element.is_closed or text[element.close :].startswith(b"</")
        assert b"/>" in text[element.inner - 2 : element.inner] or not element.is_closed
        assert inner in whole
    assert Splicer(document).spliced() == data


@given(documents(), st.data())
def test_an_edited_property_reads_back_and_everything_else_stays(data, draw):
    document = read_document(PLACE, data)
    root = document.root
    chosen = draw.draw(st.sampled_from(list(root.walk())))
    splicer = Splicer(document)
    splicer.set_text(chosen, "a", "R & D < 3")
    again = read_document(PLACE, splicer.spliced()).root
    number = [e.number for e in root.walk()].index(chosen.number)
    edited = list(again.walk())[number]
    assert edited.child("a").text == "R & D < 3"
    before, after = as_found(root), as_found(again)
    if chosen.child("a") is None:
        # What was put in is all that is new.
        assert len(edited.children) == len(chosen.children) + 1
        assert [as_found(x) for x in edited.children[1:]] == [as_found(x) for x in chosen.children]
    assert before[0] == after[0]
    assert before[1] == after[1]


@pytest.mark.parametrize("name", NAMES)
def test_a_model_that_is_not_edited_is_written_to_the_byte(name):
    data = model_file(name).read_bytes()
    assert Splicer(read_document(PLACE, data)).spliced() == data


def test_line_ends_tabs_and_comments_stay_around_what_is_put_in():
    data = b"<Model>\r\n\t<Point name='p'>\r\n\t\t<!-- where -->\r\n\t</Point>\r\n</Model>"
    document = read_document(PLACE, data)
    splicer = Splicer(document)
    splicer.set_numbers(document.root.children[0], "location", [1, 0.5, -0.0])
    assert splicer.spliced() == data.replace(
        b"'p'>", b"'p'>\r\n\t\t<location>1.0 0.5 0.0</location>"
    )


@pytest.mark.parametrize(
    ("data", "line", "words"),
    [
        (b"<!DOCTYPE a><a/>", 1, "document type"),
        (b'<!DOCTYPE a [<!ENTITY x "y">]>\n<a>&x;</a>', 1, "document type"),
        (b"<a>\n<b file='more.xml'/></a>", 2, "another file, 'more.xml'"),
        (b"<a>\n" + 101 * b"<b>" + 101 * b"</b>" + b"</a>", 2, "nested too deeply"),
        (b"<a>\n<b></a>", 2, "not XML"),
        (b"<a>", 1, "cut off"),
        (b"<?xml version='1.0' encoding='cp500'?><a/>", 1, "encoding"),
        (b"<?xml version='1.0' encoding='nonsense'?><a/>", 1, "nonsense"),
        ("<a/>".encode("utf-16"), None, "UTF-16"),
        ("<a/>".encode("utf-16-le"), None, "UTF-16"),
        ("<a/>".encode("utf-32"), None, "UTF-16 or UTF-32"),
    ],
)
def test_what_cannot_be_edited_safely_is_refused_with_its_line(data, line, words):
    with pytest.raises(FileFormatError, match=words) as found:
        read_document(PLACE, data)
    assert found.value.line == line


def test_more_elements_than_a_model_has_are_refused(monkeypatch):
    monkeypatch.setattr("pinwarp.io.osim.document.MOST_ELEMENTS", 10)
    with pytest.raises(FileFormatError, match="more than 10 elements"):
        read_document(PLACE, b"<a>" + 11 * b"<b/>" + b"</a>")


@pytest.mark.parametrize("encoding", ["ISO-8859-1", "windows-1252", "us-ascii", "UTF-8"])
def test_an_encoding_that_holds_ascii_as_it_is_is_kept(encoding):
    word = "u" if encoding == "us-ascii" else "üß"
    text = f"<?xml version='1.0' encoding='{encoding}'?><a name='{word}'><b>{word}</b><c>2</c></a>"
    data = text.encode(encoding)
    document = read_document(PLACE, data)
    assert (document.root.name, document.root.child("b").text) == (word, word)
    splicer = Splicer(document)
    assert splicer.spliced() == data
    splicer.set_text(document.root, "c", "ä")
    assert splicer.spliced() == text.replace("<c>2", "<c>&#228;").encode(encoding)


def test_blanks_before_the_document_stay_and_count_as_lines():
    data = b"\xef\xbb\xbf\n\n <a>\n<b>1</b></a>"
    document = read_document(PLACE, data)
    assert document.root.child("b").line == 4
    splicer = Splicer(document)
    splicer.set_numbers(document.root, "b", 2)
    assert splicer.spliced() == data.replace(b"1", b"2.0")
    with pytest.raises(FileFormatError) as found:
        read_document(PLACE, b"\n\n<a>\n<b></a>")
    assert found.value.line == 4


def test_bytes_that_are_not_of_the_encoding_are_told_with_their_line():
    with pytest.raises(FileFormatError, match="not in the encoding utf-8") as found:
        read_document(PLACE, b"<a>\n\xff</a>")
    assert found.value.line == 2
