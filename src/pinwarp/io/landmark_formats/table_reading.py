"""Tables with a row for each landmark, or pair: with a header or without."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.words import counted
from pinwarp.io.csv_cells import (
    YES_NO,
    formula_unquoted,
    number_of,
    position_of,
    shortened,
)
from pinwarp.io.csv_text import Row
from pinwarp.io.landmark_formats.lines import checked_name, one_line
from pinwarp.io.landmark_formats.reading import (
    DefaultName,
    Gathering,
    LandmarkReading,
    ReadGroup,
)
from pinwarp.io.landmark_formats.table import BLANK, Table
from pinwarp.io.landmark_formats.table_header import Columns, columns_of

_LINES_LOOKED_AT = 50
# Above its column names a table may say what it is.
_TITLE_ROWS = 10
# What makes one doubt that these are landmarks at all.
_MANY_NUMBERS, _MANY_COLUMNS, _MANY_NAMELESS = 8, 12, 500
_UNIT = 1e-3
_SEMILANDMARK = "semilandmark"


def read_table(
    path: str | Path, table: Table, side: Side, name: str, expected: str
) -> LandmarkReading:
    r"""Read a table with a row for each landmark, or pair.

    Parameters
    ----------
    path
        The file, for the messages.
    table
        Its rows. Where the first says which columns are x, y and z (or source.x and so on), those
        are read; else a name and three or six numbers, or numbers alone.
    side
        The side that a table of one side belongs to.
    name, expected
        As for :meth:`~pinwarp.io.landmark_formats.reading.Gathering.reading`.

    Returns
    -------
    LandmarkReading
        Landmarks without a name are called ``landmark_0``, ``landmark_1`` and so on by their
        row, so that two nameless files still match where one has a bad row.

    Raises
    ------
    FileFormatError
        When no landmark could be read.

    Examples
    --------
    >>> from pinwarp.io.landmark_formats.table import table_of
    >>> table = table_of("id,name,x,y,z\n1,fovea,4,5,6\n")
    >>> read_table("a.csv", table, Side.SOURCE, "CSV", "").landmarks[0].source
    (4.0, 5.0, 6.0)
    """
    gathering = Gathering(path)
    for row in table.comments:
        cells = row.cells
        if len(cells) > 3 and all(map(table.is_number, cells[1:4])):
            gathering.skip(row.line, row.text, "it starts with #, which makes it a comment")
    top, columns = _header(table)
    announced = _announced(table, top)
    if announced is None:
        for row in table.rows[: max(0, top - 1)]:
            gathering.skip(row.line, row.text, "it stands above the names of the columns")
    body = [row for row in table.rows[top:] if announced is None or row.cells != (announced[1],)]
    if columns is None and table.separator == BLANK:
        body = _below_title(table, body, announced is not None)
    plan = columns or _without_header(table, body)
    is_named = columns is not None
    if columns is None and _is_header(table, body):
        body, is_named = body[1:], True
    width = len(table.rows[top - 1].cells) if top else 0
    if columns is not None and body and _lacks_first(table, body[0], width):
        columns = plan = columns.behind(1)
    points = []
    for number, row in enumerate(body):
        default = DefaultName.of(number)
        taken = gathering.take(row.line, row.text, _landmark, row, plan, table, side, default)
        if columns is not None and _word(row, columns.kind) == _SEMILANDMARK:
            points.append(taken)
    if points:
        gathering.add_group(ReadGroup("semilandmarks", is_curve=False), points)
    return gathering.reading(
        name,
        expected,
        is_pairs=plan is not None and plan.is_pairs,
        unit="" if columns is None else columns.unit,
        notes=_notes(table, body, plan, announced),
        doubts=_doubts(table, body, columns, is_named, plan),
    )


def _below_title(table: Table, rows: Sequence[Row], is_counted: bool) -> list[Row]:
    """Return rows without the remark below a count, and with names that stand a line above."""
    rows = list(rows)
    if is_counted and rows and not table.numbers_in(rows[0]):
        rows = rows[1:]
    above = [not table.numbers_in(row) and len(row.cells) == 1 for row in rows]
    named = []
    for number, row in enumerate(rows):
        count = table.numbers_in(row)
        if count >= len("xyz") and count == len(row.cells) and number and above[number - 1]:
            named.append(replace(row, cells=(rows[number - 1].cells[0], *row.cells[:3])))
        elif count >= len("xyz"):
            # Elsewhere names stand in the line itself.
            return rows
    return named or rows


def _notes(
    table: Table, rows: Sequence[Row], plan: Columns | None, announced: tuple[int, str] | None
) -> list[str]:
    notes = []
    used = {n for place in plan.places for n in place} if plan is not None else set()
    over = [
        n
        for row in rows[:1]
        for n, cell in enumerate(row.cells)
        if n not in used and plan is not None and n != plan.name and table.is_number(cell)
    ]
    if plan is not _NAMELESS and len(over) >= len("xyz"):
        notes.append(f"{len(over)} further columns of numbers were passed over.")
    if plan is _NAMELESS and any(table.numbers_in(row) > len("xyz") for row in rows[:1]):
        notes.append("The numbers behind the third of each row were passed over.")
    if announced and announced[0] != len(rows):
        notes.append(
            f"The file announces {announced[0]} landmarks and holds {len(rows)}: was it cut off?"
        )
    return notes


def _header(table: Table) -> tuple[int, Columns | None]:
    """Return the number of the first row below the header, and what the header says."""
    for number, row in enumerate(table.rows[:_TITLE_ROWS]):
        if table.numbers_in(row) >= len("xyz"):
            break
        columns = columns_of(row.cells)
        if columns is not None and not any(
            table.is_number(row.cells[n]) for place in columns.places for n in place
        ):
            return number + 1, columns
    return 0, _commented_header(table)


def _commented_header(table: Table) -> Columns | None:
    """Return what a comment above the first row says of its columns, if it names as many."""
    if not table.rows:
        return None
    first, width = table.rows[0].line, len(_trimmed(table.rows[0].cells))
    for row in reversed([row for row in table.comments if row.line < first]):
        cells = [word for word in (row.cells[0].lstrip("# "), *row.cells[1:]) if word]
        if len(cells) == width and (columns := columns_of(cells)):
            return columns
    return None


def _announced(table: Table, top: int) -> tuple[int, str] | None:
    """Return the count that a file of blank-separated numbers may begin with, and its text."""
    if table.separator != BLANK or not table.rows or top == 1:
        return None
    (first, *others) = table.rows[0].cells or ("",)
    is_count = not others and re.fullmatch("[0-9]{1,6}", first) is not None
    return (int(first), first) if is_count else None


def _is_header(table: Table, rows: Sequence[Row]) -> bool:
    """Whether the first row has no number where coordinates belong."""
    head = _trimmed(rows[0].cells) if rows else ()
    return len(head) > 2 and not any(map(table.is_number, _after_name(head)))


def _without_header(table: Table, rows: Sequence[Row]) -> Columns | None:
    """Return the columns of pairs; None where each row is of one side and tells by itself."""
    if _is_header(table, rows):
        head = [cell.strip().lower() for cell in _trimmed(rows[0].cells)]
        if sum(word.startswith(("source", "dest")) for word in head) >= 6:
            return _NAMELESS_PAIRS if head[0].startswith("source") else _NAMED_PAIRS
        return _NAMELESS if len(head) == len("xyz") else _NAMED
    if _only_begins_with_places(table, rows):
        return _NAMELESS
    for row in rows:
        if len(row.cells) == 6 and all(map(table.is_number, row.cells)):
            return _NAMELESS_PAIRS
        if len(row.cells) == 7 and all(map(table.is_number, row.cells[1:])):
            return _NAMED_PAIRS
    return None


def _only_begins_with_places(table: Table, rows: Sequence[Row]) -> bool:
    """Whether rows of more than three numbers are places with a value, normal or colour behind.

    Between blanks, as programs for point clouds write them; else a first number is a name, and
    six are a pair.
    """
    cells = [row.cells for row in rows if not row.problem]
    widths = {len(row) for row in cells}
    if table.separator != BLANK or len(widths) != 1 or min(widths) < 4:
        return False
    if not all(map(table.is_number, (cell for row in cells for cell in row))):
        return False
    if widths == {4}:
        # Numbers that count the rows are their names.
        first = [int(row[0]) if re.fullmatch("[0-9]{1,9}", row[0]) else -1 for row in cells]
        return first[0] < 0 or any(b - a != 1 for a, b in pairwise(first))
    try:
        behind = np.array([[number_of(x, table.decimals) for x in row[3:6]] for row in cells])
        places = np.array([[number_of(x, table.decimals) for x in row[:3]] for row in cells])
    except ValueError:
        return False
    if behind.shape[1] < len("xyz"):
        return True
    with np.errstate(over="ignore"):
        are_normals = bool((abs(np.linalg.norm(behind, axis=1) - 1) < _UNIT).all())
    are_bytes = bool(((behind >= 0) & (behind < 256) & (behind % 1 == 0)).all())
    return are_normals or (are_bytes and not bool((places % 1 == 0).all()))


_NAMELESS, _NAMED = Columns(((0, 1, 2),)), Columns(((1, 2, 3),), 0)
_NAMELESS_PAIRS = Columns(((0, 1, 2), (3, 4, 5)))
_NAMED_PAIRS = Columns(((1, 2, 3), (4, 5, 6)), 0)


def _lacks_first(table: Table, row: Row, width: int) -> bool:
    """Whether rows have a name in front for which R has written no column name."""
    return len(_trimmed(row.cells)) == width + 1 and not table.is_number(row.cells[0])


def _landmark(
    row: Row, columns: Columns | None, table: Table, side: Side, default: DefaultName
) -> Landmark:
    """Make a landmark of one row, or raise a ValueError with the reason."""
    if row.problem:
        raise ValueError(row.problem)
    if columns is None:
        columns = _of_row(table, row)
    cells = _trimmed(row.cells)
    last = max(column for place in columns.places for column in place)
    if not columns.is_pairs and len(cells) <= last:
        raise ValueError("it needs three coordinates")
    # The empty half of a pair may have lost its separators.
    cells = (*cells, *[""] * (last + 1))
    found = [position_of([cells[n] for n in place], table.decimals) for place in columns.places]
    if not columns.is_pairs and found[0] is None:
        raise ValueError("it has no coordinates")
    name = "" if columns.name is None else cells[columns.name]
    name = checked_name(formula_unquoted(name.strip())) or default
    source, destination = (
        found if columns.is_pairs else [found[0] if one is side else None for one in Side]
    )
    return Landmark(
        name,
        source,
        destination,
        role=_role(_word(row, columns.kind)),
        note=one_line(formula_unquoted(_cell(row, columns.note).strip())),
        locked=_yes(row, columns.locked, "locked", otherwise=False),
        enabled=_yes(row, columns.enabled, "enabled", otherwise=True),
    )


def _of_row(table: Table, row: Row) -> Columns:
    """Return the columns of a row that tells by itself: a name in front, behind, or none."""
    cells = _trimmed(row.cells)
    if len(cells) == len("xyz"):
        return _NAMELESS
    if len(cells) > 3 and all(map(table.is_number, cells[:3])) and not table.is_number(cells[3]):
        return Columns(((0, 1, 2),), 3)
    return _NAMED


def _role(word: str) -> Role:
    # OpenSim Creator's datapoints take no part in the solve.
    return Role.PASSENGER if word in ("passenger", "datapoint") else Role.PAIR


def _cell(row: Row, column: int | None) -> str:
    return row.cells[column] if column is not None and column < len(row.cells) else ""


def _word(row: Row, column: int | None) -> str:
    return _cell(row, column).strip().lower()


def _yes(row: Row, column: int | None, what: str, *, otherwise: bool) -> bool:
    word = _word(row, column)
    if not word:
        return otherwise
    if word not in YES_NO:
        raise ValueError(f"{what!r} is {shortened(word)} and not 1 or 0")
    return YES_NO[word]


def _doubts(
    table: Table,
    rows: Sequence[Row],
    columns: Columns | None,
    is_named: bool,
    plan: Columns | None,
) -> list[str]:
    """Say what makes one doubt that these are landmarks."""
    doubts = []
    numbers = max((table.numbers_in(row) for row in rows[:_LINES_LOOKED_AT]), default=0)
    if columns is not None and columns.over_time:
        doubts.append(f"It has a column {columns.over_time!r}, as recordings over time have.")
    if columns is None and is_named and (plan is None or not plan.is_pairs):
        doubts.append("The names of its columns are not x, y and z: the first numbers were taken.")
    many = _MANY_NUMBERS if columns is None else _MANY_COLUMNS
    if numbers >= many:
        doubts.append(
            f"Its rows have {numbers} numbers each: is it one row per specimen, or no file of "
            "landmarks?"
        )
    if columns is None and len(rows) > _MANY_NAMELESS and plan == _NAMELESS_PAIRS:
        doubts.append(f"It has {counted(len(rows), 'row')} of six numbers without a name.")
    return doubts


def _trimmed(cells: Sequence[str]) -> tuple[str, ...]:
    """Return the cells without the empty ones at the end, which spreadsheets add."""
    end = len(cells)
    while end and not cells[end - 1].strip():
        end -= 1
    return tuple(cells[:end])


def _after_name(cells: Sequence[str]) -> Sequence[str]:
    """Return the cells that hold coordinates: three columns have no name."""
    return cells if len(cells) == len("xyz") else cells[1:]
