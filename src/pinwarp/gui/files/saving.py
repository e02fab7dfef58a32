"""Saving the session, and asking before unsaved work or another file would be lost."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from pinwarp.core.errors import words_of
from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.files.file_dialogs import Answer, FileDialogs, Overwrite
from pinwarp.gui.files.recent_files import RecentFiles
from pinwarp.gui.tasks.file_tasks import SESSION_FILES, FileTasks
from pinwarp.io.backup import write_keeping_previous
from pinwarp.io.file_names import SESSION_SUFFIX, is_session, session_name
from pinwarp.io.meshes import MeshFile
from pinwarp.io.osim.bone import is_mesh_there
from pinwarp.io.reading import hash_of
from pinwarp.io.session_file import write_session
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session, to_record


class Saving(Capability):
    """Writes the session where the user wants it.

    Parameters
    ----------
    editor
        What is saved.
    tasks
        Writes, asks and tells.
    recent
        Remembers sessions.
    rested
        Puts into a session where its semilandmarks rest.
    """

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks[FileDialogs],
        recent: RecentFiles,
        rested: Callable[[Session], Session],
    ) -> None:
        self._editor = editor
        self._rested = rested
        self._tasks = tasks
        self._recent = recent
        self._proposal_of: Callable[[], Path | None] = lambda: None
        self.actions = (
            Action(
                "save",
                "&Save Session",
                self.save,
                at="File.31 tools.14",
                keys="Ctrl+S",
                icon="save",
                tip="Save the session",
            ),
            Action("save_as", "Save Session &As…", self.save_as, at="File.32", keys="Ctrl+Shift+S"),
        )

    def may_close(self) -> bool:
        """Ask about unsaved changes before the window closes."""
        return self.may_lose_changes()

    def may_lose_changes(self) -> bool:
        """Ask about unsaved changes; False when the user would rather stay.

        What was saved counts as unsaved once its file is gone.
        """
        gone = self._notice_lost_file()
        if not self._editor.is_dirty:
            return True
        path = self._editor.path
        reason = f"{path.name} is not in {path.parent} any more." if gone and path else ""
        answer = self._tasks.dialogs.ask_unsaved(session_name(path), reason)
        if answer is Answer.SAVE:
            return self.save()
        return answer is Answer.DISCARD

    def may_replace(self, asked: Session) -> bool:
        """Ask again about what was done while the files of another session were read.

        Parameters
        ----------
        asked
            The session that was asked about before the reading, or that was not worth asking.
        """
        if self._editor.committed == asked or self.may_lose_changes():
            return True
        self._tasks.said.emit("Nothing was opened: this session stays")
        return False

    def save(self) -> bool:
        """Save where the session came from, or ask; say whether it was saved."""
        path, known = self._editor.path, self._editor.file_sha256
        if path is None:
            return self.save_as()
        if known is not None and hash_of(path) not in (known, None):
            return self._overwrite(
                path, "was changed by another program or window after it was opened here"
            )
        return self._save_to(path)

    def save_as(self) -> bool:
        """Ask where to save; say whether it was saved."""
        proposal = self._editor.path or self._proposal()
        asked = self._tasks.dialogs.ask_save("Save the session", SESSION_FILES, proposal)
        if asked is None:
            return False
        if is_session(asked):
            return self._save_to(asked)
        path = asked.with_name(asked.name.removesuffix(".csv") + SESSION_SUFFIX)
        # The file dialog has asked about another name.
        return self._overwrite(path, "is there already") if path.exists() else self._save_to(path)

    def name_untitled(self, proposal: Callable[[], Path | None]) -> None:
        """Ask first how a session that has no name yet may be called; None leaves it untitled."""
        self._proposal_of = proposal

    def _proposal(self) -> Path:
        return self._proposal_of() or self._tasks.folder() / f"untitled{SESSION_SUFFIX}"

    def _overwrite(self, path: Path, reason: str) -> bool:
        match self._tasks.dialogs.ask_overwrite(path.name, reason):
            case Overwrite.OVERWRITE:
                return self._save_to(path)
            case Overwrite.SAVE_AS:
                return self.save_as()
            case _:
                return False

    def _save_to(self, path: Path) -> bool:
        notes = self.write(self._editor.committed, path)
        if not notes:
            self._notice_lost_file()
            return False
        self._editor.mark_saved(path, hash_of(path))
        self._recent.add(path)
        gone = [file.path for file in self._meshes() if not is_mesh_there(file.path)]
        notes += [f"but its mesh {mesh.name} is not in {mesh.parent} any more" for mesh in gone]
        self._tasks.said.emit(", ".join(notes))
        return True

    def write(self, session: Session, path: Path) -> list[str]:
        """Write a session, and keep what was there before beside it.

        Returns
        -------
        list of str
            What is to be said of it; nothing where it was not written, which is told by then.
        """
        record = to_record(self._rested(session))
        unkept: list[OSError | None] = []

        def write() -> None:
            unkept.append(write_keeping_previous(path, lambda path: write_session(path, record)))

        if not self._tasks.write(write, path):
            return []
        notes = [f"Saved {path.name}"]
        if unkept[0] is not None:
            notes.append(f"but not its previous version: {words_of(unkept[0])}")
        return notes

    def _meshes(self) -> list[MeshFile]:
        """Return the meshes that were read, the source first."""
        files = map(self._editor.committed.mesh_file, Side)
        return [file for file in files if isinstance(file, MeshFile)]

    def _notice_lost_file(self) -> bool:
        """Say whether the session's file is gone; the session is unsaved work then."""
        path = self._editor.path
        if path is None or os.path.exists(path):
            return False
        self._editor.mark_unsaved()
        return True
