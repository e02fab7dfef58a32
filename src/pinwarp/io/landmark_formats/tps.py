"""TPS files of the tps programs and of R: landmarks without names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.csv_cells import number_of, shortened
from pinwarp.io.landmark_formats.lines import landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import (
    DefaultName,
    Gathering,
    LandmarkReading,
    ReadGroup,
)
from pinwarp.io.landmark_formats.specimens import (
    FIRST,
    chosen,
    named_specimens,
    specimen_notes,
)
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, numbers_text
from pinwarp.io.text import filled_lines

NAME = "TPS"
SUFFIXES = (".tps",)
HOLDS = Holds(names=False, curves=True)

_START = re.compile(r"LM(3?)\s*=\s*([0-9]{1,9})$", re.IGNORECASE)
_KEY = re.compile(r"([A-Z]\w*)\s*=\s*(.*)$", re.IGNORECASE)
_MISSING = "na"


@dataclass
class _Specimen:
    """A specimen as it stands in a file."""

    line: int
    is_flat: bool = False
    announced: int = 0
    name: str = ""
    rows: list[tuple[int, str]] = field(default_factory=list)
    scale: tuple[int, str] | None = None
    curves: list[tuple[int, list[tuple[int, str]]]] = field(default_factory=list)
    outlines: bool = False


def matches(head: str) -> bool:
    """Whether the first line announces landmarks.

    Examples
    --------
    >>> matches("LM3=2"), matches("name,x,y,z")
    (True, False)
    """
    return any(_START.match(line) for _, line in list(filled_lines(head))[:1])


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read the landmarks of the first specimen; see :func:`read_specimen`.

    Examples
    --------
    >>> reading = read("a.tps", "LM3=1\n1 2 3\nID=femur\nSCALE=0.5\n", Side.SOURCE)
    >>> reading.landmarks[0].source, reading.notes
    ((0.5, 1.0, 1.5), ('The coordinates were multiplied by the scale 0.5.',))
    """
    return read_specimen(path, text, side, FIRST)


def read_specimen(path: str | Path, text: str, side: Side, which: str) -> LandmarkReading:
    r"""Read the landmarks of one specimen.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it. ``SCALE=`` multiplies the coordinates; ``NA`` is one that is missing.
    side
        The side the landmarks belong to.
    which
        The specimen, by its ID or its number.

    Returns
    -------
    LandmarkReading
        Called ``landmark_0``, ``landmark_1`` and so on by their row, points of curves
        ``curve_0_0`` and so on: the format has no names for them, and neither a unit nor a
        frame. A curve that ends where it begins is closed.

    Raises
    ------
    FileFormatError
        When there is no such specimen, the landmarks are not in three dimensions, the scale is
        no number, or no landmark could be read.

    Examples
    --------
    >>> text = "LM3=1\n1 2 3\nID=femur\nLM3=1\n4 5 6\nID=tibia\n"
    >>> reading = read_specimen("a.tps", text, Side.SOURCE, "tibia")
    >>> reading.landmarks[0].source, reading.specimens
    ((4.0, 5.0, 6.0), ('femur', 'tibia'))
    """
    specimens = _specimens(path, text) or [_Specimen(1)]
    names = named_specimens([specimen.name for specimen in specimens])
    number = chosen(path, names, which)
    specimen = specimens[number]
    if specimen.is_flat:
        raise FileFormatError(
            path,
            "Its landmarks have two dimensions (LM=). Three are needed (LM3=).",
            specimen.line,
        )
    scale, notes = _scale(path, specimen)
    notes = [*specimen_notes(names, which), *notes]
    if specimen.outlines:
        notes.append("Outlines were left out.")
    gathering = Gathering(path)
    for row, (line, words) in enumerate(specimen.rows):
        gathering.take(line, words, _landmark, words, scale, side, DefaultName.of(row))
    for curve, (announced, points) in enumerate(specimen.curves):
        is_closed = len(points) > 3 and points[0][1].split() == points[-1][1].split()
        numbers = [
            gathering.take(line, words, _landmark, words, scale, side, f"curve_{curve}_{row}")
            for row, (line, words) in enumerate(points[: len(points) - is_closed])
        ]
        gathering.add_group(ReadGroup(f"curve_{curve}", is_closed=is_closed), numbers)
        if len(points) < announced:
            notes.append(
                f"The file announces {announced} points of curve_{curve} and holds {len(points)}: "
                "was it cut off?"
            )
    if len(specimen.rows) < specimen.announced:
        notes.append(
            f"The file announces {specimen.announced} landmarks and holds {len(specimen.rows)}: "
            "was it cut off?"
        )
    reading = gathering.reading(NAME, "three numbers on each line below LM3=", notes=notes)
    return replace(reading, specimens=names, specimen=names[number])


def _scale(path: str | Path, specimen: _Specimen) -> tuple[float, list[str]]:
    if specimen.scale is None:
        return 1.0, []
    line, words = specimen.scale
    if not words.strip():
        return 1.0, ["SCALE= has no value: the coordinates were taken as they are."]
    try:
        scale = number_of(words, ",")
    except ValueError as error:
        raise FileFormatError(
            path, f"The scale cannot be read: {error}. Correct it in a text editor.", line
        ) from None
    return scale, [f"The coordinates were multiplied by the scale {scale:g}."]


def _specimens(path: str | Path, text: str) -> list[_Specimen]:
    specimens: list[_Specimen] = []
    in_landmarks = in_curve = False
    for number, line in filled_lines(text):
        start, key = _START.match(line), _KEY.match(line)
        if start:
            specimens.append(_Specimen(number, not start[1], int(start[2])))
            in_landmarks, in_curve = True, False
        elif not specimens:
            continue
        elif key:
            in_landmarks = False
            in_curve = _take_key(path, specimens[-1], number, key[1].upper(), key[2])
        elif in_landmarks and len(specimens[-1].rows) < specimens[-1].announced:
            specimens[-1].rows.append((number, line))
        elif in_curve and len(specimens[-1].curves[-1][1]) < specimens[-1].curves[-1][0]:
            specimens[-1].curves[-1][1].append((number, line))
        else:
            # Rows belong to the key above them: to landmarks or to curves.
            in_landmarks = in_curve = False
    return specimens


def _take_key(path: str | Path, specimen: _Specimen, line: int, key: str, words: str) -> bool:
    """Take what a key says of a specimen; return whether points of a curve follow."""
    specimen.outlines |= key == "OUTLINES"
    if key == "SCALE":
        specimen.scale = (line, words)
    if key == "ID":
        specimen.name = words
    if key not in ("POINTS", "POINTS3") or specimen.outlines:
        return False
    specimen.curves.append((_count(path, line, words), []))
    return True


def _count(path: str | Path, number: int, words: str) -> int:
    if not re.fullmatch("[0-9]{1,9}", words.strip()):
        raise FileFormatError(
            path, f"{shortened(words)} is no number of points. Correct it in a text editor.", number
        )
    return int(words)


def _landmark(line: str, scale: float, side: Side, name: str) -> Landmark:
    position = three_numbers(line.split(), _MISSING)
    return landmark_on(side, name, None if position is None else _times(position, scale))


def _times(position: Position, scale: float) -> Position:
    x, y, z = position
    return (scale * x, scale * y, scale * z)


def text_of(outgoing: Outgoing) -> Written:
    """Return one specimen.

    Parameters
    ----------
    outgoing
        Only the order of landmarks is kept, not their names; where one is not placed, ``NA``
        holds its row. A curve comes with the landmarks it is anchored to, and ends where it begins
        if it is closed.

    Examples
    --------
    >>> print(text_of(Outgoing((Landmark("a", (1, 2, 3)),), title="femur")).text, end="")
    LM3=1
    1.0 2.0 3.0
    ID=femur
    """
    rows = {
        landmark.name: numbers_text(place, "NA")
        for landmark, place in zip(outgoing.landmarks, outgoing.places, strict=True)
    }
    along = {x for group in outgoing.groups for x in group.points if x not in group.anchors}
    curves = [
        [rows[x] for x in (*group.points, *group.points[: int(group.is_closed)])]
        for group in outgoing.groups
    ]
    single = [row for name, row in rows.items() if name not in along]
    comments = outgoing.commented("COMMENT=")
    return Written(specimen_text(single, curves, outgoing.title_or_side) + comments)


def specimen_text(rows: Sequence[str], curves: Sequence[Sequence[str]], title: str) -> str:
    """Return a specimen of rows that are written out.

    Parameters
    ----------
    rows
        Its landmarks.
    curves
        The points along each curve.
    title
        Its ID.
    """
    lines = [f"LM3={len(rows)}", *rows]
    if curves:
        lines.append(f"CURVES={len(curves)}")
    for curve in curves:
        lines += [f"POINTS={len(curve)}", *curve]
    return "\n".join([*lines, f"ID={one_line(title).strip()}", ""])
