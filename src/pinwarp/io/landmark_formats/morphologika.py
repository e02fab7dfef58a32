"""Morphologika's text files: sections in brackets, landmarks without names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.words import counted
from pinwarp.io.csv_cells import shortened
from pinwarp.io.landmark_formats.lines import landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import (
    MOST,
    DefaultName,
    Gathering,
    LandmarkReading,
)
from pinwarp.io.landmark_formats.specimens import (
    FIRST,
    chosen,
    named_specimens,
    specimen_notes,
)
from pinwarp.io.landmark_formats.writing import Holds, Outgoing, Written, numbers_text
from pinwarp.io.text import filled_lines

NAME = "Morphologika"
SUFFIXES = (".morphologika.txt",)
HOLDS = Holds(names=False)

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
    r"""Read the landmarks of the first specimen; see :func:`read_specimen`.

    Examples
    --------
    >>> text = "[individuals]\n1\n[landmarks]\n1\n[dimensions]\n3\n[rawpoints]\n'#1\n1 2 3\n"
    >>> read("a.txt", text, Side.SOURCE).landmarks[0].source
    (1.0, 2.0, 3.0)
    """
    return read_specimen(path, text, side, FIRST)


def read_specimen(path: str | Path, text: str, side: Side, which: str) -> LandmarkReading:
    """Read the landmarks of one specimen.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it. Sections may come in any case; those that do not concern landmarks
        are passed over.
    side
        The side the landmarks belong to.
    which
        The specimen, by its name or number.

    Returns
    -------
    LandmarkReading
        Called ``landmark_0``, ``landmark_1`` and so on by their row: the format has no names
        for them, and neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When there is no such specimen, the landmarks are not in three dimensions, or none could
        be read.
    """
    section, counts = "", {"individuals": 1, "landmarks": 0, "dimensions": 3}
    rows: list[tuple[int, str]] = []
    titles: list[str] = []
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
        elif section == "names":
            titles.append(line)
        elif section == "rawpoints" and not line.startswith("'"):
            rows.append((number, line))
    announced = counts["landmarks"] or len(rows)
    specimens = min(counts["individuals"], MOST)
    names = named_specimens([*titles, *[""] * specimens][:specimens])
    chosen_number = chosen(path, names, which)
    first = chosen_number * announced
    gathering = Gathering(path)
    for row, (number, line) in enumerate(rows[first : first + announced]):
        gathering.take(number, line, _landmark, line, side, DefaultName.of(row))
    notes = [*specimen_notes(names, which)]
    held = max(0, len(rows) - first)
    if held < announced:
        notes.append(
            f"The file announces {counted(announced, 'landmark')} and holds {held}: was it cut off?"
        )
    elif len(rows) > specimens * announced:
        behind = len(rows) - specimens * announced
        were = "was" if behind == 1 else "were"
        notes.append(f"{counted(behind, 'line')} behind the last {were} ignored.")
    reading = gathering.reading(NAME, "three numbers on each line below [rawpoints]", notes=notes)
    return replace(reading, specimens=names, specimen=names[chosen_number])


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


def text_of(outgoing: Outgoing) -> Written:
    """Return one specimen, with the line ends that Morphologika wants.

    Parameters
    ----------
    outgoing
        Only the order of landmarks is kept, not their names; where one is not placed, ``NA``
        holds its row (R reads that; Morphologika itself refuses it rather than take it for a
        place).

    Examples
    --------
    >>> text = text_of(Outgoing((Landmark("a", (1, 2, 3)),), title="femur")).text
    >>> text.split()[-6:]
    ['[rawpoints]', "'#1", 'femur', '1.0', '2.0', '3.0']
    """
    title = one_line(outgoing.title_or_side).strip()
    rows = [numbers_text(place, "NA") for place in outgoing.places]
    return Written(specimen_text(rows, title))


def specimen_text(rows: Sequence[str], title: str, wires: Sequence[str] = ()) -> str:
    """Return a specimen of rows that are written out, with its wireframe where there is one."""
    sections = {
        "individuals": ["1"],
        "landmarks": [str(len(rows))],
        "dimensions": ["3"],
        "names": [title],
        "rawpoints": [f"'#1 {title}", *rows],
        **({"wireframe": wires} if wires else {}),
    }
    lines = [line for name, body in sections.items() for line in (f"[{name}]", *body)]
    return "\r\n".join([*lines, ""])
