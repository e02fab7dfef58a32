"""Writing a file so that it is there whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pinwarp.io.reading import refuse_special

SWEPT_AFTER = 3600.0
"""Seconds after which nobody is still writing a temporary file that nothing was added to."""
_WAITS = (0.02, 0.05, 0.1, 0.2)
_TEMPORARY = re.compile(r"\.pinwarp-[0-9a-f]{12}(\.[^.]*)?")


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
        When the disk is full, or the place may not be written to or is no file but a device; the
        old file is untouched.

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
    if os.path.exists(target):
        # In the place of a pipe or of a device there would be a file that nobody looks for.
        refuse_special(target, os.stat(target).st_mode)
        # Replacing needs no write permission on the old file, but its owner took it away.
        if not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(target))
    temporary = target.with_name(f".pinwarp-{secrets.token_hex(6)}{target.suffix}")
    try:
        # Not tempfile: its files are private, and new files should follow the user's umask.
        os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield temporary
        if target.exists():
            temporary.chmod(target.stat().st_mode & 0o7777)
        _flush(temporary)
        _replace(temporary, target)
        if os.name == "posix":
            _flush(target.parent)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        # What is written knows no name, and the temporary one says nothing to the user.
        # Without a number the words are the writer's own, and a name would displace them.
        if (
            isinstance(error, OSError)
            and error.errno is not None
            and error.filename in (None, str(temporary))
        ):
            error.filename, error.filename2 = str(target), None
        raise
    sweep(target.parent)


def sweep(folder: Path) -> None:
    """Remove what writers have left in a folder that were killed: old temporary files of ours.

    Parameters
    ----------
    folder
        Where something was written; the folders in it are not looked into, and what cannot be
        removed stays.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     left = Path(folder, ".pinwarp-0123456789ab.stl")
    ...     left.touch()
    ...     os.utime(left, (0, 0))
    ...     sweep(Path(folder))
    ...     left.exists()
    False
    """
    before = time.time() - SWEPT_AFTER
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if _TEMPORARY.fullmatch(entry.name):
                with contextlib.suppress(OSError):
                    _remove_if_left(entry, before)


def _remove_if_left(entry: os.DirEntry[str], before: float) -> None:
    found = entry.stat(follow_symlinks=False)
    is_own = not hasattr(os, "getuid") or found.st_uid == os.getuid()
    if stat.S_ISREG(found.st_mode) and is_own and found.st_mtime < before:
        os.unlink(entry.path)


def _replace(temporary: Path, target: Path) -> None:
    """Put a file in another's place; on Windows nobody may be reading that one just now."""
    for wait in _WAITS:
        # Another window, or what looks for viruses, is done with it in a moment.
        with contextlib.suppress(PermissionError):
            temporary.replace(target)
            return
        time.sleep(wait)
    temporary.replace(target)


def _flush(path: Path) -> None:
    """Wait until a file, or a folder's list of files, is on the disk."""
    # Windows flushes only what was opened for writing; folders open read-only everywhere.
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
