"""Something shown for a moment: its key, or whatever the user does next, ends it."""

from __future__ import annotations

from qtpy.QtCore import QEvent, QObject, Qt, Signal
from qtpy.QtWidgets import QApplication

_ACTS = {QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick}
_KEYS = {QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress}
_LEAVES = {QEvent.Type.WindowDeactivate, QEvent.Type.ApplicationDeactivate}


class Passing(QObject):
    """Lasts from :meth:`begin` until its owner, its key or the user's next act ends it.

    Parameters
    ----------
    parent
        The owner.
    held
        The key that keeps it up while it is held; with one, the window must stay active as well.
    """

    ended = Signal()

    def __init__(self, parent: QObject, held: Qt.Key | None = None) -> None:
        super().__init__(parent)
        self._held = held
        self._is_up = False

    @property
    def is_up(self) -> bool:
        """Whether it lasts."""
        return self._is_up

    def begin(self) -> None:
        """Begin, or go on."""
        if not self._is_up:
            # Only now: Python looking at every event has its price.
            QApplication.instance().installEventFilter(self)
        self._is_up = True

    def end(self) -> None:
        """End, and say so."""
        if self._is_up:
            self._is_up = False
            QApplication.instance().removeEventFilter(self)
            self.ended.emit()

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
