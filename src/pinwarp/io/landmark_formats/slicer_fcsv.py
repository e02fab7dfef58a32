"""3D Slicer's older list of control points, ``.fcsv``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import (
    coordinates_text,
    position_of,
    shortened,
)
from pinwarp.io.csv_text import Row, plain_line, rows_of
from pinwarp.io.landmark_formats.lines import landmark_on, one_line
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, in_millimetres, left_out
from pinwarp.io.text import lines_of

NAME = "3D Slicer .fcsv"
SUFFIXES = (".fcsv",)
HOLDS = Holds(empty=False, notes=True, locks=True, switches=True, frame="LPS", unit="mm")

_OPENING_LINES = "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
_COLUMNS_LINE = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
_COLUMNS = [
    "id",
    "x",
    "y",
    "z",
    "ow",
    "ox",
    "oy",
    "oz",
    "vis",
    "sel",
    "lock",
    "label",
    "desc",
    "associatednodeid",
]
_COLUMNS_3 = ("label", "x", "y", "z", "sel", "vis")
# The # at the beginning of a line is easily lost.
_SIGNATURE = re.compile(
    r"^[#\" \t]*(Markups fiducial file|Fiducial List file|columns\s*=\s*(id|label)\s*,\s*x\s*,|"
    r"id,x,y,z,ow,|label,x,y,z,sel,vis)",
    re.IGNORECASE | re.MULTILINE,
)
_VERSION = re.compile(r"[#\" \t]*Markups fiducial file version\s*=", re.IGNORECASE)
_FRAME = re.compile(r"[#\" \t]*CoordinateSystem\s*=\s*(\w*)", re.IGNORECASE)
_HEADER_3 = re.compile(r"[#\" \t]*Fiducial List file", re.IGNORECASE)
_OPENING = re.compile(r"[#\" \t]*columns\s*=\s*", re.IGNORECASE)
_FRAMES = {"lps": "LPS", "1": "LPS", "ras": "RAS", "0": "RAS"}
# From Slicer 5 on, a cell behind the others says whether the point is undefined or missing.
_STATUS, _UNPLACED = len(_COLUMNS), ("0", "3")


def matches(head: str) -> bool:
    """Whether a text has a header of Slicer's; files of Slicer 3 may have none.

    Examples
    --------
    >>> matches("# Markups fiducial file version = 4.11"), matches("name,x,y,z")
    (True, False)
    """
    return _SIGNATURE.search(head) is not None


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read a list of control points, positions as they are stored.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it. Without a version line it is Slicer 3's ``label,x,y,z,sel,vis``.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        Its frame is the one of the line ``CoordinateSystem`` (0 is RAS, 1 is LPS), and RAS
        for Slicer 3. Slicer's unit of length is the millimetre.

    Raises
    ------
    FileFormatError
        When no landmark could be read.

    Examples
    --------
    >>> text = _OPENING_LINES + _COLUMNS_LINE + "1,12.5,-40,60,0,0,0,1,1,1,0,nasion,,\n"
    >>> reading = read("a.fcsv", text, Side.SOURCE)
    >>> reading.landmarks[0].name, reading.landmarks[0].source, reading.frame
    ('nasion', (12.5, -40.0, 60.0), 'LPS')
    """
    gathering = Gathering(path)
    versioned, frame, notes = False, "", []
    columns: Sequence[str] = ()
    number, lines = 0, lines_of(text)
    for row in rows_of(lines, ","):
        if row.is_blank:
            continue
        if _VERSION.match(row.text):
            versioned = True
        elif found := _FRAME.match(row.text):
            frame = _FRAMES.get(found[1].lower(), "")
            if not frame:
                notes.append(f"The coordinate system {shortened(found[1])} is not known.")
        elif opening := _columns_in(row):
            columns = opening
        elif not row.text.startswith("#") and not _HEADER_3.match(row.text):
            is_last = row.line == len(lines) and not text.endswith(("\n", "\r"))
            held = columns or (_COLUMNS if versioned else _COLUMNS_3)
            default = DefaultName.of(number)
            gathering.take(row.line, row.text, _landmark, row, held, is_last, side, default)
            number += 1
    is_old = not versioned and "ow" not in columns
    return gathering.reading(
        NAME,
        "lines as in: 1,12.5,-40.2,60.1,0,0,0,1,1,1,0,nasion,,",
        frame=frame or "RAS" if is_old else frame,
        unit="mm",
        notes=notes,
    )


def _columns_in(row: Row) -> list[str]:
    """Return what the columns are, where a row says so, with or without its first words."""
    opening = _OPENING.match(row.text)
    words = row.text[opening.end() :].split(",") if opening else row.cells
    columns = [word.strip().strip('"').lower() for word in words]
    return columns if {"x", "y", "z", "label"} <= set(columns) else []


def _landmark(
    row: Row, columns: Sequence[str], is_last: bool, side: Side, default: DefaultName
) -> Landmark:
    if row.problem:
        raise ValueError(row.problem)
    label = columns.index("label")
    # Its last number may have lost digits.
    if label and is_last and len(row.cells) <= label:
        raise ValueError("it ends before its label: was it cut off?")
    cells = (*row.cells, *[""] * len(columns))
    values = dict(zip(columns, cells, strict=False))
    position = position_of([values[axis] for axis in "xyz"], ",")
    if position is None:
        raise ValueError("it has no coordinates")
    if len(columns) == _STATUS and cells[_STATUS].strip() in _UNPLACED:
        position = None
    return replace(
        landmark_on(side, values["label"].strip() or default, position),
        note=one_line(values.get("desc", "")).strip(),
        # Empty is on in one column and off in the other.
        enabled=values.get("sel", "").strip() != "0",
        locked=values.get("lock", "").strip() == "1",
    )


def text_of(outgoing: Outgoing) -> Written:
    """Return the list of one side.

    The numbers are said to be in LPS, Slicer's own frame for files; pinwarp's meshes have no
    frame, and a mesh that Slicer reads without one is taken for LPS, too, so that landmarks
    and mesh stay together. Slicer takes all lengths for millimetres, and the format cannot say
    otherwise: positions in another unit are converted.

    Parameters
    ----------
    outgoing
        Those that have no position on the side are left out.

    Raises
    ------
    LandmarkError
        When the unit is none that can be converted.

    Examples
    --------
    >>> text = text_of(Outgoing((Landmark("nasion", (0.5, 0, 1)),), unit="m")).text
    >>> text.splitlines()[-1]
    '1,500.0,0.0,1000.0,0,0,0,1,1,1,0,nasion,,'
    """
    placed = replace(outgoing, landmarks=in_millimetres(outgoing.landmarks, outgoing.unit))
    lines = [_OPENING_LINES + outgoing.commented("# ") + _COLUMNS_LINE]
    missing = 0
    for landmark, position in zip(placed.landmarks, placed.places, strict=True):
        if position is None:
            missing += 1
            continue
        flags = ("1", "1" if landmark.enabled else "0", "1" if landmark.locked else "0")
        words = (one_line(text).strip() for text in (landmark.name, landmark.note, ""))
        numbers = coordinates_text(position)
        lines.append(plain_line([str(len(lines)), *numbers, "0", "0", "0", "1", *flags, *words]))
    return Written("".join(lines), left_out(missing, "is not placed", "are not placed"))
