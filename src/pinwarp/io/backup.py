"""The version before the one just saved, kept beside it."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path

from pinwarp.io.atomic import atomic_path
from pinwarp.io.file_names import backup_of
from pinwarp.io.reading import open_regular
from pinwarp.io.text import LARGEST


def write_keeping_previous(path: Path, write: Callable[[Path], None]) -> OSError | None:
    """Write a file and keep what it held before as ``NAME.bak``.

    The backup comes second: whatever happens to it, the file is saved.

    Parameters
    ----------
    path
        The file.
    write
        Writes it, all of it or nothing.

    Returns
    -------
    OSError or None
        What kept the backup from being written. An older backup stays then.

    Raises
    ------
    OSError
        When the file cannot be written; it and its backup are untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "femur.pinwarp.csv")
    ...     _ = path.write_text("old")
    ...     write_keeping_previous(path, lambda path: path.write_text("new"))
    ...     print(path.read_text(), Path(folder, "femur.pinwarp.csv.bak").read_text())
    new old
    """
    previous, unreadable = None, None
    try:
        previous = _content(path)
    except FileNotFoundError:
        pass
    except OSError as error:
        unreadable = error
    write(path)
    if previous is None:
        return unreadable
    try:
        # Saving the same twice must not push out the last version that was different.
        if _content(path) == previous:
            return None
        with atomic_path(backup_of(path)) as temporary:
            temporary.write_bytes(previous)
            shutil.copymode(path, temporary)
    except OSError as error:
        return error
    return None


def _content(path: Path) -> bytes:
    """Return all of a file; one that no session is as large as raises ``EFBIG``."""
    with open_regular(path) as file:
        if os.fstat(file.fileno()).st_size > LARGEST:
            raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
        return file.readall()
