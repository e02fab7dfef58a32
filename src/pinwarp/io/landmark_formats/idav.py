"""Landmarks of IDAV Landmark Editor and Stratovan Checkpoint, ``.pts``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.words import some_of
from pinwarp.io.csv_cells import is_number
from pinwarp.io.landmark_formats.lines import landmark_on, three_numbers
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading, ReadGroup
from pinwarp.io.landmark_formats.writing import (
    Holds,
    Outgoing,
    Written,
    names_of_one_word,
    numbers_text,
)
from pinwarp.io.text import filled_lines

NAME = "IDAV Landmark .pts"
SUFFIXES = (".pts",)
HOLDS = Holds(curves=True, patches=True)

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
    grouped: dict[str, list[int | None]] = {}
    announced, rows = None, 0
    for number, line in filled_lines(text):
        words = line.split()
        if rows == 0 and announced is None:
            if _VERSION.match(line):
                continue
            if len(words) == 1 and re.fullmatch("[0-9]{1,9}", line):
                announced = int(line)
                continue
        taken = gathering.take(number, line, _landmark, words, side, DefaultName.of(rows))
        if point := _GROUPED.fullmatch(words[0]):
            grouped.setdefault(point[1].upper(), []).append(taken)
        rows += 1
    notes = []
    if announced is not None and announced != rows:
        notes.append(f"The file announces {announced} landmarks and holds {rows}: was it cut off?")
    for name, numbers in grouped.items():
        gathering.add_group(ReadGroup(name, is_curve=name.startswith("C")), numbers)
    return gathering.reading(NAME, "lines as in: S000 -11.37 57.22 -15.77", notes=notes)


def _landmark(words: Sequence[str], side: Side, default: str) -> Landmark:
    if len(words) < 3 + (not is_number(words[0], ",")):
        raise ValueError("it needs three coordinates")
    # A name of several words is none that the program writes, but people do.
    name = " ".join(words[:-3]) or default
    return landmark_on(side, name, three_numbers(words[-3:], _MISSING))


def text_of(outgoing: Outgoing) -> Written:
    """Return the landmarks of one side; those that are not placed are three times 9999.

    Parameters
    ----------
    outgoing
        Blanks end a name in this format: they become underscores. Points of curves and patches
        get names that say which: the format has no others for them.

    Examples
    --------
    >>> print(text_of(Outgoing((Landmark("left tragus", (1, 2, 3)),))).text, end="")
    Version 1.0
    1
    left_tragus 1.0 2.0 3.0
    <BLANKLINE>
    """
    numbered = _numbered(outgoing.groups)
    names, blanks = names_of_one_word(numbered.get(x.name, x.name) for x in outgoing.landmarks)
    lines = ["Version 1.0", str(len(names))]
    for name, position in zip(names, outgoing.places, strict=True):
        lines.append(f"{name} {numbers_text(position, _MISSING)}")
    notes = [*blanks]
    if any(old != new for old, new in numbered.items()):
        notes.append("Points of curves and patches are called by their number: C000-000, P000-000.")
    if closed := [group.name for group in outgoing.groups if group.is_closed]:
        notes.append(f"The format has no closed curves: {some_of(closed)} became open.")
    # Some readers want an empty line behind the last landmark.
    return Written("\n".join([*lines, "", ""]), tuple(notes))


def _numbered(groups: Sequence[ReadGroup]) -> dict[str, str]:
    """Return what the points of curves and patches are called, but for their anchors."""
    found: dict[str, str] = {}
    counts = {"C": 0, "P": 0}
    for group in groups:
        letter = "C" if group.is_curve else "P"
        points = [point for point in group.points if point not in group.anchors]
        for number, point in enumerate(points):
            found.setdefault(point, f"{letter}{counts[letter]:03d}-{number:03d}")
        counts[letter] += 1
    return found
