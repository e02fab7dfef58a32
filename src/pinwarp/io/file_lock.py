"""A lock that ends with the process that holds it, however that process ends."""

from __future__ import annotations

import os
from pathlib import Path

from filelock import lock_descriptor


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

    # Not filelock's own FileLock: it would make the file that tells a window's folder from others.
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
            is_ours = lock_descriptor(handle, blocking=False)
        except OSError:
            is_ours = True
        if not is_ours:
            os.close(handle)
            return None
        return cls(handle)

    def release(self) -> None:
        """Let go of the file; a second time does nothing."""
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None
