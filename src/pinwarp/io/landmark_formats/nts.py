"""NTS files of NTSYS, geomorph and Checkpoint, and Landmark Editor's ``.dta``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.csv_cells import is_number, number_of
from pinwarp.io.landmark_formats.lines import landmark_on, one_line, three_numbers
from pinwarp.io.landmark_formats.reading import DefaultName, Gathering, LandmarkReading
from pinwarp.io.landmark_formats.specimens import (
    FIRST,
    chosen,
    named_specimens,
    specimen_notes,
)
from pinwarp.io.landmark_formats.table_header import axes_in
from pinwarp.io.landmark_formats.writing import (
    Holds,
    Outgoing,
    Written,
    names_of_one_word,
    numbers_text,
)
from pinwarp.io.text import filled_lines

NAME = "NTS"
SUFFIXES = (".nts", ".dta")
HOLDS = Holds()

_HEADER = re.compile(
    r"1\s+(?P<rows>\d{1,7})\s*(?P<labels>[LBE]?)\s+(?P<columns>\d{1,7})\s*(?P<titles>[LBE]?)\s+"
    r"(?P<missing>[01])(?:\s+(?P<code>[-+.\w]+))??(?:\s+DIM\s*=\s*(?P<dimensions>\d+))?\s*",
    re.IGNORECASE,
)
_MISSING = ("na", "nan")
# What is before a row is a comment of NTSYS.
_COMMENT = ('"', "'")

Token = tuple[int, str]


@dataclass(frozen=True)
class _Matrix:
    """What an NTS file holds; labels are of landmarks, titles of specimens, where it has any."""

    specimens: int
    landmarks: int
    labels: list[str]
    titles: list[str]
    numbers: list[Token]
    code: str


def matches(head: str) -> bool:
    """Whether the first line that is no comment has the numbers of NTS and a dimension.

    Examples
    --------
    >>> matches("1 2L 6 1 9999 DIM=3"), matches("1 2 3 0")
    (True, False)
    """
    first = next((line for _, line in filled_lines(head) if not line.startswith(_COMMENT)), "")
    found = _HEADER.fullmatch(first)
    return found is not None and found["dimensions"] is not None


def read(path: str | Path, text: str, side: Side) -> LandmarkReading:
    r"""Read the landmarks of the first specimen; see :func:`read_specimen`.

    Examples
    --------
    >>> text = "1 1L 6 1 9999 DIM=3\nfemur\n1 2 3 9999 9999 9999\n"
    >>> [x.source for x in read("a.nts", text, Side.SOURCE).landmarks]
    [(1.0, 2.0, 3.0), None]
    """
    return read_specimen(path, text, side, FIRST)


def read_specimen(path: str | Path, text: str, side: Side, which: str) -> LandmarkReading:
    r"""Read the landmarks of one specimen.

    Parameters
    ----------
    path
        The file, for the messages.
    text
        What is in it: a row for each specimen; or one specimen, a row of three numbers for each
        landmark. A number that is the code of the first line, or NA, is missing.
    side
        The side the landmarks belong to.
    which
        The specimen, by its label or number.

    Returns
    -------
    LandmarkReading
        Called as the columns (or rows) are, where these have labels with x, y and z behind them;
        else ``landmark_0`` and so on. The format says neither a unit nor a frame.

    Raises
    ------
    FileFormatError
        When the first line cannot be understood, there is no such specimen, the landmarks are not
        in three dimensions, or none could be read.

    Examples
    --------
    >>> reading = read_specimen("a.nts", "1 2L 3 0 DIM=3\na\nb\n1 2 3\n4 5 6\n", Side.SOURCE, "")
    >>> reading.names
    ('a', 'b')
    """
    matrix = _matrix(path, text)
    names = named_specimens([*matrix.titles, *[""] * matrix.specimens][: matrix.specimens])
    number = chosen(path, names, which)
    labels = matrix.labels
    first = number * matrix.landmarks * 3
    numbers = matrix.numbers[first : first + matrix.landmarks * 3]
    gathering = Gathering(path)
    for row in range(len(numbers) // 3):
        tokens = numbers[3 * row : 3 * row + 3]
        words = [word for _, word in tokens]
        name = (labels[row] if labels else "") or DefaultName.of(row)
        gathering.take(tokens[0][0], " ".join(words), _landmark, words, matrix.code, side, name)
    notes = [*specimen_notes(names, which)]
    if len(numbers) < 3 * matrix.landmarks:
        notes.append(
            f"The file announces {matrix.landmarks} landmarks and holds {len(numbers) // 3}: "
            "was it cut off?"
        )
    reading = gathering.reading(NAME, "three numbers for each landmark", notes=notes)
    return replace(reading, specimens=names, specimen=names[number])


def _matrix(path: str | Path, text: str) -> _Matrix:
    lines = list(filled_lines(text))
    top = next((n for n, (_, line) in enumerate(lines) if not line.startswith(_COMMENT)), None)
    header = None if top is None else _HEADER.fullmatch(lines[top][1])
    if top is None or header is None:
        raise FileFormatError(path, "An NTS file begins with a line as in: 1 2L 12 0 DIM=3.", 1)
    place = lines[top][0]
    rows, columns = int(header["rows"]), int(header["columns"])
    if int(header["dimensions"] or 3) != 3 or columns % 3 or not rows or not columns:
        raise FileFormatError(
            path, "Its landmarks are not in three dimensions (DIM=3). Three are needed.", place
        )
    body = lines[top + 1 :]
    labels: list[str] = []
    titles: list[str] = []
    behind = rows * columns
    if header["labels"].upper() == "L":
        labels, body = _labels(body, rows, behind + (columns if header["titles"] else 0))
    if header["titles"]:
        titles, body = _labels(body, columns, behind)
    numbers = [(line, word) for line, words in body for word in words.split()]
    if header["labels"].upper() in ("B", "E"):
        labels, numbers = _labels_in_rows(body, header["labels"].upper())
    code = header["code"] or "" if header["missing"] == "1" else ""
    comment = lines[0][1].strip("\"' ") if top else ""
    if columns == len("xyz") and rows > 1:
        # One specimen, a row for each of its landmarks.
        return _Matrix(1, rows, labels, [comment], numbers, code)
    axes, _ = axes_in(titles)
    named = ["" if one.is_numbered else one.of.strip() for one in axes]
    if 3 * len(named) != columns:
        named = []
    return _Matrix(rows, columns // 3, named, labels or [comment] * (rows == 1), numbers, code)


def _labels(lines: Sequence[Token], count: int, behind: int) -> tuple[list[str], list[Token]]:
    """Return so many labels and what is behind them: one a line, or several between blanks.

    Parameters
    ----------
    lines
        What is below the first line.
    count, behind
        How many labels there should be, and how many words behind them.
    """
    words = [(line, word) for line, text in lines for word in text.split()]
    first, rest = lines[:count], sum(len(text.split()) for _, text in lines[count:])
    has_words = not all(is_number(word, ",") for _, text in first for word in text.split())
    if rest == behind or (len(words) != count + behind and has_words):
        return [text for _, text in first], list(lines[count:])
    return [word for _, word in words[:count]], words[count:]


def _labels_in_rows(lines: Sequence[Token], where: str) -> tuple[list[str], list[Token]]:
    """Return the labels at the beginning or end of each row, and the numbers beside them."""
    labels, numbers = [], []
    for line, words in lines:
        cells = words.split()
        labels.append(cells.pop(0 if where == "B" else -1))
        numbers += [(line, cell) for cell in cells]
    return labels, numbers


def _landmark(words: Sequence[str], code: str, side: Side, name: str) -> Landmark:
    return landmark_on(side, name, _place(words, code))


def _place(words: Sequence[str], code: str) -> Position | None:
    missing = [word.lower() in _MISSING or _is_code(word, code) for word in words]
    if all(missing):
        return None
    if any(missing):
        raise ValueError("one of its coordinates is missing")
    return three_numbers(words)


def _is_code(word: str, code: str) -> bool:
    if not code or not is_number(word, ",") or not is_number(code, ","):
        return bool(code) and word == code
    return number_of(word, ",") == number_of(code, ",")


def text_of(outgoing: Outgoing) -> Written:
    """Return one specimen, its landmarks named by the labels of the columns.

    Parameters
    ----------
    outgoing
        Blanks end a name in this format: they become underscores. What is not placed is written
        as a code that no coordinate is.

    Examples
    --------
    >>> marks = (Landmark("nasion", (1, 2, 3)), Landmark("inion"))
    >>> print(text_of(Outgoing(marks, title="skull")).text, end="")
    1 1L 6L 1 9999 DIM=3
    skull
    nasion_x nasion_y nasion_z inion_x inion_y inion_z
    1.0 2.0 3.0 9999 9999 9999
    """
    places = outgoing.places
    used = {x for place in places if place is not None for x in place}
    code = next(code for code in _codes() if float(code) not in used)
    names, notes = names_of_one_word([mark.name for mark in outgoing.landmarks])
    labels = " ".join(f"{name}_{axis}" for name in names for axis in "xyz")
    missing = f"1 {code}" if None in places else "0"
    lines = [
        f"1 1L {3 * len(places)}L {missing} DIM=3",
        one_line(outgoing.title_or_side).strip(),
        labels,
        " ".join(numbers_text(place, code) for place in places),
        "",
    ]
    return Written("\n".join(lines), notes)


def _codes() -> Iterator[str]:
    nines = "9999"
    while True:
        yield nines
        nines += "9"
