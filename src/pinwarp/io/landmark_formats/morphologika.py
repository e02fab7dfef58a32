"""Morphologika's text files: sections in brackets, landmarks without names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import shortened
from pinwarp.io.landmark_formats.lines import landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import Written, numbers_text
from pinwarp.io.text import filled_lines

NAME = "Morphologika"
SUFFIXES = (".morphologika.txt",)
HOLDS_PAIRS = False

_SIGNATURE = re.compile(r"^\s*\[(individuals|landmarks|rawpoints)\]", re.I | re.M)
_SECTION = re.compile(r"\[\s*(\w+)\s*\]$")
_MISSING = "na"


def matches(head: str) -> bool:
    """Whether there is a section of Morphologika's.

    Examples
    --------
    >>> matches("[Individuals]"), matches("name,x,y,z")
    (True, False)
    """
    return _SIGNATURE.search(head) is not None


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read the landmarks of the first specimen.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it. Sections may come in any case; those that do not concern landmarks
        are passed over.
    side
        The side the landmarks belong to.

    Returns
    -------
    LandmarkReading
        Called ``landmark_0``, ``landmark_1`` and so on by their row: the format has no names
        for them, and neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When the landmarks are not in three dimensions, or none could be read.

    Examples
    --------
    >>> text = "[individuals]\n1\n[landmarks]\n1\n[dimensions]\n3\n[rawpoints]\n'#1\n1 2 3\n"
    >>> read("a.txt", text, Side.SOURCE).landmarks[0].source
    (1.0, 2.0, 3.0)
    """
    section, counts = "", {"individuals": 1, "landmarks": 0, "dimensions": 3}
    rows: list[tuple[int, str]] = []
    for number, line in filled_lines(text):
        opening = _SECTION.match(line)
        if opening:
            section = opening[1].lower()
        elif section in counts:
            counts[section] = _count(path, section, number, line)
            if section == "dimensions" and counts[section] != 3:
                raise FileFormatError(
                    path, f"Its landmarks have {line} dimensions. Three are needed.", number
                )
        elif section == "rawpoints" and not line.startswith("'"):
            rows.append((number, line))
    specimens, announced = counts["individuals"], counts["landmarks"] or len(rows)
    gathering = Gathering(path)
    for row, (number, line) in enumerate(rows[:announced]):
        gathering.take(number, line, _landmark, line, side, f"landmark_{row}")
    notes = []
    if specimens > 1:
        notes.append(f"{specimens} specimens: the first was read.")
    if len(rows) < announced:
        notes.append(
            f"The file announces {announced} landmarks and holds {len(rows)}: was it cut off?"
        )
    elif len(rows) > specimens * announced:
        notes.append(f"{len(rows) - specimens * announced} lines behind the last were ignored.")
    return gathering.reading(NAME, "three numbers on each line below [rawpoints]", notes=notes)


def _count(path: str | Path, section: str, number: int, line: str) -> int:
    if not re.fullmatch("[0-9]{1,9}", line) or not int(line):
        raise FileFormatError(
            path,
            f"The number of {section} is {shortened(line)}. Correct it in a text editor.",
            number,
        )
    return int(line)


def _landmark(line: str, side: Side, name: str) -> Landmark:
    return landmark_on(side, name, three_numbers(line.replace(",", " ").split(), _MISSING))


def text_of(landmarks: Sequence[Landmark], side: Side | None, unit: str, title: str) -> Written:
    """Return one specimen, with the line ends that Morphologika wants.

    Parameters
    ----------
    landmarks
        Only their order is kept, not their names; where one is not placed, ``NA`` holds its
        row (R reads that; Morphologika itself refuses it rather than take it for a place).
    side
        The side to write.
    unit
        Not used: the format has no place for it.
    title
        What the specimen is called.

    Examples
    --------
    >>> text = text_of([Landmark("a", (1, 2, 3))], Side.SOURCE, "mm", "femur").text
    >>> text.split()[-6:]
    ['[rawpoints]', "'#1", 'femur', '1.0', '2.0', '3.0']
    """
    del unit
    assert side is not None, "pairs are refused before"
    title = one_line(title).strip() or side.value
    rows = [numbers_text(landmark.position(side), "NA") for landmark in landmarks]
    sections = {
        "individuals": ["1"],
        "landmarks": [str(len(rows))],
        "dimensions": ["3"],
        "names": [title],
        "rawpoints": [f"'#1 {title}", *rows],
    }
    lines = [line for name, body in sections.items() for line in (f"[{name}]", *body)]
    notes = ("The format has no names for landmarks: only their order was kept.",)
    return Written("\r\n".join([*lines, ""]), notes)
