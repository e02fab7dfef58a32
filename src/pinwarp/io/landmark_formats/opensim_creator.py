"""OpenSim Creator's landmark CSV: one file per mesh, or pairs in one file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import Enum
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import (
    coordinates_text,
    formula_unquoted,
    is_number,
    position_of,
)
from pinwarp.io.csv_text import Row, csv_line, rows_of, separator_of
from pinwarp.io.landmark_formats.lines import checked_name
from pinwarp.io.landmark_formats.reading import Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Written, placed_only
from pinwarp.io.text import lines_of

NAME = "OpenSim Creator CSV"
SUFFIXES = (".csv", ".txt")
HOLDS_PAIRS = True

_SIDE_HEADER = ("name", "x", "y", "z")
_PAIRS_HEADER = ("name", "source.x", "source.y", "source.z", "dest.x", "dest.y", "dest.z")
_LINES_LOOKED_AT = 50


class _Columns(Enum):
    """What the columns hold."""

    SIDE = "three numbers, or a name and three numbers; each row by itself"
    NAMED_SIDE = "a name and three numbers"
    PAIR = "six numbers"
    NAMED_PAIR = "a name and six numbers"


def matches(head: str) -> bool:
    """Whether a text begins as a table: a header, or lines with three numbers.

    Examples
    --------
    >>> matches("fovea;1,5;2;3"), matches("Version 1.0")
    (True, False)
    """
    lines = [line for line in lines_of(head)[:_LINES_LOOKED_AT] if not line.startswith("#")][:10]
    separator = separator_of(lines)
    for row in rows_of(lines, separator):
        cells = row.cells
        if len(cells) > 2 and sum(is_number(cell, separator) for cell in cells) > 2:
            return True
        if {"x", "y", "z"} <= {cell.strip().lower().rpartition(".")[2] for cell in cells}:
            return True
    return False


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
    lines = lines_of(text)
    head = [line for line in lines[:_LINES_LOOKED_AT] if not line.startswith("#")]
    separator = separator_of(head[:10])
    rows = [row for row in rows_of(lines, separator) if not row.is_blank]
    # A quoted "#1" is a name; only a bare # makes a comment.
    comments = [row for row in rows if row.text.startswith("#")]
    rows = [row for row in rows if not row.text.startswith("#")]
    columns, has_header = _columns_of(rows, separator)
    gathering = Gathering(path)
    for row in comments:
        if len(row.cells) > 3 and all(is_number(cell, separator) for cell in row.cells[1:4]):
            reason = "it starts with #, which makes it a comment"
            gathering.skip(row.line, row.text, reason)
    for number, row in enumerate(rows[has_header:]):
        default = f"landmark_{number}"
        gathering.take(row.line, row.text, _landmark, row, columns, separator, side, default)
    return gathering.reading(
        NAME,
        "lines of a name and three numbers, as in: fovea,1.5,2,-3",
        is_pairs=columns in (_Columns.PAIR, _Columns.NAMED_PAIR),
    )


def _columns_of(rows: Sequence[Row], separator: str) -> tuple[_Columns, bool]:
    """Find out what the columns are, and whether the first row is a header."""
    head = _trimmed(rows[0].cells) if rows else ()
    # A header has no number where the coordinates belong.
    if len(head) > 2 and not any(is_number(cell, separator) for cell in _after_name(head)):
        words = [cell.strip().lower() for cell in head]
        if sum(word.startswith(("source", "dest")) for word in words) >= 6:
            return (_Columns.PAIR if words[0].startswith("source") else _Columns.NAMED_PAIR), True
        return (_Columns.SIDE if len(head) == 3 else _Columns.NAMED_SIDE), True
    for row in rows:
        numbers = [is_number(cell, separator) for cell in row.cells]
        if len(numbers) == 6 and all(numbers):
            return _Columns.PAIR, False
        if len(numbers) == 7 and all(numbers[1:]):
            return _Columns.NAMED_PAIR, False
    return _Columns.SIDE, False


def _landmark(row: Row, columns: _Columns, separator: str, side: Side, default: str) -> Landmark:
    """Make a landmark of one row, or raise a ValueError with the reason."""
    if row.problem:
        raise ValueError(row.problem)
    cells = _trimmed(row.cells)
    if columns in (_Columns.PAIR, _Columns.NAMED_PAIR):
        # The empty half of a pair may have lost its separators.
        cells = (*cells, *[""] * 7)
        name = default if columns is _Columns.PAIR else cells[0]
        numbers = cells[:6] if columns is _Columns.PAIR else cells[1:7]
        source = position_of(numbers[:3], separator)
        destination = position_of(numbers[3:], separator)
    else:
        named = columns is _Columns.NAMED_SIDE or len(cells) != 3
        name = cells[0] if named else default
        if len(cells) < 3 + named:
            raise ValueError("it needs three coordinates")
        position = position_of(cells[1:4] if named else cells, separator)
        if position is None:
            raise ValueError("it has no coordinates")
        source, destination = (position, None) if side is Side.SOURCE else (None, position)
    name = checked_name(formula_unquoted(name.strip())) or default
    return Landmark(name, source=source, destination=destination)


def _trimmed(cells: Sequence[str]) -> tuple[str, ...]:
    """Return the cells without the empty ones at the end, which spreadsheets add."""
    end = len(cells)
    while end and not cells[end - 1].strip():
        end -= 1
    return tuple(cells[:end])


def _after_name(cells: Sequence[str]) -> Sequence[str]:
    """Return the cells that hold coordinates: three columns have no name."""
    return cells if len(cells) == 3 else cells[1:]


def text_of(landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str) -> Written:
    """Return the file of one side, or of pairs.

    Parameters
    ----------
    landmarks
        Those that have no position on the side are left out; in pairs, what is not placed
        yet stays empty.
    side
        The side to write, or None for pairs.
    unit, title
        Not used: the format has a place for neither.

    Examples
    --------
    >>> landmarks = [Landmark("fovea", (1, 2, 0.1)), Landmark("unset")]
    >>> written = text_of(landmarks, Side.SOURCE, "m", "femur")
    >>> print(written.text, *written.notes, end="")
    name,x,y,z
    fovea,1.0,2.0,0.1
     1 landmark that is not placed was left out.
    >>> print(text_of([Landmark("fovea", (1, 2, 3))], None, "m", "femur").text, end="")
    name,source.x,source.y,source.z,dest.x,dest.y,dest.z
    fovea,1.0,2.0,3.0,,,
    """
    del unit, title
    if side is None:
        pairs = [
            (x.name, *coordinates_text(x.source), *coordinates_text(x.destination))
            for x in landmarks
        ]
        return Written(_table(_PAIRS_HEADER, pairs))
    placed, notes = placed_only(landmarks, side)
    rows = [(name, *coordinates_text(position)) for name, position in placed]
    return Written(_table(_SIDE_HEADER, rows), notes)


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    return "".join(map(csv_line, [header, *rows]))
