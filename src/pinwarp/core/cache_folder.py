"""Where compiled code is kept: a folder that nobody else can put anything into.

What lies in numba's cache is run when it is read, so that whoever writes there runs as us.
"""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import tempfile
from pathlib import Path

import platformdirs

_OTHERS = stat.S_IRWXG | stat.S_IRWXO
_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
_ROOT = 0


def private_cache() -> Path:
    """Return the user's cache folder, or a fresh one where that is not safe or cannot be made.

    Returns
    -------
    Path
        A folder of mode 0700 that belongs to the user. A fresh one has a name that nobody can
        foresee, and goes when the program ends.

    Examples
    --------
    >>> private_cache().is_dir()
    True
    """
    folder = Path(platformdirs.user_cache_path("pinwarp")) / "compiled"
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        # Links above it may be the user's own; what they lead to is looked at.
        folder = Path(os.path.realpath(folder.parent)) / folder.name
        folder.mkdir(mode=0o700, exist_ok=True)
        if is_private(folder) and os.access(folder, os.W_OK | os.X_OK):
            return folder
    except (OSError, RuntimeError):
        pass
    fresh = Path(tempfile.mkdtemp(prefix="pinwarp-"))
    atexit.register(shutil.rmtree, fresh, ignore_errors=True)
    return fresh


def is_private(folder: Path) -> bool:
    """Say whether a folder is the user's alone, and nobody else can put another in its place.

    Parameters
    ----------
    folder
        An absolute path without links. On systems without owners by number, the user's cache
        folder is taken as the system protects it.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     before = is_private(Path(folder).resolve())
    ...     os.chmod(folder, 0o777)
    ...     before, is_private(Path(folder).resolve())
    (True, False)
    """
    found = os.lstat(folder)
    if not stat.S_ISDIR(found.st_mode):
        return False
    if not hasattr(os, "getuid"):
        return True
    if found.st_uid != os.getuid() or found.st_mode & _OTHERS:
        return False
    return all(_is_safe_above(parent) for parent in folder.parents)


def _is_safe_above(parent: Path) -> bool:
    """Whether nobody else may rename what is in a folder; the sticky bit keeps them from it."""
    found = os.lstat(parent)
    if found.st_uid not in (_ROOT, os.getuid()):
        return False
    return bool(found.st_mode & stat.S_ISVTX) or not found.st_mode & _OTHERS_WRITE
