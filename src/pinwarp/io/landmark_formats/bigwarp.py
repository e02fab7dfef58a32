"""BigWarp's landmarks: pairs without a header, every cell in quotes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.csv_cells import (
    YES_NO,
    coordinates_text,
    formula_unquoted,
    position_of,
    shortened,
)
from pinwarp.io.csv_text import Row, csv_line, rows_of
from pinwarp.io.landmark_formats.lines import checked_name, one_line
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written
from pinwarp.io.text import lines_of

NAME = "BigWarp CSV"
SUFFIXES = (".bigwarp.csv",)
HOLDS = Holds(pairs=True, switches=True)

# Cells of a row in two dimensions, without and with a number behind the second.
_FLAT = (6, 7)
_MISSING = re.compile(r"[+-]?inf(inity)?", re.IGNORECASE)


def matches(head: str) -> bool:
    """Whether the first row has a name, true or false, and six numbers, or four.

    Examples
    --------
    >>> matches('"Pt-0","true","1","2","3","4","5","6"'), matches("Pt-0,1,2,3,4,5,6")
    (True, False)
    """
    for row in rows_of(lines_of(head)[:20], ","):
        if not row.is_blank:
            is_switch = row.cells[1:2] and row.cells[1].strip().lower() in ("true", "false")
            return bool(is_switch) and len(row.cells) in (*_FLAT, 8, 9)
    return False


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read pairs: what moves is the source, what is fixed is the destination.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it: rows of eight cells, or nine with a number behind the second.
    side
        Not used: both sides are in the file.

    Returns
    -------
    LandmarkReading
        ``Infinity`` is a position that is missing. A complete pair that is not active is
        disabled; BigWarp switches every half pair off, so that says nothing.

    Raises
    ------
    FileFormatError
        When no landmark could be read.

    Examples
    --------
    >>> text = '"Pt-0","false","1","2","3","Infinity","Infinity","Infinity"\n'
    >>> reading = read("landmarks.csv", text, Side.SOURCE)
    >>> reading.landmarks[0].source, reading.landmarks[0].destination
    ((1.0, 2.0, 3.0), None)
    """
    del side
    gathering = Gathering(path)
    rows = [row for row in rows_of(lines_of(text), ",") if not row.is_blank]
    if rows and all(len(row.cells) in _FLAT for row in rows):
        raise FileFormatError(
            path,
            "These landmarks of BigWarp have two dimensions. Three are needed.",
            rows[0].line,
        )
    for number, row in enumerate(rows):
        gathering.take(row.line, row.text, _landmark, row, DefaultName.of(number))
    return gathering.reading(
        NAME, 'lines as in: "Pt-0","true","1.5","2","3","4.5","5","6"', is_pairs=True
    )


def _landmark(row: Row, default: DefaultName) -> Landmark:
    if row.problem:
        raise ValueError(row.problem)
    cells = [cell.strip() for cell in row.cells]
    if len(cells) == 9:
        del cells[2]
    if len(cells) != 8:
        raise ValueError(f"it needs 8 cells and has {len(cells)}: are these two dimensions?")
    active = YES_NO.get(cells[1].lower())
    if active is None:
        raise ValueError(f"the second cell is {shortened(cells[1])} and not true or false")
    source, destination = _position(cells[2:5]), _position(cells[5:8])
    return made(formula_unquoted(cells[0]), source, destination, default, active=active)


def made(
    name: str,
    source: Position | None,
    destination: Position | None,
    default: DefaultName,
    *,
    active: bool,
) -> Landmark:
    """Return a landmark of BigWarp, which switches every half pair off: that says nothing."""
    landmark = Landmark(checked_name(name) or default, source, destination)
    return replace(landmark, enabled=active or not landmark.is_complete)


def is_active(landmark: Landmark) -> bool:
    """Whether a landmark may take part: an active half pair would stop BigWarp's solver."""
    return landmark.enabled and landmark.is_complete


def _position(cells: Sequence[str]) -> Position | None:
    if all(_MISSING.fullmatch(cell) for cell in cells):
        return None
    return position_of(cells, ",")


def text_of(outgoing: Outgoing) -> Written:
    """Return the rows of pairs; those of one side have the other one missing.

    Parameters
    ----------
    outgoing
        The landmarks.

    Examples
    --------
    >>> pair = Landmark("a", (1, 2, 3), (4, 5, 6))
    >>> print(text_of(Outgoing((pair,), None)).text, end="")
    "a","true","1.0","2.0","3.0","4.0","5.0","6.0"
    """
    lines = []
    for landmark in outgoing.landmarks:
        if outgoing.side is not None:
            landmark = landmark.placed(outgoing.side.other, None)
        cells = [one_line(landmark.name).strip(), "true" if is_active(landmark) else "false"]
        for position in (landmark.source, landmark.destination):
            cells += coordinates_text(position) if position is not None else ["Infinity"] * 3
        lines.append(csv_line(cells, all_in_quotes=True))
    return Written("".join(lines))
