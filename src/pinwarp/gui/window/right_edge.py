"""The panels at the right edge: as wide as they were before the window was too small for that."""

from __future__ import annotations

from collections.abc import Sequence

from qtpy.QtCore import QEvent, QObject, Qt
from qtpy.QtWidgets import QApplication, QDockWidget, QMainWindow


class RightEdge(QObject):
    """Gives panels their width back when a window grows again: Qt leaves them squeezed.

    Parameters
    ----------
    window
        Whose right edge it is.
    docks
        Those that stand there behind one another.
    """

    def __init__(self, window: QMainWindow, docks: Sequence[QDockWidget]) -> None:
        super().__init__(window)
        self._window = window
        self._docks = docks
        # None until the window has become too small: then what it was before.
        self._wanted: int | None = None
        self._width = 0
        self._window_width = window.width()
        for watched in (window, *docks):
            watched.installEventFilter(self)

    def want(self, width: int | None) -> None:
        """Make the edge so wide, now and whenever there is room; None leaves it as it is."""
        self._wanted = width
        if width is not None:
            self._give(width)

    def _give(self, width: int) -> None:
        docked = [dock for dock in self._docks if not dock.isFloating()]
        if docked:
            self._window.resizeDocks(docked[:1], [width], Qt.Orientation.Horizontal)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Hear how wide panels and window have become: of both, the panels are told first."""
        if event.type() != QEvent.Type.Resize:
            return False
        if watched is self._window:
            self._on_window()
        elif isinstance(watched, QDockWidget) and not watched.isFloating():
            self._on_dock(watched)
        return False

    def _on_dock(self, dock: QDockWidget) -> None:
        if self._window.width() != self._window_width:
            # The window makes it so wide, and is heard of next.
            return
        self._width = dock.width()
        if QApplication.mouseButtons() & Qt.MouseButton.LeftButton:
            # Somebody drags the border.
            self._wanted = self._width

    def _on_window(self) -> None:
        before, self._window_width = self._window_width, self._window.width()
        if self._window_width < before and self._wanted is None and self._width:
            self._wanted = self._width
        if self._window_width > before and self._wanted is not None:
            self._give(self._wanted)
