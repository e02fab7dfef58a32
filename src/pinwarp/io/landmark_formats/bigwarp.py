"""BigWarp's landmarks: pairs without a header, every cell in quotes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

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
from pinwarp.io.landmark_formats.reading import Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Written
from pinwarp.io.text import lines_of

NAME = "BigWarp CSV"
SUFFIXES = (".bigwarp.csv",)
HOLDS_PAIRS = True

_MISSING = re.compile(r"[+-]?inf(inity)?", re.IGNORECASE)


def matches(head: str) -> bool:
    """Whether the first row has a name, true or false, and six numbers.

    Examples
    --------
    >>> matches('"Pt-0","true","1","2","3","4","5","6"'), matches("Pt-0,1,2,3,4,5,6")
    (True, False)
    """
    for row in rows_of(lines_of(head)[:20], ","):
        if not row.is_blank:
            return len(row.cells) in (8, 9) and row.cells[1].strip().lower() in ("true", "false")
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
    for number, row in enumerate(rows):
        gathering.take(row.line, row.text, _landmark, row, f"landmark_{number}")
    return gathering.reading(
        NAME, 'lines as in: "Pt-0","true","1.5","2","3","4.5","5","6"', is_pairs=True
    )


def _landmark(row: Row, default: str) -> Landmark:
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
    landmark = Landmark(checked_name(formula_unquoted(cells[0])) or default, source, destination)
    return replace(landmark, enabled=active or not landmark.is_complete)


def _position(cells: Sequence[str]) -> Position | None:
    if all(_MISSING.fullmatch(cell) for cell in cells):
        return None
    return position_of(cells, ",")


def text_of(landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str) -> Written:
    """Return the rows of pairs; those of one side have the other one missing.

    Parameters
    ----------
    landmarks
        The landmarks.
    side
        The only side to write, or None for both.
    unit, title
        Not used: the format has a place for neither.

    Examples
    --------
    >>> print(text_of([Landmark("a", (1, 2, 3), (4, 5, 6))], None, "mm", "").text, end="")
    "a","true","1.0","2.0","3.0","4.0","5.0","6.0"
    """
    del unit, title
    lines = []
    for landmark in landmarks:
        if side is not None:
            landmark = landmark.placed(side.other, None)
        # An active row without both positions would stop BigWarp's solver.
        active = landmark.enabled and landmark.is_complete
        cells = [one_line(landmark.name).strip(), "true" if active else "false"]
        for position in (landmark.source, landmark.destination):
            cells += coordinates_text(position) if position is not None else ["Infinity"] * 3
        lines.append(csv_line(cells, all_in_quotes=True))
    return Written("".join(lines))
