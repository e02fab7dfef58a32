"""A session shown for a moment: whatever the user does next ends it, and nothing is left of it."""

from __future__ import annotations

from qtpy.QtCore import QEvent, QObject, Qt, Signal
from qtpy.QtWidgets import QApplication

from pinwarp.session.editor import Editor
from pinwarp.session.session import Session

_ACTS = {QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick}
_KEYS = {QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress}
_LEAVES = {QEvent.Type.WindowDeactivate, QEvent.Type.ApplicationDeactivate}


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
        self._held = held
        self._session: Session | None = None
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
        if self._session is None:
            # Only now: Python looking at every event has its price.
            QApplication.instance().installEventFilter(self)
        self._session = session
        self._editor.preview(session)

    def end(self) -> None:
        """Put back what is committed, unless something else has taken its place already."""
        if self._session is None:
            return
        shown, self._session = self._session, None
        QApplication.instance().removeEventFilter(self)
        if self._editor.session is shown:
            self._editor.cancel_preview()
        self.ended.emit()

    def _on_session(self, session: Session) -> None:
        if self._session is not None and session is not self._session:
            self.end()

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """End it before what the user does is done; the held key is kept from everyone else."""
        kind = event.type()
        if kind in _KEYS or kind == QEvent.Type.KeyRelease:
            if event.key() == self._held:
                if kind == QEvent.Type.KeyRelease and not event.isAutoRepeat():
                    self.end()
                return True
            if kind in _KEYS:
                self.end()
        elif kind in _ACTS or (self._held is not None and kind in _LEAVES):
            self.end()
        return False
