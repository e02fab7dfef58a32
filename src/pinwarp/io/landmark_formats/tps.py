"""TPS files of the tps programs and of R: landmarks without names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.csv_cells import number_of, shortened
from pinwarp.io.landmark_formats.lines import landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import Gathering, LandmarkReading, ReadGroup
from pinwarp.io.landmark_formats.writing import Written, numbers_text
from pinwarp.io.text import filled_lines

NAME = "TPS"
SUFFIXES = (".tps",)
HOLDS_PAIRS = False

_START = re.compile(r"LM(3?)\s*=\s*([0-9]{1,9})$", re.IGNORECASE)
_KEY = re.compile(r"([A-Z]\w*)\s*=\s*(.*)$", re.IGNORECASE)
_MISSING = "na"


@dataclass
class _Specimen:
    """The first specimen of a file, as it stands there."""

    announced: int = 0
    rows: list[tuple[int, str]] = field(default_factory=list)
    scale: tuple[int, str] | None = None
    curves: list[tuple[int, list[tuple[int, str]]]] = field(default_factory=list)
    outlines: bool = False
    others: int = 0


def matches(head: str) -> bool:
    """Whether the first line announces landmarks.

    Examples
    --------
    >>> matches("LM3=2"), matches("name,x,y,z")
    (True, False)
    """
    return any(_START.match(line) for _, line in list(filled_lines(head))[:1])


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read the landmarks of the first specimen.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it. ``SCALE=`` multiplies the coordinates; ``NA`` is one that is missing.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        Called ``landmark_0``, ``landmark_1`` and so on by their row, points of curves
        ``curve_0_0`` and so on: the format has no names for them, and neither a unit nor a
        frame. A curve that ends where it begins is closed.

    Raises
    ------
    FileFormatError
        When the landmarks are not in three dimensions, the scale is no number, or no landmark
        could be read.

    Examples
    --------
    >>> reading = read("a.tps", "LM3=1\n1 2 3\nID=femur\nSCALE=0.5\n", Side.SOURCE)
    >>> reading.landmarks[0].source, reading.notes
    ((0.5, 1.0, 1.5), ('The coordinates were multiplied by the scale 0.5.',))
    """
    specimen = _first_specimen(path, text)
    scale = 1.0
    notes = []
    if specimen.others:
        notes.append(f"{specimen.others + 1} specimens: the first was read.")
    if specimen.scale is not None:
        place, words = specimen.scale
        try:
            scale = number_of(words, ",")
        except ValueError as error:
            raise FileFormatError(
                path, f"The scale cannot be read: {error}. Correct it in a text editor.", place
            ) from None
        notes.append(f"The coordinates were multiplied by the scale {scale:g}.")
    if specimen.outlines:
        notes.append("Outlines were left out.")
    gathering = Gathering(path)
    for row, (number, line) in enumerate(specimen.rows):
        gathering.take(number, line, _landmark, line, scale, side, f"landmark_{row}")
    groups = []
    for curve, (announced, points) in enumerate(specimen.curves):
        is_closed = len(points) > 3 and points[0][1].split() == points[-1][1].split()
        names = [f"curve_{curve}_{row}" for row in range(len(points) - is_closed)]
        for name, (number, line) in zip(names, points, strict=False):
            gathering.take(number, line, _landmark, line, scale, side, name)
        groups.append(ReadGroup(f"curve_{curve}", tuple(names), is_closed=is_closed))
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
    return gathering.reading(
        NAME, "three numbers on each line below LM3=", notes=notes, groups=groups
    )


def _first_specimen(path: str | Path, text: str) -> _Specimen:
    specimen = _Specimen()
    started = in_landmarks = in_curve = False
    for number, line in filled_lines(text):
        start, key = _START.match(line), _KEY.match(line)
        if start and started:
            specimen.others += 1
        elif start:
            if not start[1]:
                raise FileFormatError(
                    path,
                    "Its landmarks have two dimensions (LM=). Three are needed (LM3=).",
                    number,
                )
            started, specimen.announced = True, int(start[2])
        elif specimen.others:
            continue
        elif key:
            name = key[1].upper()
            specimen.outlines |= name == "OUTLINES"
            in_curve = name in ("POINTS", "POINTS3") and not specimen.outlines
            if in_curve:
                specimen.curves.append((_count(path, number, key[2]), []))
            if name == "SCALE":
                specimen.scale = (number, key[2])
        elif in_landmarks and len(specimen.rows) < specimen.announced:
            specimen.rows.append((number, line))
            continue
        elif in_curve and len(specimen.curves[-1][1]) < specimen.curves[-1][0]:
            specimen.curves[-1][1].append((number, line))
            continue
        # Rows belong to the key above them: to landmarks or to curves.
        in_landmarks = bool(start) and not specimen.others
        in_curve = in_curve and bool(key)
    return specimen


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


def text_of(landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str) -> Written:
    """Return one specimen.

    Parameters
    ----------
    landmarks
        Only their order is kept, not their names; where one is not placed, ``NA`` holds its
        row.
    side
        The side to write.
    unit
        Not used: the format has no place for it.
    title
        What the specimen is called.

    Examples
    --------
    >>> print(text_of([Landmark("a", (1, 2, 3))], Side.SOURCE, "mm", "femur").text, end="")
    LM3=1
    1.0 2.0 3.0
    ID=femur
    """
    del unit
    assert side is not None, "pairs are refused before"
    rows = [numbers_text(landmark.position(side), "NA") for landmark in landmarks]
    lines = [f"LM3={len(rows)}", *rows, f"ID={one_line(title).strip() or side.value}", ""]
    notes = ("The format has no names for landmarks: only their order was kept.",)
    return Written("\n".join(lines), notes)
