"""Text as other programs store it: the one place where bytes become lines, for every text format.

Marks in front, wide characters and line ends of all three kinds are dealt with here, so that no
format has to know of them.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.io.reading import read_content

LARGEST = 64 << 20
_LOOKED_AT = 64
_CHUNK = 1 << 20
_LINE_END = re.compile(rb"\r\n|\n|\r")
# The wider ones first: the mark of UTF-32 begins with that of UTF-16.
_MARKS = (
    (b"\xff\xfe\0\0", "utf-32"),
    (b"\0\0\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
_MARK = "\ufeff"


def decoded(data: bytes) -> str:
    r"""Return bytes as text: UTF-8, UTF-16 and UTF-32 with a mark or without, else Windows-1252.

    Parameters
    ----------
    data
        All of it.

    Returns
    -------
    str
        Without the mark, line ends as they are; see :func:`lines_of`.

    Examples
    --------
    >>> decoded(b"\xef\xbb\xbffovea\r\n"), decoded("fovea".encode("utf-16")), decoded(b"l\xe4nge")
    ('fovea\r\n', 'fovea', 'länge')
    """
    # Spreadsheets save "Unicode text" as UTF-16, and plain CSV in the old Windows encoding.
    for encoding in (_wide_encoding(data) or "utf-8", "cp1252"):
        try:
            return data.decode(encoding).removeprefix(_MARK)
        except UnicodeDecodeError:
            continue
    return data.decode("latin-1")


def narrow(data: bytes) -> bytes:
    r"""Return the bytes of a text with one byte for each letter of ASCII, and no mark.

    For files too large to become a ``str``, and for those that are text in their head alone.

    Parameters
    ----------
    data
        All of it; what is neither marked nor wide is returned as it is, without a copy.

    Examples
    --------
    >>> narrow("\ufeffv 0 0 0".encode()), narrow("v 0 0 0".encode("utf-16"))
    (b'v 0 0 0', b'v 0 0 0')
    """
    if _wide_encoding(data):
        return decoded(data).encode(errors="replace")
    return data.removeprefix(_MARK.encode())


def _wide_encoding(data: bytes) -> str | None:
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return encoding
    # Without a mark, every second byte of plain words is a zero.
    head = data[:_LOOKED_AT]
    first, second = head[::2], head[1::2]
    if len(second) > 1:
        if all(first) and not any(second):
            return "utf-16-le"
        if all(second) and not any(first):
            return "utf-16-be"
    return None


@dataclass(frozen=True, eq=False)
class Lines:
    r"""A stretch of whole lines of a large text.

    Parameters
    ----------
    data
        The lines; each ends in ``\n``, whatever it ends in in the file, but for the last.
    first
        The number of the first, counted from 1.
    share
        How much of the text is behind them once these are read, 0 ... 1.
    """

    data: bytes
    first: int
    share: float


def stretches_of(data: bytes, begin: int = 0, first_line: int = 1) -> Iterator[Lines]:
    r"""Yield a large text in stretches of about a megabyte.

    Parameters
    ----------
    data
        All of it, narrow.
    begin
        Where to begin.
    first_line
        The number of the line that begins there.

    Examples
    --------
    >>> [(lines.data, lines.first) for lines in stretches_of(b"a\r\nb\rc")]
    [(b'a\nb\nc', 1)]
    """
    while begin < len(data):
        end = _LINE_END.search(data, begin + _CHUNK)
        stop = end.end() if end else len(data)
        part = with_lf(data[begin:stop])
        yield Lines(part, first_line, stop / len(data))
        first_line += part.count(b"\n")
        begin = stop


def with_lf(data: bytes) -> bytes:
    r"""Return narrow text whose lines all end in LF; without a copy where they do.

    Examples
    --------
    >>> with_lf(b"a\r\nb\rc\n")
    b'a\nb\nc\n'
    """
    if b"\r" not in data:
        return data
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def read_text(path: str | Path, what: str, largest: int = LARGEST) -> str:
    r"""Read a text file in any of the encodings of :func:`decoded`.

    Parameters
    ----------
    path
        The file.
    what
        What it should be, for the messages.
    largest
        Refuse files of more bytes than this.

    Returns
    -------
    str
        Its text, line ends as they are.

    Raises
    ------
    FileFormatError
        When it is missing, empty, too large or not readable.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "a.csv")
    ...     _ = path.write_bytes(b"\xef\xbb\xbfname,x,y,z\r\n")
    ...     read_text(path, "landmark")
    'name,x,y,z\r\n'
    """
    return decoded(read_content(path, what=what, largest=largest).data)


def lines_of(text: str) -> list[str]:
    r"""Split text at LF, CRLF and CR only, keeping the line ends.

    Examples
    --------
    >>> lines_of("a\r\nb\u2028c")
    ['a\r\n', 'b\u2028c']
    """
    return list(io.StringIO(text, newline=""))


def filled_lines(text: str, comments: tuple[str, ...] = ()) -> Iterator[tuple[int, str]]:
    r"""Yield the number and the text of every line that is not blank, counted from 1.

    Parameters
    ----------
    text
        The text.
    comments
        What a line begins with that says nothing to a program.

    Examples
    --------
    >>> list(filled_lines("# by hand\r\nVersion 1.0\r\n\r\n 2 \r\n", ("#",)))
    [(2, 'Version 1.0'), (4, '2')]
    """
    for number, line in enumerate(lines_of(text), 1):
        stripped = line.strip()
        if stripped and not stripped.startswith(comments):
            yield number, stripped


def refuse_binary(path: str | Path, text: str) -> None:
    """Raise when what was read as text is not text.

    Raises
    ------
    FileFormatError
        When it holds a zero character, which no text does.

    Examples
    --------
    >>> refuse_binary("a.csv", "name,x,y,z")
    """
    if "\0" in text:
        raise FileFormatError(path, "This is not a text file. Choose a file of landmarks.")
