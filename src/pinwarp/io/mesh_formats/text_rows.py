"""Tables of numbers in text, a row a line: what PLY and OFF files hold below their head.

A row is a line: where rows are longer than announced, numbers read across line ends would all be
taken for something else from there on.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from pinwarp.io.mesh_formats.numbers import numbers_of
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Report
from pinwarp.io.text import Lines, stretches_of

# Within a word it is part of what Microsoft's libraries write for no number.
_COMMENT = re.compile(rb"(?:^|(?<=\s))#[^\n]*", re.M)

_Row = list[bytes]


class TextRows:
    r"""The rows of a text, taken from the top; blank lines and comments are none.

    Parameters
    ----------
    data
        The text, narrow.
    begin, first_line
        Where the rows begin, and the number of that line.
    report
        Told the share that is behind.
    has_comments
        Whether what follows a ``#`` is for people.

    Examples
    --------
    >>> rows = TextRows(b"0 0 7\n\n3 0 1 2 255\n", 0, 1, lambda share: None)
    >>> rows.table(1, 2).tolist(), [part.tolist() for part in rows.lists(1)]
    ([[0.0, 0.0]], [[0, 1, 2], [3]])
    """

    def __init__(
        self,
        data: bytes,
        begin: int,
        first_line: int,
        report: Report,
        *,
        has_comments: bool = False,
    ) -> None:
        self._stretches = stretches_of(data, begin, first_line)
        self._report = report
        self._has_comments = has_comments
        self._rows: list[_Row] = []
        self._numbers: list[int] = []
        self._last = first_line
        self.longer = 0
        """Rows of the table last taken that hold more than was announced."""

    def table(self, count: int, width: int, *, row_width: int = 0) -> NDArray[np.float64]:
        """Return the first few numbers of the next rows.

        Parameters
        ----------
        count
            How many rows.
        width
            How many numbers of each are wanted.
        row_width
            How many each row holds, where that is more.

        Returns
        -------
        ndarray
            (count, width) numbers.

        Raises
        ------
        BrokenMeshError
            When there are fewer rows, or a row is too short or not numbers.
        """
        needed = max(width, row_width)
        parts = [np.empty((0, width))]
        self.longer = 0
        for rows, numbers in self._taken(count):
            sizes = list(map(len, rows))
            if min(sizes) < needed:
                raise _short(numbers[next(n for n, size in enumerate(sizes) if size < needed)])
            self.longer += sum(size > needed for size in sizes)
            words = list(chain.from_iterable(row[:width] for row in rows))
            parts.append(_floats(words, rows, numbers, width).reshape(-1, width))
        return np.concatenate(parts)

    def lists(
        self, count: int, layout: Sequence[bool] = (True,), wanted: int = 0
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the whole numbers of one list in each of the next rows.

        Parameters
        ----------
        count
            How many rows.
        layout
            What a row is made of: lists, which begin with their length, or single numbers.
        wanted
            Which of them.

        Returns
        -------
        numbers, sizes
            The numbers of all rows in a row, and how many come from each.

        Raises
        ------
        BrokenMeshError
            When there are fewer rows, one is too short, or a length or number is not whole.
        """
        corners, sizes = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
        self.longer = 0
        for rows, numbers in self._taken(count):
            if len(layout) == 1 and all(len(row) > 3 and row[0] == b"3" for row in rows):
                # Triangles and nothing else, as nearly all are.
                found = [row[1:4] for row in rows]
                self.longer += sum(len(row) > 4 for row in rows)
            else:
                found = [
                    self._list_in(row, layout, wanted, number)
                    for row, number in zip(rows, numbers, strict=True)
                ]
            words = list(chain.from_iterable(found))
            sizes.append(np.array(list(map(len, found)), dtype=np.int64))
            corners.append(_whole(words, found, numbers))
        return np.concatenate(corners), np.concatenate(sizes)

    def skip(self, count: int) -> None:
        """Pass over rows.

        Raises
        ------
        BrokenMeshError
            When there are fewer.
        """
        for _ in self._taken(count):
            pass

    def left_over(self) -> int:
        """Return how many rows there are below all that was taken."""
        count = len(self._rows)
        for lines in self._stretches:
            self._split(lines)
            count += len(self._rows)
        self._rows = []
        return count

    def _list_in(self, row: _Row, layout: Sequence[bool], wanted: int, number: int) -> _Row:
        place, found = 0, []
        for which, is_list in enumerate(layout):
            if place >= len(row):
                raise _short(number)
            begin, length = place, 1
            if is_list:
                begin, length = place + 1, _length(row[place], number)
            place = begin + length
            if which == wanted:
                found = row[begin:place]
        if place > len(row):
            raise _short(number)
        self.longer += place < len(row)
        return found

    def _taken(self, count: int) -> Iterator[tuple[list[_Row], list[int]]]:
        """Yield the next rows and the numbers of their lines, about a megabyte at a time."""
        while count > 0:
            if not self._rows:
                lines = next(self._stretches, None)
                if lines is None:
                    raise BrokenMeshError(
                        f"The file ends at line {self._last:,}, but {count:,} more rows are "
                        "announced: it was cut off or is damaged. Export or copy it again."
                    )
                self._split(lines)
                continue
            rows, self._rows = self._rows[:count], self._rows[count:]
            numbers, self._numbers = self._numbers[:count], self._numbers[count:]
            self._last = numbers[-1]
            count -= len(rows)
            yield rows, numbers

    def _split(self, lines: Lines) -> None:
        data = lines.data
        if self._has_comments and b"#" in data:
            data = _COMMENT.sub(b"", data)
        texts = data.split(b"\n")
        self._rows = [text.split() for text in texts]
        self._numbers = list(range(lines.first, lines.first + len(texts)))
        if not all(self._rows):
            filled = [n for n, row in enumerate(self._rows) if row]
            self._rows = [self._rows[n] for n in filled]
            self._numbers = [self._numbers[n] for n in filled]
        self._report(lines.share)


def _floats(
    words: list[bytes], rows: list[_Row], numbers: list[int], width: int
) -> NDArray[np.float64]:
    try:
        return numbers_of(words).astype(np.float64, copy=False)
    except ValueError as error:
        for row, number in zip(rows, numbers, strict=True):
            try:
                numbers_of(row[:width])
            except ValueError:
                raise BrokenMeshError(
                    f"Expected are {width} numbers. Repair this line or export the mesh again.",
                    number,
                ) from error
        raise


def _whole(words: list[bytes], found: list[_Row], numbers: list[int]) -> NDArray[np.int64]:
    try:
        return np.array(words, dtype=np.int64)
    except (ValueError, OverflowError):
        # Some programs write 3.0; where it is not whole, the line is told.
        for row, number in zip(found, numbers, strict=True):
            for word in row:
                _whole_number(word, number)
        return np.array([_whole_number(word, 0) for word in words], dtype=np.int64)


def _length(word: bytes, line: int) -> int:
    if word.isdigit() and len(word) < 10:
        return int(word)
    length = _whole_number(word, line)
    if length < 0:
        raise BrokenMeshError(f"A list cannot have {length} numbers. Export the mesh again.", line)
    return length


def _whole_number(word: bytes, line: int) -> int:
    try:
        value = float(word)
        # None of 2**53 or more is the number of a vertex.
        if value.is_integer() and abs(value) < 2**53:
            return int(value)
    except ValueError:
        pass
    raise BrokenMeshError(
        f"{word[:20].decode('latin-1')!r} is not a whole number. "
        "Repair this line or export the mesh again.",
        line,
    )


def _short(line: int) -> BrokenMeshError:
    return BrokenMeshError(
        "The line ends before all that is announced for it: the file was cut off or is damaged. "
        "Export or copy it again.",
        line,
    )
