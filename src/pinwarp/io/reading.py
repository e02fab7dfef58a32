"""Getting at the bytes of a file, with words for what can go wrong."""

from __future__ import annotations

import errno
import hashlib
import io
import os
import stat
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError

LARGEST = 1 << 30
"""More bytes than any mesh that can be worked on; nothing larger is read to its end."""

_LARGEST_UNSIZED = 64 << 20
_CHUNK = 4 << 20
_KINDS = (
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)
# A pipe that nobody writes to would keep its reader waiting; files do not know the flags.
_WITHOUT_WAITING = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)


@dataclass(frozen=True, eq=False)
class Content:
    """All bytes of a file and their SHA-256, taken in one go so that they belong together."""

    path: Path
    data: bytes
    sha256: str


def read_content(
    path: str | Path,
    *,
    what: str,
    largest: int = LARGEST,
    progress: Callable[[float], None] | None = None,
) -> Content:
    """Read a whole file: nothing but regular files, and never more of one than is allowed.

    Parameters
    ----------
    path
        The file.
    what
        What it should be, for the messages: "mesh", "session".
    largest
        Refuse files of more bytes than this.
    progress
        Told the share that was read; what it raises ends the reading.

    Returns
    -------
    Content
        The bytes, under the file's absolute path.

    Raises
    ------
    FileFormatError
        When the file is missing, empty, too large, may not be read, or is no file at all but a
        folder, a pipe or a device.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "a.txt").write_bytes(b"abc")
    ...     read_content(Path(folder, "a.txt"), what="text").data
    b'abc'
    """
    place = Path(os.path.abspath(path))
    digest = hashlib.sha256()
    # Gives its bytes away without a second copy of them.
    whole = io.BytesIO()
    for chunk, share in _chunks(place, what, largest):
        digest.update(chunk)
        whole.write(chunk)
        if progress is not None:
            progress(share)
    data = whole.getvalue()
    if not data:
        raise FileFormatError(
            place, "The file is empty. Save or export it again where it came from."
        )
    return Content(place, data, digest.hexdigest())


def hash_of(path: str | Path, *, progress: Callable[[float], None] | None = None) -> str | None:
    """Return the SHA-256 of a file in hexadecimal digits, None when it cannot be read.

    Parameters
    ----------
    path
        The file.
    progress
        Told the share that was read; what it raises ends the reading.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "a.txt").write_bytes(b"abc")
    ...     hash_of(Path(folder, "a.txt"))[:8], hash_of(Path(folder, "b.txt"))
    ('ba7816bf', None)
    """
    digest = hashlib.sha256()
    try:
        for chunk, share in _chunks(Path(path), "session", LARGEST):
            digest.update(chunk)
            if progress is not None:
                progress(share)
    except FileFormatError:
        return None
    return digest.hexdigest()


def open_regular(path: str | Path) -> io.FileIO:
    """Open a file for reading, without ever waiting for one.

    Parameters
    ----------
    path
        The file; links are followed.

    Returns
    -------
    FileIO
        To be closed by the caller.

    Raises
    ------
    OSError
        When it cannot be opened; with ``EINVAL`` when it is no file but a pipe or a device.

    Examples
    --------
    >>> open_regular(".")
    Traceback (most recent call last):
    ...
    IsADirectoryError: [Errno 21] Is a directory: '.'
    """
    # Looked at before, since opening alone may do something to a device, and after, since it may
    # have become another file in between.
    refuse_special(path, os.stat(path).st_mode)
    file = io.FileIO(os.fspath(path), "rb", opener=_open_without_waiting)
    try:
        refuse_special(path, os.fstat(file.fileno()).st_mode)
    except OSError:
        file.close()
        raise
    return file


def refuse_special(path: str | Path, mode: int) -> None:
    """Raise where the mode of a path is that of no file.

    Raises
    ------
    OSError
        ``EISDIR`` for a folder, ``EINVAL`` for a pipe, a socket or a device.

    Examples
    --------
    >>> refuse_special("femur.stl", stat.S_IFREG)
    """
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        kind = next((words for is_kind, words in _KINDS if is_kind(mode)), "something else")
        raise OSError(errno.EINVAL, f"it is {kind} and not a file", str(path))


def _open_without_waiting(path: str, flags: int) -> int:
    return os.open(path, flags | _WITHOUT_WAITING)


def _chunks(place: Path, what: str, largest: int) -> Iterator[tuple[bytes, float]]:
    """Yield the file in pieces, each with the share read so far; other threads run between."""
    try:
        with open_regular(place) as file:
            size = os.fstat(file.fileno()).st_size
            if size > largest:
                raise _too_large(place, f"{_in_words(size)} is", what, largest)
            # What has no size to begin with need not have an end.
            limit = largest if size else min(largest, _LARGEST_UNSIZED)
            done = 0
            while chunk := _next_chunk(file):
                done += len(chunk)
                # What the system says of the size need not be true: files of /proc have none.
                if done > limit:
                    raise _too_large(place, "The file goes on and on: it is", what, limit)
                yield chunk, min(1.0, done / max(size, done, 1))
    except FileNotFoundError:
        raise FileFormatError(
            place, f"There is no such file in {place.parent}. Was it moved or renamed?"
        ) from None
    except IsADirectoryError:
        raise FileFormatError(
            place, f"This is a folder. Choose the {what} file inside it."
        ) from None
    except (OSError, ValueError) as error:
        if isinstance(error, FileFormatError):
            raise
        reason = getattr(error, "strerror", None) or error
        advice = (
            f" Save what comes from it to a file, and choose that as the {what}."
            if getattr(error, "errno", None) in (errno.EINVAL, errno.EAGAIN)
            else ""
        )
        raise FileFormatError(place, f"The file cannot be read: {reason}.{advice}") from error


def _next_chunk(file: io.FileIO) -> bytes:
    chunk = file.read(_CHUNK)
    if chunk is None:
        # A file only by name, such as the kernel's log, that would have us wait for more.
        raise BlockingIOError(errno.EAGAIN, "it has no end")
    return chunk


def _too_large(place: Path, words: str, what: str, largest: int) -> FileFormatError:
    return FileFormatError(
        place,
        f"{words} too large for a {what} file (at most {_in_words(largest)}). "
        "Check that it is the right file.",
    )


def _in_words(size: int) -> str:
    return f"{size / 2**30:.1f} GB" if size >= 1 << 30 else f"{size / 2**20:.0f} MB"
