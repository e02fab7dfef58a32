"""Landmark sets of Amira and Avizo, ``.landmarkAscii``: one side, or pairs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.landmark_formats.lines import landmark_on, three_numbers
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

NAME = "Amira .landmarkAscii"
SUFFIXES = (".landmarkascii", ".landascii")
HOLDS = Holds(pairs=True, names=False, empty=False)

_SIGNATURE = re.compile(r"#\s*(AmiraMesh|Avizo|HyperMesh)\b[^\n\r]*", re.IGNORECASE)
_COUNT = re.compile(r"define\s+Markers\s+(\d{1,9})", re.IGNORECASE)
_DATA = re.compile(
    r"Markers\s*\{\s*(float|double)\s*\[\s*(\d)\s*\]\s*Coordinates(\d?)\s*\}\s*=?\s*@(\d+)",
    re.IGNORECASE,
)
_ASCII_AGAIN = "Save it in Amira as a landmark set in ASCII."


def matches(head: str) -> bool:
    """Whether a text begins as a file of Amira or Avizo.

    Examples
    --------
    >>> matches("# AmiraMesh 3D ASCII 2.0"), matches("# Avizo 3D ASCII 3.0"), matches("name,x,y,z")
    (True, True, False)
    """
    return _SIGNATURE.match(head.lstrip()) is not None


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read a landmark set; one of two sets is of pairs, the first set the source.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it.
    side
        The side that a single set belongs to.

    Returns
    -------
    LandmarkReading
        Called ``landmark_0``, ``landmark_1`` and so on by their row: the format has no names, and
        says neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When it is no landmark set, is binary or of more than two sets, or no landmark could be
        read.

    Examples
    --------
    >>> head = "# AmiraMesh 3D ASCII 2.0\ndefine Markers 1\n"
    >>> body = "Markers { float[3] Coordinates } @1\n@1\n1 2 3\n"
    >>> read("a.landmarkAscii", head + body, Side.SOURCE).landmarks[0].source
    (1.0, 2.0, 3.0)
    """
    first = _SIGNATURE.match(text.lstrip())
    if first is not None and "binary" in first[0].lower():
        raise FileFormatError(path, f"This file of Amira is binary. {_ASCII_AGAIN}", 1)
    if "landmarkset" not in text.lower() and not _COUNT.search(text):
        raise FileFormatError(
            path, f"This file of Amira holds something else than landmarks. {_ASCII_AGAIN}", 1
        )
    columns = {found[4]: (int(found[3] or 1), found[2]) for found in _DATA.finditer(text)}
    if not columns:
        raise FileFormatError(path, f"It does not say where coordinates are. {_ASCII_AGAIN}", 1)
    if any(numbers != "3" for _, numbers in columns.values()):
        raise FileFormatError(path, "Its landmarks have two dimensions. Three are needed.")
    if max(number for number, _ in columns.values()) > len(Side):
        raise FileFormatError(path, f"It has more than two sets. Save one or two. {_ASCII_AGAIN}")
    sets: dict[int, list[tuple[int, str]]] = {number: [] for number, _ in columns.values()}
    for at, number, line in _data_lines(text):
        if at in columns:
            sets[columns[at][0]].append((number, line))
    gathering = Gathering(path)
    rows, others = sets.get(1, []), sets.get(2)
    for row, (number, line) in enumerate(rows):
        other = None if others is None else others[row][1] if row < len(others) else ""
        gathering.take(number, line, _landmark, line, other, side, DefaultName.of(row))
    counted = _COUNT.search(text)
    notes = [
        f"The file announces {counted[1]} landmarks and holds {len(found)}: was it cut off?"
        for found in sets.values()
        if counted is not None and int(counted[1]) != len(found)
    ]
    return gathering.reading(
        NAME, "three numbers on each line below @1", is_pairs=others is not None, notes=notes[:1]
    )


def _data_lines(text: str) -> Iterator[tuple[str, int, str]]:
    """Yield what stands below the marks @1, @2 and so on: the mark, number of line and line."""
    at = ""
    for number, line in filled_lines(text):
        if re.fullmatch(r"@\d{1,9}", line):
            at = line[1:]
        elif at and not line.startswith("#"):
            yield at, number, line


def _landmark(line: str, other: str | None, side: Side, default: DefaultName) -> Landmark:
    first = three_numbers(line.split()[:3])
    if other is None:
        return landmark_on(side, default, first)
    return Landmark(default, first, three_numbers(other.split()[:3]))


def text_of(outgoing: Outgoing) -> Written:
    """Return a landmark set of one side, or of pairs.

    Parameters
    ----------
    outgoing
        The format has no word for a position that is missing: what is not placed is left out, and
        so is half a pair. Names are not kept, only the order.

    Examples
    --------
    >>> pair = Landmark("a", (1, 2, 3), (4, 5, 6))
    >>> text_of(Outgoing((pair,), None)).text.split()[-8:]
    ['@1', '1.0', '2.0', '3.0', '@2', '4.0', '5.0', '6.0']
    """
    if outgoing.side is None:
        pairs = [x for x in outgoing.landmarks if x.is_complete]
        notes = left_out(
            len(outgoing.landmarks) - len(pairs),
            "is not placed on both sides",
            "are not placed on both sides",
        )
        sets = [[numbers_text(x.position(side), "") for x in pairs] for side in Side]
    else:
        placed, notes = placed_only(outgoing.landmarks, outgoing.side)
        sets = [[numbers_text(position, "") for _, position in placed]]
    return Written(_text(sets, outgoing.commented("# ")), notes)


def _text(sets: Sequence[Sequence[str]], comments: str) -> str:
    lines = ["# AmiraMesh 3D ASCII 2.0", *comments.splitlines()]
    lines += ["", "", f"define Markers {len(sets[0])}", ""]
    lines += ["Parameters {", f"    NumSets {len(sets)},", '    ContentType "LandmarkSet"', "}", ""]
    for number in range(1, len(sets) + 1):
        which = "" if number == 1 else number
        lines.append(f"Markers {{ float[3] Coordinates{which} }} @{number}")
    lines += ["", "# Data section follows"]
    for number, rows in enumerate(sets, 1):
        lines += [f"@{number}", *rows, ""]
    return "\n".join(lines)
