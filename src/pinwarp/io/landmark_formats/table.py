"""Tables of text, whatever is between the cells."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from pinwarp.io.csv_cells import (
    is_number,
)
from pinwarp.io.csv_text import Row, rows_of, separator_of
from pinwarp.io.landmark_formats.table_header import words_of
from pinwarp.io.text import lines_of

BLANK = " "
_LINES_LOOKED_AT = 50
_EXCEL = re.compile(r'"?sep=(.)"?\s*$', re.IGNORECASE)


@dataclass(frozen=True)
class Table:
    """The rows of a table of text.

    Parameters
    ----------
    rows
        Those that are neither blank nor a comment.
    comments
        Those that start with #.
    separator
        What is between two cells; a blank stands for any number of blanks.
    """

    rows: tuple[Row, ...]
    comments: tuple[Row, ...]
    separator: str

    def is_number(self, cell: str) -> bool:
        """Whether a cell is meant as a number."""
        return is_number(cell, self.decimals)

    @property
    def decimals(self) -> str:
        """What stands for the separator where numbers are read: not a comma if it may be in one."""
        return ";" if self.separator == BLANK else self.separator

    def numbers_in(self, row: Row) -> int:
        """How many cells of a row are numbers."""
        return sum(map(self.is_number, row.cells))


def table_of(text: str) -> Table:
    r"""Split a text into the rows of a table.

    Parameters
    ----------
    text
        Cells are separated by commas, semicolons, tabs or blanks; Excel's line ``sep=;`` says so.

    Examples
    --------
    >>> [row.cells for row in table_of("sep=;\nfovea;1,5;2;3\n").rows]
    [('fovea', '1,5', '2', '3')]
    >>> [row.cells for row in table_of("left  tragus 1 2 3\n").rows]
    [('left tragus', '1', '2', '3')]
    """
    lines = lines_of(text)
    told = next((n for n, line in enumerate(lines) if line.strip()), 0)
    excel = _EXCEL.match(lines[told].strip()) if lines else None
    first = told + 1 if excel else 0
    head = [line for line in lines[first : first + _LINES_LOOKED_AT] if not line.startswith("#")]
    separator = excel[1] if excel else _separator_of(head)
    if separator == BLANK:
        # Nothing else tells a blank within a name from one between two cells.
        lines = [re.sub(r"[ \t\xa0]+", " ", line.strip(" \t\xa0\r\n")) + "\n" for line in lines]
    rows = [row for row in rows_of(lines[first:], separator, first + 1) if not row.is_blank]
    # A quoted "#1" is a name; only a bare # makes a comment.
    comments = tuple(row for row in rows if row.text.startswith("#"))
    table = Table(tuple(x for x in rows if not x.text.startswith("#")), comments, separator)
    if separator != BLANK:
        return table
    return replace(table, rows=tuple(_joined(row, table) for row in table.rows))


def is_blank_separated(lines: Iterable[str]) -> bool:
    """Whether lines hold three numbers between blanks, and nothing else separates them.

    Examples
    --------
    >>> is_blank_separated(["2", "C 1.5 2 3"]), is_blank_separated(["a, 1, 2, 3"])
    (True, False)
    """
    for line in islice((line for line in lines if line.strip()), 10):
        words = line.split()
        numbers = [is_number(word, ";") and word[-1] not in ",;" for word in words]
        if sum(numbers) >= len("xyz"):
            return True
    return False


def _separator_of(head: Sequence[str]) -> str:
    separator = separator_of(head[:10])
    if separator == "," and is_blank_separated(head):
        return BLANK
    return separator


def _joined(row: Row, table: Table) -> Row:
    """Return a row whose name, in front or behind, is one cell, however many words it has."""
    cells = list(row.cells)
    numbers = [n for n, cell in enumerate(cells) if table.is_number(cell)]
    if not numbers:
        # A header, whose last words are most likely x, y and z.
        axes = [n for n, word in enumerate(words_of(cells)) if word.lower() in ("x", "y", "z")]
        numbers = axes or [0, len(cells) - 1]
    front, behind = cells[: numbers[0]], cells[numbers[-1] + 1 :]
    between = cells[numbers[0] : numbers[-1] + 1]
    joined = [BLANK.join(front)] if front else []
    joined += [*between, *([BLANK.join(behind)] if behind else [])]
    return replace(row, cells=tuple(joined))
