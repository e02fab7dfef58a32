"""Landmarks of IDAV Landmark Editor and Stratovan Checkpoint, ``.pts``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import is_number
from pinwarp.io.landmark_formats.lines import landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import Gathering, LandmarkReading, ReadGroup
from pinwarp.io.landmark_formats.writing import Written, numbers_text
from pinwarp.io.text import filled_lines

NAME = "IDAV Landmark .pts"
SUFFIXES = (".pts",)
HOLDS_PAIRS = False

_VERSION = re.compile(r"version\s+\d", re.IGNORECASE)
_MISSING = "9999"
_GROUPED = re.compile(r"([CP]\d{3,})-\d+", re.IGNORECASE)


def matches(head: str) -> bool:
    """Whether the first line says a version.

    Examples
    --------
    >>> matches("Version 1.0"), matches("name,x,y,z")
    (True, False)
    """
    return any(_VERSION.match(line) for _, line in list(filled_lines(head))[:1])


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read landmarks; three times 9999 is one that is missing.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it: a version, a count, and a line for each landmark.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        Named as in the file (``S000`` is a single landmark, ``C000-000`` a point of a curve,
        ``P000-000`` one of a patch). The format says neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When no landmark could be read.

    Examples
    --------
    >>> reading = read("a.pts", "Version 1.0\n1\nS000 1 2 3\n", Side.SOURCE)
    >>> reading.landmarks[0].name, reading.landmarks[0].source
    ('S000', (1.0, 2.0, 3.0))
    """
    gathering = Gathering(path)
    grouped: dict[str, list[str]] = {}
    announced, rows = None, 0
    for number, line in filled_lines(text):
        words = line.split()
        if rows == 0 and announced is None:
            if _VERSION.match(line):
                continue
            if len(words) == 1 and re.fullmatch("[0-9]{1,9}", line):
                announced = int(line)
                continue
        gathering.take(number, line, _landmark, words, side, f"landmark_{rows}")
        if point := _GROUPED.fullmatch(words[0]):
            grouped.setdefault(point[1].upper(), []).append(words[0])
        rows += 1
    notes = []
    if announced is not None and announced != rows:
        notes.append(f"The file announces {announced} landmarks and holds {rows}: was it cut off?")
    groups = [ReadGroup(x, tuple(points), x.startswith("C")) for x, points in grouped.items()]
    return gathering.reading(
        NAME, "lines as in: S000 -11.37 57.22 -15.77", notes=notes, groups=groups
    )


def _landmark(words: Sequence[str], side: Side, default: str) -> Landmark:
    if len(words) < 3 + (not is_number(words[0], ",")):
        raise ValueError("it needs three coordinates")
    # A name of several words is none that the program writes, but people do.
    name = " ".join(words[:-3]) or default
    return landmark_on(side, name, three_numbers(words[-3:], _MISSING))


def text_of(landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str) -> Written:
    """Return the landmarks of one side; those that are not placed are three times 9999.

    Parameters
    ----------
    landmarks
        Blanks end a name in this format: they become underscores.
    side
        The side to write.
    unit, title
        Not used: the format has a place for neither.

    Examples
    --------
    >>> print(text_of([Landmark("left tragus", (1, 2, 3))], Side.SOURCE, "mm", "").text, end="")
    Version 1.0
    1
    left_tragus 1.0 2.0 3.0
    <BLANKLINE>
    """
    del unit, title
    assert side is not None, "pairs are refused before"
    names = _names(landmarks)
    changed = sum(name != landmark.name for name, landmark in zip(names, landmarks, strict=True))
    lines = ["Version 1.0", str(len(names))]
    for name, landmark in zip(names, landmarks, strict=True):
        lines.append(f"{name} {numbers_text(landmark.position(side), _MISSING)}")
    underscores = f"{changed} name{'s' * (changed > 1)} with blanks got underscores."
    # Some readers want an empty line behind the last landmark.
    return Written("\n".join([*lines, "", ""]), (underscores,) if changed else ())


def _names(landmarks: Sequence[Landmark]) -> list[str]:
    """Return names without blanks, each there once."""
    taken: dict[str, None] = {}
    for landmark in landmarks:
        stem = name = "_".join(one_line(landmark.name).split()) or "_"
        count = 2
        while name in taken:
            name, count = f"{stem}_{count}", count + 1
        taken[name] = None
    return list(taken)
