"""Tables of names and numbers between blanks, as many small programs write them."""

from __future__ import annotations

import re
from pathlib import Path

from pinwarp.core.landmarks import Side
from pinwarp.io.csv_text import csv_line
from pinwarp.io.landmark_formats.lines import one_line
from pinwarp.io.landmark_formats.reading import LandmarkReading
from pinwarp.io.landmark_formats.table import BLANK, table_of
from pinwarp.io.landmark_formats.table_reading import read_table
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, numbers_text, placed_only

NAME = "Table between blanks"
SUFFIXES = (".xyz",)
HOLDS = Holds(empty=False)

# Everything else would be taken for more than one cell, or a comment.
_PLAIN = re.compile(r"\w[^\s\"#,;]*")


def matches(head: str) -> bool:
    """Whether lines hold three numbers between blanks.

    Examples
    --------
    >>> matches("nasion 1.5 2 3"), matches("nasion,1.5,2,3")
    (True, False)
    """
    return table_of(head).separator == BLANK


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read a table of one side, or of pairs.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it: a count or a header, where there is one, then a line for each landmark: a
        name, in front or behind, and its numbers, or numbers alone.
    side
        The side that a table of one side belongs to.

    Raises
    ------
    FileFormatError
        When no landmark could be read.

    Examples
    --------
    >>> reading = read("a.xyz", "2\nleft tragus 1 2 3\nnasion 4 5 6\n", Side.SOURCE)
    >>> reading.names, reading.landmarks[1].source
    (('left tragus', 'nasion'), (4.0, 5.0, 6.0))
    """
    return read_table(path, table_of(text), side, NAME, "lines as in: nasion 1.5 2 -3")


def text_of(outgoing: Outgoing) -> Written:
    """Return a line for each landmark: its name, in quotes where it needs them, and its place.

    Parameters
    ----------
    outgoing
        Those that have no position on the side are left out.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> marks = (Landmark("nasion", (1, 2, 3)), Landmark("left tragus", (4, 5, 6)))
    >>> print(text_of(Outgoing(marks)).text, end="")
    nasion 1.0 2.0 3.0
    "left tragus" 4.0 5.0 6.0
    """
    assert outgoing.side is not None, "pairs are refused before"
    placed, notes = placed_only(outgoing.landmarks, outgoing.side)
    lines = [f"{_quoted(name)} {numbers_text(position, '')}\n" for name, position in placed]
    return Written("".join(lines), notes)


def _quoted(name: str) -> str:
    name = " ".join(one_line(name).split())
    return name if _PLAIN.fullmatch(name) else csv_line([name], all_in_quotes=True).rstrip("\n")
