"""Getting at the bytes of a file, with words for what can go wrong."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import FileFormatError

_CHUNK = 4 << 20


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
    largest: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> Content:
    """Read a whole file.

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
        When the file is missing, a folder, empty, too large or may not be read.

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
    chunks = []
    for chunk, share in _chunks(place, what, largest):
        digest.update(chunk)
        chunks.append(chunk)
        if progress is not None:
            progress(share)
    if not chunks:
        raise FileFormatError(place, f"The file is empty. Save or export the {what} again.")
    return Content(place, b"".join(chunks), digest.hexdigest())


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
        for chunk, share in _chunks(Path(path), "session", None):
            digest.update(chunk)
            if progress is not None:
                progress(share)
    except FileFormatError:
        return None
    return digest.hexdigest()


def _chunks(place: Path, what: str, largest: int | None) -> Iterator[tuple[bytes, float]]:
    """Yield the file in pieces, each with the share read so far; other threads run between."""
    if place.is_dir():
        raise FileFormatError(place, f"This is a folder. Choose the {what} file inside it.")
    try:
        with place.open("rb") as file:
            size = os.fstat(file.fileno()).st_size
            if largest is not None and size > largest:
                raise FileFormatError(
                    place,
                    f"{size / 2**20:.0f} MB is too large for a {what} file "
                    f"(at most {largest >> 20} MB). Check that it is the right file.",
                )
            done = 0
            while chunk := file.read(_CHUNK):
                done += len(chunk)
                yield chunk, min(1.0, done / max(size, 1))
    except FileNotFoundError:
        raise FileFormatError(
            place, f"There is no such file in {place.parent}. Was it moved or renamed?"
        ) from None
    except (OSError, ValueError) as error:
        if isinstance(error, FileFormatError):
            raise
        reason = getattr(error, "strerror", None) or error
        raise FileFormatError(place, f"The file cannot be read: {reason}.") from error
