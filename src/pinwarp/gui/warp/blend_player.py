"""Plays the blend from the aligned source to the warp and back: a preview that leaves no trace."""

from __future__ import annotations

from qtpy.QtCore import QEvent, QObject, Qt, QTimer, Signal
from qtpy.QtWidgets import QApplication

from pinwarp.session import edits
from pinwarp.session.editor import Editor

FRAME_MS = 33
# Frames from one end to the other.
FRAMES = 45


class BlendPlayer(QObject):
    """Previews one blend after the other; Esc or any click stops it, and does nothing else.

    Parameters
    ----------
    editor
        Where it is previewed.
    parent
        The window.
    """

    playing_changed = Signal(bool)

    def __init__(self, editor: Editor, parent: QObject) -> None:
        super().__init__(parent)
        self._editor = editor
        self._frame = 0
        self._timer = QTimer(self)
        self._timer.setInterval(FRAME_MS)
        self._timer.timeout.connect(self._show_next)
        editor.session_changed.connect(self._on_session)

    @property
    def is_playing(self) -> bool:
        """Whether it is being played."""
        return self._timer.isActive()

    def shut_down(self) -> None:
        """Stop, and let go of the editor."""
        self.stop()
        self._editor.session_changed.disconnect(self._on_session)

    def play(self) -> None:
        """Play once, from the beginning."""
        self._frame = 0
        self._timer.start()
        QApplication.instance().installEventFilter(self)
        self.playing_changed.emit(True)
        self._show_next()

    def stop(self) -> None:
        """Put back what was there before."""
        if not self.is_playing:
            return
        self._timer.stop()
        QApplication.instance().removeEventFilter(self)
        self._editor.cancel_preview()
        self.playing_changed.emit(False)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Take the click or the key that stops it."""
        kind = event.type()
        escape = (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress)
        if kind in escape and event.key() == Qt.Key.Key_Escape:
            event.accept()
            if kind == QEvent.Type.KeyPress:
                self.stop()
            return True
        if kind == QEvent.Type.MouseButtonPress:
            self.stop()
            return True
        if kind == QEvent.Type.WindowBlocked:
            # A dialog: the first click on it is for the dialog.
            self.stop()
        return False

    def _show_next(self) -> None:
        if self._frame > 2 * FRAMES:
            self.stop()
            return
        away = abs(self._frame - FRAMES) / FRAMES
        self._frame += 1
        self._editor.preview(edits.set_blend(self._editor.committed, 1 - away))

    def _on_session(self, _session: object) -> None:
        if not self._editor.is_previewing:
            # Something was done meanwhile, by a key or a menu: that is what one wants to see.
            self.stop()
