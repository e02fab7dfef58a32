"""Writing a file so that it is there whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def write_atomically(path: str | Path, content: bytes | str) -> None:
    r"""Write a whole file, replacing what was there only once all of it is on the disk.

    Parameters
    ----------
    path
        The file; a symbolic link keeps pointing at its target, which is replaced.
    content
        The bytes, or text to be written as UTF-8 without touching its line ends.

    Raises
    ------
    OSError
        When the disk is full or the place may not be written to; the old file is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_atomically(Path(folder, "note.txt"), "two lines\nof text\n")
    ...     Path(folder, "note.txt").read_bytes()
    b'two lines\nof text\n'
    """
    # A file name that is not Unicode must not keep a session from being saved.
    data = content.encode("utf-8", errors="replace") if isinstance(content, str) else content
    with atomic_path(path) as temporary:
        temporary.write_bytes(data)


@contextmanager
def atomic_path(path: str | Path) -> Iterator[Path]:
    """Give a temporary file beside ``path`` that replaces it when the block succeeds.

    Parameters
    ----------
    path
        The file to be written in the end.

    Yields
    ------
    Path
        An empty file in the same folder with the same suffix, removed when the block fails.

    Raises
    ------
    OSError
        When the disk is full or the place may not be written to; the old file is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with atomic_path(Path(folder, "bone.stl")) as temporary:
    ...         _ = temporary.write_text("solid")
    ...     print(temporary.suffix, Path(folder, "bone.stl").read_text(), temporary.exists())
    .stl solid False
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(target))
    # Replacing needs no write permission on the old file, but its owner took it away on purpose.
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(target))
    temporary = target.with_name(f".pinwarp-{secrets.token_hex(6)}{target.suffix}")
    # Not tempfile: its files are private, and new files should follow the user's umask.
    os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    try:
        yield temporary
        if target.exists():
            temporary.chmod(target.stat().st_mode & 0o7777)
        _flush(temporary)
        temporary.replace(target)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    if os.name == "posix":
        _flush(target.parent)


def _flush(path: Path) -> None:
    """Wait until a file, or a folder's list of files, is on the disk."""
    # Windows flushes only what was opened for writing; folders open read-only everywhere.
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
