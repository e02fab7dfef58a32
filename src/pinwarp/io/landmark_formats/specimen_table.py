"""Tables with a row for each specimen, as MorphoJ and SlicerMorph keep them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import coordinates_text, formula_unquoted, position_of
from pinwarp.io.csv_text import Row, csv_line
from pinwarp.io.landmark_formats.lines import landmark_on, one_line
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.specimens import (
    FIRST,
    chosen,
    named_specimens,
    specimen_notes,
)
from pinwarp.io.landmark_formats.table import Table, table_of
from pinwarp.io.landmark_formats.table_header import (
    TIMES,
    Axes,
    Triple,
    specimens_of,
    words_of,
)
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written

NAME = "Table of specimens (MorphoJ)"
SUFFIXES = (".morphoj.csv",)
HOLDS = Holds()

_MISSING = ("na", "nan")


def matches(head: str) -> bool:
    """Whether the first row names x, y and z of several landmarks.

    Examples
    --------
    >>> matches("Id,x1,y1,z1,x2,y2,z2"), matches("name,x,y,z")
    (True, False)
    """
    rows = table_of(head).rows
    return bool(rows) and bool(specimens_of(rows[0].cells))


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read the landmarks of the first specimen; see :func:`read_specimen`.

    Examples
    --------
    >>> text = "Id,x1,y1,z1,x2,y2,z2\nfem01,1,2,3,4,5,6\n"
    >>> read("a.csv", text, Side.SOURCE).landmarks[1].source
    (4.0, 5.0, 6.0)
    """
    return read_specimen(path, text, side, FIRST)


def read_specimen(path: str | Path, text: str, side: Side, which: str) -> LandmarkReading:
    r"""Read the landmarks of one row.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it; an empty cell, ``NA`` or ``NaN`` is missing.
    side
        The side the landmarks belong to.
    which
        The specimen, by what stands in its first column, or by number.

    Returns
    -------
    LandmarkReading
        Called as the columns are; where these are only numbered, ``landmark_0`` and so on. The
        format says neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When there is no such specimen, or no landmark could be read.
    """
    table = table_of(text)
    axes = specimens_of(table.rows[0].cells) if table.rows else ()
    body = table.rows[1:]
    if not axes or not body:
        raise FileFormatError(
            path, "There is no row of a specimen below the names of the columns.", 1
        )
    title = _title_column(axes, len(table.rows[0].cells))
    names = named_specimens([_title(row, title) for row in body])
    number = chosen(path, names, which)
    row = body[number]
    gathering = Gathering(path)
    for place, one in enumerate(axes):
        default = DefaultName.of(place)
        words = f"{one.of}: {row.text}"
        gathering.take(row.line, words, _landmark, row, one, table, side, default)
    over_time = [word for word in words_of(table.rows[0].cells) if word.lower() in TIMES]
    doubts = [f"It has a column {x!r}, as recordings over time have." for x in over_time[:1]]
    reading = gathering.reading(
        NAME,
        f"a row of numbers for each specimen below {','.join(words_of(table.rows[0].cells)[:7])}",
        notes=specimen_notes(names, which),
        doubts=doubts,
    )
    return replace(reading, specimens=names, specimen=names[number])


def _title_column(axes: tuple[Axes, ...], width: int) -> int | None:
    """Return the first column that is no coordinate."""
    used = {column for one in axes for column in one.places}
    return next((column for column in range(width) if column not in used), None)


def _title(row: Row, column: int | None) -> str:
    if column is None or column >= len(row.cells):
        return ""
    return one_line(formula_unquoted(row.cells[column].strip()))


def _landmark(row: Row, axes: Axes, table: Table, side: Side, default: DefaultName) -> Landmark:
    if row.problem:
        raise ValueError(row.problem)
    name = default if axes.is_numbered else axes.of.strip() or default
    return landmark_on(side, name, _place(row, axes.places, table))


def _place(row: Row, places: Triple, table: Table) -> tuple[float, float, float] | None:
    if max(places) >= len(row.cells):
        raise ValueError("its row ends before it: was it cut off?")
    cells = [row.cells[column] for column in places]
    if all(cell.strip().lower() in _MISSING for cell in cells):
        return None
    return position_of(cells, table.decimals)


def text_of(outgoing: Outgoing) -> Written:
    """Return a table of one specimen.

    Parameters
    ----------
    outgoing
        Where one is not placed, its cells stay empty.

    Examples
    --------
    >>> marks = (Landmark("nasion", (1, 2, 3)), Landmark("inion"))
    >>> print(text_of(Outgoing(marks, title="skull")).text, end="")
    Id,nasion_x,nasion_y,nasion_z,inion_x,inion_y,inion_z
    skull,1.0,2.0,3.0,,,
    """
    header, row = ["Id"], [one_line(outgoing.title_or_side)]
    for landmark, place in zip(outgoing.landmarks, outgoing.places, strict=True):
        header += [f"{one_line(landmark.name).strip()}_{axis}" for axis in "xyz"]
        row += coordinates_text(place)
    return Written(csv_line(header) + csv_line(row))
