"""What other windows have left or are doing: unsaved work of dead ones, sessions of living ones."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import pairs_of
from pinwarp.io.file_lock import FileLock
from pinwarp.io.file_names import session_name
from pinwarp.io.reading import hash_of
from pinwarp.io.text import read_text
from pinwarp.io.work_file import UnsavedWork, read_work
from pinwarp.session.keeping.journal import LOCK, WINDOW, WORK, remove_window

LARGEST_NOTE = 1 << 20
"""More bytes than what a window says of itself."""


@dataclass(frozen=True)
class LostWork:
    """The unsaved work of a window that did not close properly.

    Parameters
    ----------
    folder
        The folder of that window.
    work
        What it held.
    """

    folder: Path
    work: UnsavedWork

    @property
    def name(self) -> str:
        """What its session was called."""
        return session_name(self.work.path)

    @property
    def pairs(self) -> int:
        """How many pairs it has."""
        return len(pairs_of(self.work.record.landmarks))

    @property
    def file_has_changed(self) -> bool:
        """Whether the session's file is another now than the one the work began with."""
        path = self.work.path
        return path is not None and os.path.exists(path) and hash_of(path) != self.work.sha256

    def claim(self) -> FileLock | None:
        """Take the work for this process; None when another one was faster."""
        return _lock(self.folder)

    def discard(self) -> None:
        """Remove the work for good, unless another process has claimed it meanwhile."""
        lock = self.claim()
        if lock is not None:
            remove_window(self.folder, lock)


@dataclass(frozen=True)
class OtherWindow:
    """A living window that has a session open.

    Parameters
    ----------
    process, host
        Its process, and the computer that runs it.
    since
        When it opened the session.
    has_unsaved_work
        Whether it holds more than the file.
    """

    process: int
    host: str
    since: datetime
    has_unsaved_work: bool


def find_lost_work(windows: Path) -> list[LostWork]:
    """Return the unsaved work of windows that died, the latest first.

    Folders of dead windows without any are removed. Work that cannot be read, such as that of a
    newer pinwarp, stays where it is.

    Parameters
    ----------
    windows
        The folder of all windows; it may be missing.
    """
    found = []
    for folder in _folders(windows):
        lock = _lock(folder)
        if lock is None:
            continue
        if not (folder / WORK).exists():
            remove_window(folder, lock)
            continue
        try:
            found.append(LostWork(folder, read_work(folder / WORK)))
        except PinwarpError:
            continue
        finally:
            lock.release()
    return sorted(found, key=lambda lost: lost.work.edited, reverse=True)


def window_with(windows: Path, path: Path, own: Path) -> OtherWindow | None:
    """Return a living window that has a session open.

    Parameters
    ----------
    windows
        The folder of all windows; it may be missing.
    path
        The file of the session.
    own
        The folder of the window that asks.
    """
    for folder in _folders(windows):
        if folder == own:
            continue
        lock = _lock(folder)
        if lock is not None:
            lock.release()
            continue
        try:
            about = json.loads(read_text(folder / WINDOW, "window", LARGEST_NOTE))
            if about["session"] is not None and _is_same_file(Path(about["session"]), path):
                return OtherWindow(
                    process=int(about["process"]),
                    host=str(about["host"]),
                    since=datetime.fromisoformat(about["since"]),
                    has_unsaved_work=(folder / WORK).exists(),
                )
        except (OSError, KeyError, TypeError, ValueError, RecursionError):
            # It has only just begun or ended.
            continue
    return None


def _folders(windows: Path) -> Iterator[Path]:
    try:
        yield from sorted(path for path in windows.iterdir() if path.is_dir())
    except OSError:
        return


def _lock(folder: Path) -> FileLock | None:
    """Lock the folder of a window; None where it lives or is no such folder."""
    try:
        return FileLock.take(folder / LOCK)
    except OSError:
        return None


def _is_same_file(one: Path, other: Path) -> bool:
    try:
        return os.path.samefile(one, other)
    except OSError:
        return False
