"""The journal: unsaved work is on the disk a moment after each change, in case the program dies.

Every window has a folder of its own::

    windows/4711-9f2c01ab/
        lock               held by the operating system's lock while the window lives
        window.json        which process that is, and which session it has open
        work.pinwarp.csv   its unsaved work; not there while everything is saved

Unsaved work that a window has set aside for other work is in one more folder of that kind.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import secrets
import shutil
import socket
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from pinwarp.io.atomic import write_atomically
from pinwarp.io.file_lock import FileLock
from pinwarp.io.work_file import UnsavedWork, write_work
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session, to_record

LOCK, WINDOW, WORK = "lock", "window.json", "work.pinwarp.csv"
PAUSE = 0.5
"""Seconds between two writes: changes meanwhile are written together."""
_RETRY = 5.0
"""Seconds until a write that failed is tried again."""
_TRIES = 20


@dataclass(frozen=True)
class _State:
    """What the disk should hold: no session where there is nothing unsaved."""

    session: Session | None
    path: Path | None
    sha256: str | None
    label: str | None
    edited: datetime
    opened: datetime
    guided: str | None


@dataclass(frozen=True)
class Aside:
    """Where unsaved work is kept that was set aside: a folder as of a window, and its lock."""

    folder: Path
    lock: FileLock


class Journal:
    """Keeps the unsaved work of one editor on the disk until it is closed.

    A thread of its own writes the latest committed session, at once where it has rested, and
    never more than :data:`PAUSE` and the time of two writes after the change.

    Parameters
    ----------
    editor
        Whose work is kept.
    windows
        The folder of all windows; made where it is missing.
    failed
        Told what kept the work from being written, in the journal's thread.

    Raises
    ------
    OSError
        When nothing can be written there.
    """

    def __init__(
        self, editor: Editor, windows: Path, *, failed: Callable[[Exception], None]
    ) -> None:
        self._editor = editor
        self._failed = failed
        self.folder, self._lock = _own_folder(windows)
        self._changed = threading.Condition()
        self._waiting: _State | None = None
        self._noted: _State | None = None
        self._told: dict[str, object] | None = None
        self._inherited: list[tuple[Path, FileLock]] = []
        self._aside: list[Aside] = []
        self._closing = threading.Event()
        # Before anything is drawn: whatever happens then, the work is kept.
        editor.session_changed.connect(self._note, priority=1)
        editor.saved.connect(self._note, priority=1)
        editor.view_changed.connect(self._note_guide)
        self._note()
        self._thread = threading.Thread(target=self._keep_writing, name="journal", daemon=True)
        self._thread.start()

    def inherit(self, folder: Path, lock: FileLock) -> None:
        """Remove the folder of a dead window once this journal holds the work that was in it.

        Parameters
        ----------
        folder, lock
            That folder and its lock; the editor has its work by now.
        """
        with self._changed:
            self._inherited.append((folder, lock))
            # Written once more, since the work may have been before the folder was handed over.
            self._waiting = self._waiting or self._noted
            self._changed.notify()

    def set_aside(self) -> Aside | None:
        """Keep the editor's unsaved work in a folder of its own: other work is about to come.

        It is there when this returns.

        Returns
        -------
        Aside or None
            Where it is; None where everything is saved.

        Raises
        ------
        OSError
            When it cannot be written.
        """
        state = self._state()
        if state.session is None:
            return None
        aside = Aside(*_own_folder(self.folder.parent))
        self._aside.append(aside)
        _write_into(aside.folder, state)
        return aside

    def take_up(self, aside: Aside) -> None:
        """Keep what was set aside with the window's own again: the editor has it by now."""
        self._aside.remove(aside)
        self.inherit(aside.folder, aside.lock)

    def forget(self, aside: Aside) -> None:
        """Remove what was set aside: it was saved, or discarded on purpose."""
        self._aside.remove(aside)
        remove_window(aside.folder, aside.lock)

    def close(self) -> None:
        """Forget the work: it was saved, or discarded on purpose."""
        self._editor.session_changed.disconnect(self._note)
        self._editor.saved.disconnect(self._note)
        self._editor.view_changed.disconnect(self._note_guide)
        with self._changed:
            self._closing.set()
            self._changed.notify()
        self._thread.join()
        aside = ((one.folder, one.lock) for one in self._aside)
        for folder, lock in (*self._inherited, *aside, (self.folder, self._lock)):
            remove_window(folder, lock)

    def _note(self, _changed: object = None) -> None:
        """Ask for the committed session to be written; a drag under way is not yet one."""
        if self._editor.is_previewing:
            return
        state, noted = self._state(), self._noted
        if noted is not None and noted.path == state.path:
            state = replace(state, opened=noted.opened)
            if noted.session is state.session:
                state = replace(state, edited=noted.edited)
                if state == noted:
                    return
        with self._changed:
            self._noted = self._waiting = state
            self._changed.notify()

    def _note_guide(self, _changed: object = None) -> None:
        """Keep what the guide asks for, which may change without the session."""
        if self._noted is None or self._noted.guided != self._editor.view.guided:
            self._note()

    def _state(self) -> _State:
        editor, now = self._editor, datetime.now().astimezone()
        session = editor.committed if editor.is_dirty else None
        path = editor.path.absolute() if editor.path is not None else None
        guided = editor.view.guided
        return _State(session, path, editor.file_sha256, editor.undo_label, now, now, guided)

    def _keep_writing(self) -> None:
        while (task := self._next()) is not None:
            state, inherited = task
            pause = PAUSE
            try:
                self._write(state)
                for folder, lock in inherited:
                    remove_window(folder, lock)
            except Exception as error:  # whatever it was, the next change may fare better
                pause = _RETRY
                with self._changed:
                    self._waiting = self._waiting or state
                    self._inherited += inherited
                self._failed(error)
            self._closing.wait(pause)

    def _next(self) -> tuple[_State, list[tuple[Path, FileLock]]] | None:
        """Wait for the next state to write, and what it replaces; None at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting is not None or self._closing.is_set())
            state, self._waiting = self._waiting, None
            if state is None or self._closing.is_set():
                return None
            # Taken together: an older state must not stand for what was inherited after it.
            inherited, self._inherited = self._inherited, []
            return state, inherited

    def _write(self, state: _State) -> None:
        # Somebody may have tidied up the folder of all windows.
        self.folder.mkdir(parents=True, exist_ok=True)
        self._told = _write_into(self.folder, state, self._told)


def _write_into(
    folder: Path, state: _State, told: dict[str, object] | None = None
) -> dict[str, object]:
    """Write a state, and what is told of its window where that is another than before."""
    about: dict[str, object] = {
        "process": os.getpid(),
        "host": socket.gethostname(),
        "session": str(state.path) if state.path is not None else None,
        "since": state.opened.isoformat(),
    }
    if about != told or not (folder / WINDOW).exists():
        write_atomically(folder / WINDOW, json.dumps(about))
    work = folder / WORK
    if state.session is None:
        work.unlink(missing_ok=True)
    else:
        record = to_record(state.session)
        unsaved = UnsavedWork(
            record, state.path, state.sha256, state.label, state.edited, state.guided
        )
        write_work(work, unsaved)
    return about


def remove_window(folder: Path, lock: FileLock) -> None:
    """Remove the folder of a window whose lock is held; what cannot be removed stays."""
    with contextlib.suppress(OSError):
        # The work first: what is left of the folder then is nothing to be restored.
        (folder / WORK).unlink(missing_ok=True)
    lock.release()
    shutil.rmtree(folder, ignore_errors=True)


def _own_folder(windows: Path) -> tuple[Path, FileLock]:
    """Make the folder of a new window and lock it."""
    windows.mkdir(parents=True, exist_ok=True)
    for _ in range(_TRIES):
        folder = windows / f"{os.getpid()}-{secrets.token_hex(4)}"
        folder.mkdir(mode=0o700)
        (folder / LOCK).touch()
        # Between the two, another pinwarp may take it for one left behind and remove it.
        with contextlib.suppress(FileNotFoundError):
            lock = FileLock.take(folder / LOCK)
            if lock is not None:
                if (folder / LOCK).exists():
                    return folder, lock
                lock.release()
    raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK), str(windows))
