"""Tag points of the MNI tools, ``.tag``: one side, or pairs."""

from __future__ import annotations

import re
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.csv_cells import shortened
from pinwarp.io.csv_text import LONGEST_CELL
from pinwarp.io.landmark_formats.lines import checked_name, landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.writing import (
    Holds,
    Outgoing,
    Written,
    left_out,
    numbers_text,
    placed_only,
)
from pinwarp.io.text import filled_lines

NAME = "MNI .tag"
SUFFIXES = (".tag",)
HOLDS = Holds(pairs=True, empty=False)

_SIGNATURE = "MNI Tag Point File"
_VOLUMES = re.compile(r"volumes\s*=\s*([^;]*);?$", re.IGNORECASE)
_POINTS = re.compile(r"points\s*=\s*", re.IGNORECASE)
_LABEL = re.compile(r'"((?:[^"\\]|\\.)*)"')
_ESCAPED = re.compile(rb"\\(?:x([0-9a-fA-F]{1,2})|([0-7]{1,3})|(.))", re.DOTALL)
_CONTROLS = {b"n": b"\n", b"t": b"\t", b"r": b"\r"}


def matches(head: str) -> bool:
    """Whether a text begins as a file of tag points.

    Examples
    --------
    >>> matches("MNI Tag Point File"), matches("name,x,y,z")
    (True, False)
    """
    return head.lstrip().startswith(_SIGNATURE)


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read tag points; those of two volumes are pairs, the first volume the source.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it: a line for each point, with or without a label. Weight, structure and
        patient numbers are passed over.
    side
        The side that points of one volume belong to.

    Returns
    -------
    LandmarkReading
        The format says neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When there are more than two volumes, or no landmark could be read.

    Examples
    --------
    >>> text = 'MNI Tag Point File\nVolumes = 2;\nPoints =\n 1 2 3 4 5 6 "nasion";\n'
    >>> read("a.tag", text, Side.SOURCE).landmarks[0].destination
    (4.0, 5.0, 6.0)
    """
    gathering = Gathering(path)
    volumes, in_points, ended, row = 1, False, False, 0
    for number, line in filled_lines(text):
        if line[0] in "%#" or line.startswith(_SIGNATURE):
            continue
        if len(line) > LONGEST_CELL:
            gathering.skip(number, line, f"it is longer than {LONGEST_CELL:,} characters")
            continue
        if not in_points:
            volumes = _volumes(path, number, line) or volumes
            opening = _POINTS.match(line)
            in_points = opening is not None
            line = line[opening.end() :] if opening else ""
        if ended:
            gathering.skip(number, line, "it stands behind the semicolon that ends the points")
        elif line and line != ";":
            gathering.take(number, line, _landmark, line, volumes, side, DefaultName.of(row))
            row += 1
        ended = ended or _without_label(line).endswith(";")
    return gathering.reading(
        NAME,
        'lines as in: 1.5 2.5 3.5 "nasion"',
        is_pairs=volumes == 2,
        notes=() if ended else ("The last semicolon is missing: was the file cut off?",),
    )


def _volumes(path: str | Path, number: int, line: str) -> int:
    found = _VOLUMES.match(line)
    if not found:
        return 0
    text = found[1].strip()
    if text not in ("1", "2"):
        raise FileFormatError(
            path, f"The number of volumes is {shortened(text)}. One or two can be read.", number
        )
    return int(text)


def _without_label(line: str) -> str:
    return _LABEL.sub("", line).strip()


def _landmark(line: str, volumes: int, side: Side, default: str) -> Landmark:
    label = _LABEL.search(line)
    words = _without_label(line).removesuffix(";").split()
    if '"' in " ".join(words):
        raise ValueError("the quotes do not match")
    name = _unescaped(label[1]) if label else ""
    count = 3 * volumes
    # A label of one word needs no quotes.
    if not label and len(words) in (count + 1, count + 4):
        name = words.pop()
    if len(words) not in (count, count + 3):
        raise ValueError(f"it needs {count} coordinates and has {len(words)}")
    first = three_numbers(words[:3])
    name = name.strip() or default
    if volumes == 1:
        return landmark_on(side, name, first)
    return Landmark(checked_name(name), first, three_numbers(words[3:6]))


def text_of(outgoing: Outgoing) -> Written:
    r"""Return the points of one side, or of pairs.

    Parameters
    ----------
    outgoing
        The format has no word for a position that is missing: what is not placed is left out,
        and so is half a pair.

    Examples
    --------
    >>> pair = Landmark("a", (1, 2, 3), (4, 5, 6))
    >>> print(text_of(Outgoing((pair,), None)).text, end="")
    MNI Tag Point File
    Volumes = 2;
    <BLANKLINE>
    Points =
     1.0 2.0 3.0 4.0 5.0 6.0 "a";
    """
    landmarks, side = outgoing.landmarks, outgoing.side
    if side is None:
        pairs = [x for x in landmarks if x.is_complete]
        notes = left_out(
            len(landmarks) - len(pairs),
            "is not placed on both sides",
            "are not placed on both sides",
        )
        rows = [
            (x.name, f"{numbers_text(x.source, '')} {numbers_text(x.destination, '')}")
            for x in pairs
        ]
    else:
        placed, notes = placed_only(landmarks, side)
        rows = [(name, numbers_text(position, "")) for name, position in placed]
    points = [f' {numbers} "{_escaped(name)}"' for name, numbers in rows]
    remarks = outgoing.commented("% ")
    header = f"{_SIGNATURE}\n{remarks}Volumes = {2 if side is None else 1};\n\nPoints =\n"
    return Written(header + "\n".join(points) + ";\n", notes)


def _unescaped(text: str) -> str:
    """Undo the escapes of VTK, which writes every byte of UTF-8 by its number."""

    def byte(found: re.Match[bytes]) -> bytes:
        if found[1]:
            return bytes([int(found[1], 16)])
        if found[2]:
            return bytes([int(found[2], 8) & 0xFF])
        return _CONTROLS.get(found[3], found[3])

    return _ESCAPED.sub(byte, text.encode()).decode(errors="replace")


def _escaped(name: str) -> str:
    return one_line(name).replace("\\", "\\\\").replace('"', '\\"')
