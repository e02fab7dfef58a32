"""CSV as people and spreadsheets write it, for every format that is a table of text."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from pinwarp.io.csv_cells import Numeral, formula_quoted

LONGEST_CELL = 100_000
"""Below what Python's reader takes, quotes included or not."""

_NEEDS_QUOTES = re.compile(r'[,;"\t\r\n]|^[\s#]|\s$')


@dataclass(frozen=True)
class Row:
    """One row of a table.

    Parameters
    ----------
    line
        The line it begins at, counted from 1.
    cells
        Its cells; none where the row is blank or broken.
    text
        The row as it stands in the file.
    problem
        Why it cannot be split into cells, or nothing.
    """

    line: int
    cells: tuple[str, ...]
    text: str
    problem: str = ""

    @property
    def is_blank(self) -> bool:
        """Whether there is nothing in any cell."""
        return not self.problem and not any(cell.strip() for cell in self.cells)


def separator_of(lines: Iterable[str]) -> str:
    """Find what separates the cells: ``;`` or a tab if every line has two of them, else ``,``.

    Parameters
    ----------
    lines
        A few lines of the table; blank ones do not count.

    Examples
    --------
    >>> separator_of(["a;1,5;2,5;3,5"]), separator_of(["name,x,y,z", "a;b;c,1,2,3"])
    (';', ',')
    """
    filled = [line for line in lines if line.strip()]
    for separator in ";\t":
        if filled and all(_cells_in(line, separator) > 2 for line in filled):
            return separator
    return ","


def _cells_in(line: str, separator: str) -> int:
    # What is between quotes separates nothing.
    return sum(part.count(separator) for part in line.split('"')[::2]) + 1


def rows_of(lines: Sequence[str], separator: str, first_line: int = 1) -> Iterator[Row]:
    r"""Split lines into rows of cells; a quoted cell may go on over several lines.

    Parameters
    ----------
    lines
        The lines with their ends.
    separator
        What is between two cells.
    first_line
        The number of the first line.

    Yields
    ------
    Row
        A row whose quotes do not end is yielded as a problem, and reading goes on below it.

    Examples
    --------
    >>> [row.cells for row in rows_of(['a,"b, c"\n', "d\n"], ",")]
    [('a', 'b, c'), ('d',)]
    """
    start = 0
    while start < len(lines):
        # Strict: a quote that is never closed would swallow every row below it in silence.
        rest = (lines[number] for number in range(start, len(lines)))
        reader = csv.reader(rest, delimiter=separator, strict=True)
        done = 0
        try:
            for cells in reader:
                text = "".join(lines[start + done : start + reader.line_num]).rstrip("\r\n")
                yield Row(first_line + start + done, tuple(cells), text)
                done = reader.line_num
            return
        except csv.Error as error:
            broken = start + done
            text = lines[broken].rstrip("\r\n")
            yield Row(first_line + broken, (), text, f"the quotes do not match ({error})")
            start = broken + 1


def csv_line(cells: Iterable[str], separator: str = ",", *, all_in_quotes: bool = False) -> str:
    r"""Return one line of a table that a spreadsheet may open: none of its cells is run.

    All tables are written by it. What :func:`~pinwarp.io.csv_cells.formula_quoted` put before a
    cell is taken back where the table is read.

    Parameters
    ----------
    cells
        Text, or a :class:`~pinwarp.io.csv_cells.Numeral`, which stays a number.
    separator
        What is between two cells.
    all_in_quotes
        Whether cells are in quotes that do not need them.

    Examples
    --------
    >>> csv_line(["a", "b, c", "=1+1", "-7", Numeral("-7")])
    'a,"b, c",\'=1+1,\'-7,-7\n'
    """
    safe = (cell if isinstance(cell, Numeral) else formula_quoted(cell) for cell in cells)
    return plain_line(safe, separator, all_in_quotes=all_in_quotes)


def plain_line(cells: Iterable[str], separator: str = ",", *, all_in_quotes: bool = False) -> str:
    r"""Return one line of separated cells for a program that is no spreadsheet.

    Parameters
    ----------
    cells, separator, all_in_quotes
        As in :func:`csv_line`. Cells are quoted per RFC 4180 where they need it.

    Examples
    --------
    >>> plain_line(["a", "b, c", "=1+1"])
    'a,"b, c",=1+1\n'
    """
    quoted = [
        '"' + cell.replace('"', '""') + '"' if all_in_quotes or _NEEDS_QUOTES.search(cell) else cell
        for cell in cells
    ]
    return separator.join(quoted) + "\n"
