"""OpenSim Creator's landmark CSV: one file per mesh, or pairs in one file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from pinwarp.core.landmarks import Side
from pinwarp.io.csv_cells import coordinates_text
from pinwarp.io.csv_text import csv_line
from pinwarp.io.landmark_formats.reading import LandmarkReading
from pinwarp.io.landmark_formats.table import table_of
from pinwarp.io.landmark_formats.table_header import axes_in, words_of
from pinwarp.io.landmark_formats.table_reading import read_table
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, placed_only

NAME = "OpenSim Creator CSV"
SUFFIXES = (".csv", ".txt")
HOLDS = Holds(pairs=True, empty=False)

_SIDE_HEADER = ("name", "x", "y", "z")
_PAIRS_HEADER = ("name", "source.x", "source.y", "source.z", "dest.x", "dest.y", "dest.z")


def matches(head: str) -> bool:
    """Whether a text begins as a table: a header, or lines with three numbers.

    Examples
    --------
    >>> matches("fovea;1,5;2;3"), matches("Version 1.0")
    (True, False)
    """
    table = table_of(head)
    return any(
        table.numbers_in(row) > 2 or axes_in(words_of(row.cells))[0] for row in table.rows[:10]
    )


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read a file of one side, or of pairs, whichever it is.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it. Its header may be in any case or missing; cells may be separated by
        commas, semicolons (then with decimal commas, too) or tabs.
    side
        The side that a file of one side belongs to; a file of pairs fills both.

    Returns
    -------
    LandmarkReading
        Landmarks without a name are called ``landmark_0``, ``landmark_1`` and so on by their
        row, so that two nameless files still match where one has a bad row. Blanks around a
        name are dropped. The format says neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When no landmark could be read.

    Examples
    --------
    >>> text = "Name,X,Y,Z\nfovea,1,2,3\nfar,1,2,nan\n"
    >>> reading = read("femur.landmarks.csv", text, Side.SOURCE)
    >>> reading.landmarks[0].source
    (1.0, 2.0, 3.0)
    >>> reading.skipped
    (SkippedLine(line=3, text='far,1,2,nan', reason="'nan' is not a finite number"),)
    """
    return read_table(
        path,
        table_of(text),
        side,
        NAME,
        "lines of a name and three numbers, as in: fovea,1.5,2,-3",
    )


def text_of(outgoing: Outgoing) -> Written:
    """Return the file of one side, or of pairs.

    Parameters
    ----------
    outgoing
        Those that have no position on the side are left out; in pairs, what is not placed
        yet stays empty.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> written = text_of(Outgoing((Landmark("fovea", (1, 2, 0.1)), Landmark("unset"))))
    >>> print(written.text, *written.notes, end="")
    name,x,y,z
    fovea,1.0,2.0,0.1
     1 landmark that is not placed was left out.
    >>> print(text_of(Outgoing((Landmark("fovea", (1, 2, 3)),), None)).text, end="")
    name,source.x,source.y,source.z,dest.x,dest.y,dest.z
    fovea,1.0,2.0,3.0,,,
    """
    if outgoing.side is None:
        pairs = [
            (x.name, *coordinates_text(x.source), *coordinates_text(x.destination))
            for x in outgoing.landmarks
        ]
        return Written(_table(_PAIRS_HEADER, pairs))
    placed, notes = placed_only(outgoing.landmarks, outgoing.side)
    rows = [(name, *coordinates_text(position)) for name, position in placed]
    return Written(_table(_SIDE_HEADER, rows), notes)


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    return "".join(map(csv_line, [header, *rows]))
