"""3D Slicer's older list of control points, ``.fcsv``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import (
    coordinates_text,
    position_of,
    shortened,
)
from pinwarp.io.csv_text import Row, plain_line, rows_of
from pinwarp.io.landmark_formats.lines import landmark_on, one_line
from pinwarp.io.landmark_formats.reading import Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Written, in_millimetres, placed_only
from pinwarp.io.text import lines_of

NAME = "3D Slicer .fcsv"
SUFFIXES = (".fcsv",)
HOLDS_PAIRS = False

_HEADER = (
    "# Markups fiducial file version = 4.11\n"
    "# CoordinateSystem = LPS\n"
    "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
)
_SIGNATURE = re.compile(
    r"^#\s*(Markups fiducial file|Fiducial List file|columns\s*=\s*(id|label)\s*,\s*x\s*,)",
    re.IGNORECASE | re.MULTILINE,
)
_VERSION = re.compile(r"#\s*Markups fiducial file version\s*=", re.IGNORECASE)
_FRAME = re.compile(r"#\s*CoordinateSystem\s*=\s*(\S*)", re.IGNORECASE)
_FRAMES = {"lps": "LPS", "1": "LPS", "ras": "RAS", "0": "RAS"}
_LABEL, _STATUS, _DEFINED = 11, 14, "2"


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
    >>> reading = read("a.fcsv", _HEADER + "1,12.5,-40,60,0,0,0,1,1,1,0,nasion,,\n", Side.SOURCE)
    >>> reading.landmarks[0].name, reading.landmarks[0].source, reading.frame
    ('nasion', (12.5, -40.0, 60.0), 'LPS')
    """
    gathering = Gathering(path)
    versioned, frame, notes = False, "", []
    number, lines = 0, lines_of(text)
    for row in rows_of(lines, ","):
        if row.is_blank:
            continue
        if row.text.startswith("#"):
            versioned = versioned or _VERSION.match(row.text) is not None
            found = _FRAME.match(row.text)
            if found:
                frame = _FRAMES.get(found[1].lower(), "")
                if not frame:
                    notes.append(f"The coordinate system {shortened(found[1])} is not known.")
            continue
        default = f"landmark_{number}"
        is_last = row.line == len(lines) and not text.endswith(("\n", "\r"))
        gathering.take(row.line, row.text, _landmark, row, versioned, is_last, side, default)
        number += 1
    return gathering.reading(
        NAME,
        "lines as in: 1,12.5,-40.2,60.1,0,0,0,1,1,1,0,nasion,,",
        frame=frame if versioned else frame or "RAS",
        unit="mm",
        notes=notes,
    )


def _landmark(row: Row, versioned: bool, is_last: bool, side: Side, default: str) -> Landmark:
    if row.problem:
        raise ValueError(row.problem)
    # Its last number may have lost digits.
    if versioned and is_last and len(row.cells) <= _LABEL:
        raise ValueError("it ends before its label: was it cut off?")
    cells = (*row.cells, *[""] * _STATUS)
    name = cells[_LABEL] if versioned else cells[0]
    position = position_of(cells[1:4], ",")
    if position is None:
        raise ValueError("it has no coordinates")
    # From Slicer 5 on, a cell behind the others says whether the point was placed.
    if versioned and len(row.cells) > _STATUS and row.cells[_STATUS].strip() != _DEFINED:
        position = None
    return landmark_on(side, name.strip() or default, position)


def text_of(landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str) -> Written:
    """Return the list of one side.

    The numbers are said to be in LPS, Slicer's own frame for files; pinwarp's meshes have no
    frame, and a mesh that Slicer reads without one is taken for LPS, too, so that landmarks
    and mesh stay together. Slicer takes all lengths for millimetres, and the format cannot say
    otherwise: positions in another unit are converted.

    Parameters
    ----------
    landmarks
        Those that have no position on the side are left out.
    side
        The side to write.
    unit
        The unit the positions are in; empty where it is not known: then they stay as they are.
    title
        Not used.

    Raises
    ------
    LandmarkError
        When the unit is none that can be converted.

    Examples
    --------
    >>> text = text_of([Landmark("nasion", (0.5, 0, 1))], Side.SOURCE, "m", "skull").text
    >>> text.splitlines()[-1]
    '1,500.0,0.0,1000.0,0,0,0,1,1,1,0,nasion,,'
    """
    del title
    assert side is not None, "pairs are refused before"
    placed, notes = placed_only(in_millimetres(landmarks, unit), side)
    lines = [_HEADER]
    for number, (name, position) in enumerate(placed, 1):
        numbers = coordinates_text(position)
        label = one_line(name).strip()
        cells = [str(number), *numbers, "0", "0", "0", "1", "1", "1", "0", label, "", ""]
        lines.append(plain_line(cells))
    return Written("".join(lines), notes)
