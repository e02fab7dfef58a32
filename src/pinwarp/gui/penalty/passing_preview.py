"""A session shown for a moment: whatever the user does next ends it, and nothing is left of it."""

from __future__ import annotations

from qtpy.QtCore import QObject, Qt, Signal

from pinwarp.gui.tasks.passing import Passing
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session


class PassingPreview(QObject):
    """Previews sessions until it is ended, by its owner, by its key or by the user's next act.

    Parameters
    ----------
    editor
        Whose preview it is; one that somebody else began is left alone.
    parent
        The owner.
    held
        The key that keeps it up while it is held; with one, the window must stay active as well.
    """

    ended = Signal()

    def __init__(self, editor: Editor, parent: QObject, held: Qt.Key | None = None) -> None:
        super().__init__(parent)
        self._editor = editor
        self._session: Session | None = None
        self._passing = Passing(self, held)
        self._passing.ended.connect(self._on_ended)
        editor.session_changed.connect(self._on_session)

    def shut_down(self) -> None:
        """End it and let go of the editor."""
        self.end()
        self._editor.session_changed.disconnect(self._on_session)

    @property
    def session(self) -> Session | None:
        """What is shown for the moment, None where nothing is."""
        return self._session

    def show(self, session: Session) -> None:
        """Show a session, in place of the one shown before."""
        self._passing.begin()
        self._session = session
        self._editor.preview(session)

    def end(self) -> None:
        """Put back what is committed, unless something else has taken its place already."""
        self._passing.end()

    def _on_ended(self) -> None:
        shown, self._session = self._session, None
        if self._editor.session is shown:
            self._editor.cancel_preview()
        self.ended.emit()

    def _on_session(self, session: Session) -> None:
        if self._session is not None and session is not self._session:
            self.end()
