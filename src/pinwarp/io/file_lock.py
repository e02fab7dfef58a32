"""A lock that ends with the process that holds it, however that process ends."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path

if sys.platform == "win32":
    import msvcrt

    def _lock(handle: int) -> None:
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(handle: int) -> None:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


_HELD = (errno.EACCES, errno.EAGAIN, errno.EWOULDBLOCK, errno.EDEADLK)


class FileLock:
    """A lock on a file, held from :meth:`take` until :meth:`release` or the end of the process.

    The operating system lets go of it, so that ``kill -9`` leaves no stale lock behind.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "lock")
    ...     path.touch()
    ...     lock = FileLock.take(path)
    ...     print(FileLock.take(path))
    ...     lock.release()
    None
    """

    def __init__(self, handle: int) -> None:
        self._handle: int | None = handle

    @classmethod
    def take(cls, path: Path) -> FileLock | None:
        """Lock a file that exists, or return None where somebody else has.

        A file system that knows no locks locks nothing, and does not stand in the way.

        Raises
        ------
        OSError
            When the file is not there or may not be opened.
        """
        handle = os.open(path, os.O_RDWR)
        try:
            _lock(handle)
        except OSError as error:
            if error.errno in _HELD:
                os.close(handle)
                return None
        return cls(handle)

    def release(self) -> None:
        """Let go of the file; a second time does nothing."""
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None
