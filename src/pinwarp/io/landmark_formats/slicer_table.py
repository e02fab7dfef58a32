"""3D Slicer's table of control points, which it recommends instead of ``.fcsv``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import (
    YES_NO,
    coordinates_text,
    formula_unquoted,
    position_of,
    shortened,
)
from pinwarp.io.csv_text import Row, csv_line
from pinwarp.io.landmark_formats.lines import landmark_on, one_line
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.table import Table, table_of
from pinwarp.io.landmark_formats.table_header import words_of
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, in_millimetres

NAME = "3D Slicer control-point table"
SUFFIXES = (".slicer.csv", ".slicer.tsv")
HOLDS = Holds(notes=True, locks=True, switches=True, frame="LPS", unit="mm")

_COLUMNS = ["label", "l", "p", "s", "defined", "selected", "visible", "locked", "description"]
_FRAMES = {"RAS": ("r", "a", "s"), "LPS": ("l", "p", "s")}


def matches(head: str) -> bool:
    """Whether the first row names a label and r, a, s or l, p, s.

    Examples
    --------
    >>> matches("label,r,a,s,defined"), matches("label,x,y,z")
    (True, False)
    """
    return _frame_of(table_of(head)) != ""


def _frame_of(table: Table) -> str:
    """Return the frame that the header says; empty where this is no such table."""
    words = {word.lower() for word in words_of(table.rows[0].cells)} if table.rows else set()
    found = [frame for frame, axes in _FRAMES.items() if set(axes) <= words]
    return found[0] if found and "label" in words else ""


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read control points, positions as they are stored.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it: a row of column names, and a row for each point.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        Points that are not defined come without a position; description, locked and selected are
        note, locked and enabled. The header says the frame, and the unit is the millimetre.

    Raises
    ------
    FileFormatError
        When no landmark could be read.

    Examples
    --------
    >>> text = "label,r,a,s,defined,selected\nnasion,1,2,3,1,1\ninion,0,0,0,0,1\n"
    >>> reading = read("a.csv", text, Side.SOURCE)
    >>> reading.frame, [landmark.source for landmark in reading.landmarks]
    ('RAS', [(1.0, 2.0, 3.0), None])
    """
    table = table_of(text)
    frame = _frame_of(table)
    if not frame:
        raise FileFormatError(path, f"Its first row should be: {','.join(_COLUMNS)}.", 1)
    columns = [word.lower() for word in words_of(table.rows[0].cells)]
    gathering = Gathering(path)
    for number, row in enumerate(table.rows[1:]):
        default = DefaultName.of(number)
        values = dict(zip(columns, (*row.cells, *[""] * len(columns)), strict=False))
        gathering.take(row.line, row.text, _landmark, row, values, table, side, default)
    return gathering.reading(NAME, f"columns as in: {','.join(_COLUMNS)}", frame=frame, unit="mm")


def _landmark(
    row: Row, values: Mapping[str, str], table: Table, side: Side, default: DefaultName
) -> Landmark:
    if row.problem:
        raise ValueError(row.problem)
    axes = next(axes for axes in _FRAMES.values() if set(axes) <= set(values))
    position = position_of([values[axis] for axis in axes], table.decimals)
    if not _yes(values, "defined", otherwise=True):
        position = None
    name = formula_unquoted(values.get("label", "").strip())
    return replace(
        landmark_on(side, name or default, position),
        note=one_line(formula_unquoted(values.get("description", "").strip())),
        enabled=_yes(values, "selected", otherwise=True),
        locked=_yes(values, "locked", otherwise=False),
    )


def _yes(values: Mapping[str, str], column: str, *, otherwise: bool) -> bool:
    word = values.get(column, "").strip().lower()
    if not word:
        return otherwise
    if word not in YES_NO:
        raise ValueError(f"{column!r} is {shortened(word)} and not 1 or 0")
    return YES_NO[word]


def text_of(outgoing: Outgoing) -> Written:
    """Return the table of one side: in LPS and millimetres, as the other files for Slicer.

    Parameters
    ----------
    outgoing
        Those that have no position on the side are not defined.

    Raises
    ------
    LandmarkError
        When the unit is none that can be converted.

    Examples
    --------
    >>> print(text_of(Outgoing((Landmark("nasion", (0.5, 0, 1)),), unit="m")).text, end="")
    label,l,p,s,defined,selected,visible,locked,description
    nasion,500.0,0.0,1000.0,1,1,1,0,
    """
    placed = replace(outgoing, landmarks=in_millimetres(outgoing.landmarks, outgoing.unit))
    lines = [csv_line(_COLUMNS)]
    for landmark, position in zip(placed.landmarks, placed.places, strict=True):
        cells = [
            one_line(landmark.name).strip(),
            *coordinates_text(position or (0.0, 0.0, 0.0)),
            "0" if position is None else "1",
            "1" if landmark.enabled else "0",
            "1",
            "1" if landmark.locked else "0",
            one_line(landmark.note).strip(),
        ]
        lines.append(csv_line(cells))
    return Written("".join(lines))
