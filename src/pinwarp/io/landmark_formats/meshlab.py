"""MeshLab's picked points, ``.pp``, an XML file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.careful_xml import XmlError, parse_xml
from pinwarp.io.csv_cells import YES_NO, as_sentence, coordinates_text, shortened
from pinwarp.io.landmark_formats.lines import landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written

NAME = "MeshLab .pp"
SUFFIXES = (".pp",)
HOLDS = Holds()

_SIGNATURE = re.compile(r"<(!DOCTYPE\s+)?PickedPoints\b")
_AGAIN = "Save it again in MeshLab."


def matches(head: str) -> bool:
    """Whether the first element is that of picked points.

    Examples
    --------
    >>> matches("<!DOCTYPE PickedPoints>"), matches("<html>")
    (True, False)
    """
    return _SIGNATURE.search(head) is not None


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    """Read picked points; those that are not active have no position.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it; see :func:`~pinwarp.io.careful_xml.parse_xml`.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        The format says neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When it is not XML, or no landmark could be read.

    Examples
    --------
    >>> text = '<PickedPoints><point y="2" x="1" z="3" active="1" name="p1"/></PickedPoints>'
    >>> read("a.pp", text, Side.SOURCE).landmarks[0].source
    (1.0, 2.0, 3.0)
    """
    gathering = Gathering(path)
    lines = text.split("\n")
    number = 0

    def begin(tag: str, attributes: Mapping[str, str], line: int) -> None:
        nonlocal number
        if tag == "point":
            words = lines[line - 1] if line <= len(lines) else ""
            gathering.take(line, words, _landmark, attributes, side, DefaultName.of(number))
            number += 1

    try:
        parse_xml(text, begin)
    except XmlError as error:
        raise FileFormatError(path, f"{as_sentence(str(error))} {_AGAIN}", error.line) from None
    return gathering.reading(
        NAME, 'points as in: <point x="1.5" y="2" z="-3" active="1" name="fovea"/>'
    )


def _landmark(attributes: Mapping[str, str], side: Side, default: str) -> Landmark:
    text = attributes.get("active", "1").strip().lower()
    active = YES_NO.get(text)
    if active is None:
        raise ValueError(f"'active' is {shortened(text)} and not 1 or 0")
    words = [attributes.get(axis, "").strip() for axis in "xyz"]
    position = three_numbers(words) if active else None
    return landmark_on(side, attributes.get("name", "").strip() or default, position)


def text_of(outgoing: Outgoing) -> Written:
    """Return the picked points of one side; those that are not placed are not active.

    Parameters
    ----------
    outgoing
        The landmarks.

    Examples
    --------
    >>> print(text_of(Outgoing((Landmark("a & b", (1, 2, 3)),))).text, end="")
    <!DOCTYPE PickedPoints>
    <PickedPoints>
     <point x="1.0" y="2.0" z="3.0" active="1" name="a &amp; b"/>
    </PickedPoints>
    """
    lines = ["<!DOCTYPE PickedPoints>\n", *map(_comment, outgoing.remarks), "<PickedPoints>\n"]
    for landmark, position in zip(outgoing.landmarks, outgoing.places, strict=True):
        x, y, z = coordinates_text(position or (0.0, 0.0, 0.0))
        # Two characters that XML does not know at all.
        name = re.sub("[\ufffe\uffff]", "\ufffd", one_line(landmark.name))
        name = quoteattr(name, {'"': "&quot;"})
        active = int(position is not None)
        lines.append(f' <point x="{x}" y="{y}" z="{z}" active="{active}" name={name}/>\n')
    return Written("".join([*lines, "</PickedPoints>\n"]))


def _comment(remark: str) -> str:
    # Two dashes would end it.
    return f"<!-- {one_line(remark).replace('--', '- -')} -->\n"
