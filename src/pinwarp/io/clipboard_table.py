"""Landmarks as a table on the clipboard, as spreadsheets copy and paste it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from pinwarp.core.errors import LandmarkError
from pinwarp.core.landmarks import Landmark, Role
from pinwarp.io.csv_cells import (
    YES_NO,
    coordinates_text,
    formula_unquoted,
    is_number,
    position_of,
    shortened,
)
from pinwarp.io.csv_text import LONGEST_CELL, Row, csv_line, rows_of, separator_of
from pinwarp.io.landmark_formats.reading import SkippedLine
from pinwarp.io.text import lines_of

__all__ = ["ClipboardTable", "PastedLandmark", "SkippedLine", "clipboard_text", "read_clipboard"]

_SOURCE = ("source_x", "source_y", "source_z")
_DESTINATION = ("destination_x", "destination_y", "destination_z")
_COLUMNS = ("name", "role", "enabled", *_SOURCE, *_DESTINATION, "note")
_ALIASES = {"landmark": "name", "label": "name", "notes": "note", "comment": "note"}
_LONGEST_TEXT = 120


@dataclass(frozen=True)
class PastedLandmark:
    """What one row says about a landmark; an empty cell says nothing.

    Parameters
    ----------
    line
        Where it stands in the text, counted from 1.
    name
        Which landmark is meant.
    values
        Fields of a landmark and what they become.
    """

    line: int
    name: str
    values: Mapping[str, Any] = field(default_factory=dict)

    def onto(self, landmark: Landmark) -> Landmark:
        """Return the landmark with what the row says.

        Examples
        --------
        >>> PastedLandmark(2, "fovea", {"note": "worn"}).onto(Landmark("fovea")).note
        'worn'
        """
        return replace(landmark, **self.values)


@dataclass(frozen=True)
class ClipboardTable:
    """The rows that could be read, and those that could not, with the reason."""

    rows: tuple[PastedLandmark, ...]
    skipped: tuple[SkippedLine, ...] = ()


def clipboard_text(landmarks: Iterable[Landmark]) -> str:
    r"""Return landmarks as spreadsheets take them: a header, then a row each, between tabs.

    Examples
    --------
    >>> clipboard_text([Landmark("=1+1", (1, 2, 3))]).splitlines()[1]
    "'=1+1\tpair\t1\t1.0\t2.0\t3.0\t\t\t\t"
    """
    lines = [csv_line(_COLUMNS, "\t")]
    for landmark in landmarks:
        cells = [
            landmark.name,
            landmark.role.value,
            "1" if landmark.enabled else "0",
            *coordinates_text(landmark.source),
            *coordinates_text(landmark.destination),
            landmark.note,
        ]
        lines.append(csv_line(cells, "\t"))
    return "".join(lines)


def read_clipboard(text: str) -> ClipboardTable:
    r"""Read rows copied from a spreadsheet, or CSV text.

    Parameters
    ----------
    text
        Tabs, semicolons or commas separate the cells. The first row names the columns (a name,
        and any of role, enabled, source and destination x, y, z, note); without such a row, a
        name and six numbers are read, or all ten columns as they are copied.

    Returns
    -------
    ClipboardTable
        Every row that can be read; the others with line and reason.

    Raises
    ------
    LandmarkError
        When this is no table of landmarks at all.

    Examples
    --------
    >>> table = read_clipboard("name\tSource X\tSource Y\tSource Z\nfovea\t1\t2\t3\nhead\t1\t2\n")
    >>> table.rows[0].values
    {'source': (1.0, 2.0, 3.0)}
    >>> table.skipped[0].reason
    'a number is missing'
    """
    lines = lines_of(text.removeprefix("\ufeff"))
    separator = "\t" if any("\t" in line for line in lines) else separator_of(lines[:10])
    rows = [row for row in rows_of(lines, separator) if not row.is_blank]
    columns, has_header = _columns_of(rows)
    # Between tabs a comma can only be a decimal one, unless points show that it is not.
    numbers = ";" if separator in ";\t" and not _has_decimal_points(rows) else ","
    found: dict[str, PastedLandmark] = {}
    skipped = []
    for row in rows[has_header:]:
        try:
            pasted = _pasted(row, columns, numbers)
            if pasted.name in found:
                raise ValueError(f"the name {shortened(pasted.name)} was used before")
            found[pasted.name] = pasted
        except ValueError as error:
            skipped.append(SkippedLine(row.line, row.text[:_LONGEST_TEXT], str(error)))
    return ClipboardTable(tuple(found.values()), tuple(skipped))


def _columns_of(rows: Sequence[Row]) -> tuple[Sequence[str], bool]:
    """Return what the columns are, and whether the first row says so."""
    if rows:
        named = [_column(cell) for cell in rows[0].cells]
        if "name" in named and (doubled := {c for c in named if c and named.count(c) > 1}):
            raise LandmarkError(f"There are two columns called {min(doubled)} to paste.")
        if "name" in named:
            return named, True
        cells = [cell.strip() for cell in rows[0].cells]
        if len(cells) == 7 and sum(is_number(cell, ";") for cell in cells[1:]) > 2:
            return ("name", *_SOURCE, *_DESTINATION), False
        if len(cells) == len(_COLUMNS) and cells[1].lower() in set(Role):
            return _COLUMNS, False
    raise LandmarkError(
        "There are no landmarks to paste. Copy rows with a header that has a name column, "
        "such as: name, source_x, source_y, source_z, destination_x, …"
    )


def _column(cell: str) -> str:
    """Return which column a heading means, or nothing."""
    words = re.sub(r"[\s._-]+", "_", cell.strip().lower())
    words = re.sub(
        r"^(source|destination)([xyz])$", r"\1_\2", re.sub(r"^dest_", "destination_", words)
    )
    words = _ALIASES.get(words, words)
    return words if words in _COLUMNS else ""


def _has_decimal_points(rows: Sequence[Row]) -> bool:
    return any(re.fullmatch(r"\s*[+-]?[\d,]*\.\d+\s*", cell) for row in rows for cell in row.cells)


def _pasted(row: Row, columns: Sequence[str], numbers: str) -> PastedLandmark:
    """Read one row, or raise a ValueError with the reason."""
    if row.problem:
        raise ValueError(row.problem)
    cells = (*row.cells, *[""] * (len(columns) - len(row.cells)))
    values = {column: cell for column, cell in zip(columns, cells, strict=False) if column}
    name = formula_unquoted(values["name"].strip())
    if not name:
        raise ValueError("it has no name")
    if any(len(cell) > LONGEST_CELL for cell in cells):
        raise ValueError(f"a cell is longer than {LONGEST_CELL:,} characters")
    read: dict[str, Any] = {}
    for column, reader in _READERS.items():
        if values.get(column, "").strip():
            read[column] = reader(values[column])
    for side, three in (("source", _SOURCE), ("destination", _DESTINATION)):
        position = position_of([values.get(column, "") for column in three], numbers)
        if position is not None:
            read[side] = position
    return PastedLandmark(row.line, name, read)


def _role(text: str) -> Role:
    text = text.strip().lower()
    if text not in set(Role):
        raise ValueError(f"the role {shortened(text)} is neither 'pair' nor 'passenger'")
    return Role(text)


def _enabled(text: str) -> bool:
    text = text.strip().lower()
    if text not in YES_NO:
        raise ValueError(f"'enabled' is {shortened(text)} and not 1 or 0")
    return YES_NO[text]


_READERS: dict[str, Callable[[str], Any]] = {
    "role": _role,
    "enabled": _enabled,
    "note": formula_unquoted,
}
