"""What all tools of the viewports have in common."""

from __future__ import annotations

from collections.abc import Mapping

from qtpy.QtCore import QEvent, QObject, QPointF, Qt, Signal
from qtpy.QtGui import QKeySequence
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.views.viewport import Viewport

ENDING = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
_PLAIN = (Qt.KeyboardModifier.NoModifier, Qt.KeyboardModifier.KeypadModifier)


def named(key: Qt.Key) -> str:
    """Return what a key is called."""
    return str(QKeySequence(key).toString(QKeySequence.SequenceFormat.NativeText))


class ViewTool(QObject):
    """Takes clicks in both viewports and a few keys of the window, from its start to its end.

    Parameters
    ----------
    viewports
        Where the mouse is.
    window
        Whose keys it takes: what is typed into a field is that field's.
    """

    said = Signal(str)
    # It started or ended, or asks for something else now.
    changed = Signal()

    def __init__(self, viewports: Mapping[Side, Viewport], window: QWidget) -> None:
        super().__init__(window)
        self._viewports = viewports
        self._window = window
        self.is_active = False

    @property
    def words(self) -> str:
        """What it asks for now, in few words."""
        return ""

    @property
    def hint(self) -> str:
        """What can be done now."""
        return ""

    def start(self) -> None:
        """Take clicks and keys."""
        if self.is_active:
            return
        self.is_active = True
        for view in self._viewports.values():
            view.tool = self
        self._viewports[Side.SOURCE].setFocus(Qt.FocusReason.OtherFocusReason)
        self._window.installEventFilter(self)
        self.changed.emit()

    def stop(self) -> None:
        """Leave."""
        if not self.is_active:
            return
        self.is_active = False
        self._window.removeEventFilter(self)
        for view in self._viewports.values():
            if view.tool is self:
                view.tool = None
        self.changed.emit()

    def click(self, view: Canvas, at: QPointF, twice: bool) -> None:
        """Take a click."""

    def hover(self, view: Canvas, at: QPointF | None) -> None:
        """Notice where the mouse is."""

    def end(self) -> None:
        """Do what the key that ends it asks for."""

    def take_back(self) -> None:
        """Take back the last click."""

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        """Take the keys that end it, take back and leave, before the shortcuts do."""
        kind = event.type()
        if kind not in (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress):
            return False
        does = {
            **dict.fromkeys(ENDING, self.end),
            Qt.Key.Key_Backspace: self.take_back,
            Qt.Key.Key_Escape: self.stop,
        }.get(event.key())
        if does is None or event.modifiers() not in _PLAIN:
            return False
        event.accept()
        if kind == QEvent.Type.KeyPress:
            does()
        return True
