"""OpenSim Creator's landmark CSV: one file per mesh, or pairs in one file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import Enum
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.atomic import write_atomically
from pinwarp.io.csv_cells import (
    coordinates_text,
    formula_quoted,
    formula_unquoted,
    is_number,
    position_of,
)
from pinwarp.io.csv_text import (
    Row,
    csv_line,
    lines_of,
    read_text,
    refuse_binary,
    rows_of,
    separator_of,
)
from pinwarp.io.landmark_formats.reading import LandmarkReading, SkippedLine

__all__ = ["LandmarkReading", "SkippedLine", "read_landmarks", "write_pairs", "write_side"]

_SIDE_HEADER = ("name", "x", "y", "z")
_PAIRS_HEADER = ("name", "source.x", "source.y", "source.z", "dest.x", "dest.y", "dest.z")
_LONGEST_TEXT = 120


class _Columns(Enum):
    """What the columns hold."""

    SIDE = "three numbers, or a name and three numbers; each row by itself"
    NAMED_SIDE = "a name and three numbers"
    PAIR = "six numbers"
    NAMED_PAIR = "a name and six numbers"


def read_landmarks(path: str | Path, side: Side) -> LandmarkReading:
    r"""Read a file of one side, or of pairs, whichever it is.

    Parameters
    ----------
    path
        The file. Its header may be in any case or missing; cells may be separated by commas,
        semicolons (then with decimal commas, too) or tabs.
    side
        The side that a file of one side belongs to; a file of pairs fills both.

    Returns
    -------
    LandmarkReading
        Landmarks without a name are called ``landmark_0``, ``landmark_1`` and so on by their
        row, so that two nameless files still match where one has a bad row. Blanks around a
        name are dropped.

    Raises
    ------
    FileFormatError
        When the file is missing, not text, larger than 64 MB, or no landmark could be read.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "femur.landmarks.csv")
    ...     _ = path.write_text("Name,X,Y,Z\nfovea,1,2,3\nfar,1,2,nan\n")
    ...     reading = read_landmarks(path, Side.SOURCE)
    >>> reading.landmarks[0].source
    (1.0, 2.0, 3.0)
    >>> reading.skipped
    (SkippedLine(line=3, text='far,1,2,nan', reason="'nan' is not a finite number"),)
    """
    text = read_text(path, "landmark")
    refuse_binary(path, text)
    lines = lines_of(text)
    separator = separator_of([line for line in lines[:50] if not line.startswith("#")][:10])
    rows = [row for row in rows_of(lines, separator) if not row.is_blank]
    # A quoted "#1" is a name; only a bare # makes a comment.
    comments = [row for row in rows if row.text.startswith("#")]
    rows = [row for row in rows if not row.text.startswith("#")]
    columns, has_header = _columns_of(rows, separator)
    skipped = [
        SkippedLine(
            row.line, row.text[:_LONGEST_TEXT], "it starts with #, which makes it a comment"
        )
        for row in comments
        if len(row.cells) > 3 and all(is_number(cell, separator) for cell in row.cells[1:4])
    ]
    found: dict[str, Landmark] = {}
    for number, row in enumerate(rows[has_header:]):
        try:
            landmark = _landmark(row, columns, separator, side, f"landmark_{number}")
            if landmark.name in found:
                raise ValueError(f"the name {landmark.name!r} was used before")
            found[landmark.name] = landmark
        except ValueError as error:
            skipped.append(SkippedLine(row.line, row.text[:_LONGEST_TEXT], str(error)))
    if not found:
        reason = f" (line {skipped[0].line}: {skipped[0].reason})" if skipped else ""
        raise FileFormatError(
            path,
            f"No landmark could be read{reason}. "
            "Expected are lines of a name and three numbers, as in: fovea,1.5,2,-3",
        )
    is_pairs = columns in (_Columns.PAIR, _Columns.NAMED_PAIR)
    return LandmarkReading(
        tuple(found.values()), is_pairs, tuple(sorted(skipped, key=lambda line: line.line))
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
    name = formula_unquoted(name.strip()) if name.strip() else default
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


def write_side(path: str | Path, landmarks: Iterable[Landmark], side: Side) -> None:
    """Write the positions on one side; landmarks without one are left out.

    Parameters
    ----------
    path
        The file.
    landmarks
        The landmarks.
    side
        The side to write.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "femur.landmarks.csv")
    ...     write_side(path, [Landmark("fovea", (1, 2, 0.1)), Landmark("unset")], Side.SOURCE)
    ...     print(path.read_text(), end="")
    name,x,y,z
    fovea,1.0,2.0,0.1
    """
    lines = [csv_line(_SIDE_HEADER)]
    for landmark in landmarks:
        position = landmark.position(side)
        if position is not None:
            lines.append(csv_line([formula_quoted(landmark.name), *coordinates_text(position)]))
    write_atomically(path, "".join(lines))


def write_pairs(path: str | Path, landmarks: Iterable[Landmark]) -> None:
    """Write both sides into one file; what is not placed yet stays empty.

    Parameters
    ----------
    path
        The file.
    landmarks
        The landmarks.

    Raises
    ------
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "pairs.csv")
    ...     write_pairs(path, [Landmark("fovea", (1, 2, 3))])
    ...     print(path.read_text(), end="")
    name,source.x,source.y,source.z,dest.x,dest.y,dest.z
    fovea,1.0,2.0,3.0,,,
    """
    lines = [csv_line(_PAIRS_HEADER)]
    lines += [
        csv_line(
            [
                formula_quoted(landmark.name),
                *coordinates_text(landmark.source),
                *coordinates_text(landmark.destination),
            ]
        )
        for landmark in landmarks
    ]
    write_atomically(path, "".join(lines))
