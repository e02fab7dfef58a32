"""Unsaved work outlives the program: the window's journal, and the offer after a crash."""

from __future__ import annotations

import socket
from collections.abc import Sequence
from pathlib import Path

from qtpy.QtCore import QObject, Qt, Signal

from pinwarp.core.errors import words_of
from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.files.file_dialogs import FileDialogs
from pinwarp.gui.files.lost_work_dialog import LostAnswer, moment_in_words
from pinwarp.gui.files.saving import Saving
from pinwarp.gui.files.session_meshes import SessionMeshes
from pinwarp.gui.tasks.file_tasks import FileTasks
from pinwarp.session.editor import Editor
from pinwarp.session.keeping.journal import Aside, Journal
from pinwarp.session.keeping.recovery import LostWork, OtherWindow, find_lost_work, window_with
from pinwarp.session.session import Session


class Recovery(QObject, Capability):
    """Keeps the work of one window safe and restores what others have lost.

    Parameters
    ----------
    editor
        Whose work is kept.
    tasks
        Runs, asks and tells.
    saving
        Asks about this window's work before other work takes its place.
    meshes
        Reads the meshes of restored sessions.
    state_folder
        Where work is kept; None keeps and restores nothing.
    """

    _not_kept = Signal(str)

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks[FileDialogs],
        saving: Saving,
        meshes: SessionMeshes,
        state_folder: Path | None,
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._editor = editor
        self._tasks = tasks
        self._saving = saving
        self._meshes = meshes
        self._windows = state_folder / "windows" if state_folder is not None else None
        self._has_told = False
        self.actions = (
            Action(
                "restore",
                "Restore &Unsaved Work…",
                self.offer_again,
                at="File.23",
                tip="Of windows that ended unexpectedly",
            ),
        )
        self._journal: Journal | None = None
        # The journal speaks from its own thread, or before the window is there.
        self._not_kept.connect(self._tell_once, Qt.ConnectionType.QueuedConnection)
        if self._windows is not None:
            try:
                self._journal = Journal(editor, self._windows, failed=self._on_failure)
            except OSError as error:
                self._on_failure(error)

    def offer(self, instead_of: Sequence[Path] = ()) -> bool:
        """Offer what windows have lost that did not close properly.

        Parameters
        ----------
        instead_of
            Files that are not opened when something is restored.

        Returns
        -------
        bool
            Whether something is restored.
        """
        while self._windows is not None and (found := find_lost_work(self._windows)):
            answer, chosen = self._tasks.dialogs.ask_lost_work(found)
            if answer is LostAnswer.LATER:
                return False
            if answer is LostAnswer.RESTORE:
                self._restore(chosen, instead_of)
                return True
            chosen.discard()
        return False

    def offer_again(self) -> None:
        """Offer it because the user asked, and say so when there is nothing."""
        if self._windows is None or not find_lost_work(self._windows):
            self._tasks.dialogs.tell(
                "Nothing to restore",
                "There is no unsaved work of a window that ended unexpectedly.",
            )
        elif self._saving.may_lose_changes():
            self.offer()

    def window_with(self, path: Path) -> OtherWindow | None:
        """Return another living window that has a session open."""
        if self._windows is None or self._journal is None:
            return None
        return window_with(self._windows, path, self._journal.folder)

    def set_aside(self) -> Aside | None:
        """Keep the editor's unsaved work apart, before other work takes its place."""
        if self._journal is None:
            return None
        try:
            return self._journal.set_aside()
        except OSError as error:
            self._on_failure(error)
            return None

    def take_up(self, aside: Aside | None) -> None:
        """Keep with the window's own again what was set aside: the editor has it by now."""
        if self._journal is not None and aside is not None:
            self._journal.take_up(aside)

    def forget(self, aside: Aside | None) -> None:
        """Remove what was set aside: it was saved, or discarded on purpose."""
        if self._journal is not None and aside is not None:
            self._journal.forget(aside)

    def shut_down(self) -> None:
        """Forget the work of this window: it was saved, or discarded on purpose."""
        if self._journal is not None:
            self._journal.close()

    def _restore(self, lost: LostWork, instead_of: Sequence[Path]) -> None:
        work, before = lost.work, self._editor.committed

        def arrived(session: Session) -> bool:
            if not self._saving.may_replace(before):
                return False
            lock = lost.claim()
            if lock is None:
                self._tasks.dialogs.tell(
                    "Restored elsewhere", f"Another window has taken {lost.name} meanwhile."
                )
                return False
            self._editor.replace_all(session, work.path, sha256=work.sha256, saved=False)
            # Whatever this window was asking for before: the guide goes on where it was, or is off.
            is_there = work.guided is not None and session.index_of(work.guided) is not None
            self._editor.look(guided=work.guided if is_there else None)
            if self._journal is not None:
                self._journal.inherit(lost.folder, lock)
            else:
                # Nothing keeps the work here: it stays where it is until a window can.
                lock.release()
            left_out = [path.name for path in instead_of if path.absolute() != work.path]
            self._tasks.said.emit(
                f"Restored {lost.name}: {counted(lost.pairs, 'pair')}, not saved yet"
                + (f"; not opened: {', '.join(left_out)}" if left_out else "")
            )
            return True

        folder = work.path.parent if work.path is not None else None
        self._meshes.open(work.record, folder, f"Restoring {lost.name}", arrived)

    def _on_failure(self, error: Exception) -> None:
        self._not_kept.emit(words_of(error))

    def _tell_once(self, reason: str) -> None:
        if self._has_told:
            return
        self._has_told = True
        self._tasks.dialogs.tell_error(
            "Unsaved work is not being kept",
            f"{reason}\nShould pinwarp end unexpectedly, what is not saved is lost: save often.",
        )


def where_open(other: OtherWindow) -> str:
    """Return in words where a session is open, and since when."""
    here = other.host == socket.gethostname()
    place = f"process {other.process}" + ("" if here else f" on {other.host}")
    unsaved = ", with unsaved changes" if other.has_unsaved_work else ""
    return f"in another window since {moment_in_words(other.since)} ({place}){unsaved}"
