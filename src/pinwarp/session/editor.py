"""The editor: the one holder of the current session, its history and what is selected."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Unpack

from pinwarp.core.errors import PinwarpError
from pinwarp.core.frame_warp import BodyRules
from pinwarp.core.landmarks import Side
from pinwarp.session.history import NO_RULES, History
from pinwarp.session.rulers import Rulers, rulers_of
from pinwarp.session.session import Session
from pinwarp.session.signals import isolated
from pinwarp.session.view import Selection, ViewChanges, ViewState


@dataclass(frozen=True, eq=False)
class Work:
    """What was worked on, as it can be set aside and taken up again.

    Parameters
    ----------
    history
        All steps, and which of them a file holds.
    path, file_sha256
        As of the :class:`Editor`.
    """

    history: History
    path: Path | None = None
    file_sha256: str | None = None


class Editor:
    """Holds the truth; views render it and ask for changes.

    ``path`` is the file of the session and ``file_sha256`` its hash when it was read or written
    here; both are None where there is none.

    Signals are in the past tense: ``session_changed`` (also while previewing a drag),
    ``selection_changed``, ``view_changed`` and ``saved`` (the file or the unsaved mark changed).
    ``taken_up`` comes before the change to other work: what was kept of the one before is of no
    more use.
    ``rulers_changed`` comes before the change of session or view that lengths are shown otherwise
    for.

    Examples
    --------
    >>> from pinwarp.session import edits
    >>> editor = Editor()
    >>> editor.commit(edits.set_unit(editor.session, "m"), "Change unit")
    >>> editor.session.unit, editor.is_dirty
    ('m', True)
    >>> editor.undo()
    >>> editor.session.unit
    'mm'
    """

    session_changed = isolated(Session)
    selection_changed = isolated(Selection)
    view_changed = isolated(ViewState)
    saved = isolated()
    taken_up = isolated()
    rulers_changed = isolated(Rulers)

    def __init__(self, session: Session | None = None) -> None:
        self._history = History(session or Session())
        self._preview: Session | None = None
        self.selection = Selection()
        self.view = ViewState()
        self.rulers = rulers_of(self.session, self.view.lengths)
        self.path: Path | None = None
        self.file_sha256: str | None = None

    @property
    def session(self) -> Session:
        """What is shown: the preview of a drag under way, else the committed session."""
        return self._preview if self._preview is not None else self._history.session

    @property
    def committed(self) -> Session:
        """The session without a drag under way."""
        return self._history.session

    @property
    def rules(self) -> BodyRules:
        """What is chosen for the elements of the session's body, where it is of a model's."""
        return self._history.rules

    @property
    def work(self) -> Work:
        """All of it, to be taken up again after something else."""
        return Work(self._history, self.path, self.file_sha256)

    @property
    def is_previewing(self) -> bool:
        """Whether a drag is under way."""
        return self._preview is not None

    @property
    def is_dirty(self) -> bool:
        """Whether there is work that no file holds."""
        return self._history.is_dirty

    @property
    def undo_label(self) -> str | None:
        """What undo would take back."""
        return self._history.undo_label

    @property
    def redo_label(self) -> str | None:
        """What redo would do again."""
        return self._history.redo_label

    def preview(self, session: Session) -> None:
        """Show a session while something is dragged, without a step in the history."""
        self._preview = session
        self._measure()
        self.session_changed.emit(session)

    def cancel_preview(self) -> None:
        """Put back what was there before the drag."""
        if self._preview is not None:
            self._preview = None
            self._announce()

    def commit(
        self,
        session: Session,
        label: str,
        merge_key: str | None = None,
        rules: BodyRules | None = None,
    ) -> None:
        """Make a session the current one, as a step that can be undone."""
        self._preview = None
        self._history.commit(session, label, merge_key, rules)
        self._announce()

    def attempt(self, edit: Callable[[Session], Session], label: str) -> str:
        """Commit an edit as one undo step; return in words why it cannot be, else nothing."""
        try:
            session = edit(self.committed)
        except PinwarpError as error:
            return str(error)
        self.commit(session, label)
        return ""

    def undo(self) -> None:
        """Take the last step back."""
        self._preview = None
        self._history.undo()
        self._announce()

    def redo(self) -> None:
        """Do the next step again."""
        self._preview = None
        self._history.redo()
        self._announce()

    def replace_all(
        self,
        session: Session,
        path: Path | None,
        *,
        sha256: str | None = None,
        saved: bool = True,
        rules: BodyRules = NO_RULES,
    ) -> None:
        """Start over with another session: nothing before it can be undone.

        Parameters
        ----------
        session
            The session.
        path, sha256
            Its file, and the hash of that when it was read.
        saved
            False for a session that no file holds as it is.
        rules
            What is chosen for the elements of its body.
        """
        history = History(session, rules)
        history.mark_saved(saved=saved)
        self.take_up(Work(history, path, sha256))

    def take_up(self, work: Work) -> None:
        """Go on with what was set aside, its steps included; what is here is for others to keep."""
        self._history = work.history
        self._preview = None
        self.path, self.file_sha256 = work.path, work.file_sha256
        self.taken_up.emit()
        self._announce()
        self.saved.emit()

    def mark_saved(self, path: Path, sha256: str | None = None) -> None:
        """Remember where the session was saved, and the hash of the file."""
        self.path, self.file_sha256 = path, sha256
        self._history.mark_saved()
        self.saved.emit()

    def mark_unsaved(self) -> None:
        """Remember that no file holds the session: the one that did is gone."""
        self._history.mark_saved(saved=False)
        self.saved.emit()

    def select(self, *names: str, side: Side | None = None) -> None:
        """Select landmarks; without a side the previous one stays."""
        selection = Selection(names, side or self.selection.side)
        if selection != self.selection:
            self.selection = selection
            self.selection_changed.emit(selection)

    def look(self, **changes: Unpack[ViewChanges]) -> None:
        """Change how the session is looked at; keywords as in :class:`ViewState`."""
        view = replace(self.view, **changes)
        if view != self.view:
            self.view = view
            self._measure()
            self.view_changed.emit(view)

    def _measure(self) -> None:
        """Find out how lengths are shown, and say so where it is another way than before."""
        rulers = rulers_of(self.session, self.view.lengths)
        if rulers != self.rulers:
            self.rulers = rulers
            self.rulers_changed.emit(rulers)

    def _announce(self) -> None:
        self._measure()
        there = {landmark.name for landmark in self.session.landmarks}
        kept = tuple(name for name in self.selection.names if name in there)
        self.select(*kept)
        self.session_changed.emit(self.session)
