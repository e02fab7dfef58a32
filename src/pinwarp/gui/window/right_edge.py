"""The panels at the right edge: as wide as somebody wants them, and as their tabs' names are."""

from __future__ import annotations

from collections.abc import Sequence

from qtpy.QtCore import QEvent, QObject, Qt
from qtpy.QtWidgets import QApplication, QDockWidget, QMainWindow, QStyle, QTabBar, QWidget

_DIRECT = Qt.FindChildOption.FindDirectChildrenOnly
_CORNER = Qt.Corner.BottomRightCorner


class RightEdge(QObject):
    """Keeps panels from being squeezed with their window, and makes them as wide as before.

    A window that shrinks leaves them the width of their tabs, unless somebody made them narrower;
    then the tabs are scrolled. Qt would leave them squeezed, and shorten the names.

    Parameters
    ----------
    window
        Whose right edge it is.
    docks
        Those that stand there behind one another.
    below
        What stands at the lower edge: under the views alone, or where the window is too narrow for
        that, under the right edge too.
    """

    def __init__(
        self, window: QMainWindow, docks: Sequence[QDockWidget], below: Sequence[QWidget]
    ) -> None:
        super().__init__(window)
        self._window = window
        self._docks = docks
        self._below = below
        # None until the window has become too small: then what it was before.
        self._wanted: int | None = None
        self._width = 0
        self._window_width = window.width()
        for watched in (window, *docks):
            watched.installEventFilter(self)

    @property
    def least(self) -> int:
        """How wide the names of all panels are in their tabs, those counted that are not open."""
        beside = self._window.style().pixelMetric(QStyle.PixelMetric.PM_TabBarTabHSpace)
        words = self._window.fontMetrics()
        # A tab in front has a pixel on either side for its frame.
        return sum(words.horizontalAdvance(x.windowTitle()) + beside + 2 for x in self._docks)

    def _give_corner(self) -> None:
        """Let panels have the whole height, unless the lower edge needs the width of both."""
        widest = max((panel.minimumSizeHint().width() for panel in self._below), default=0)
        fits = widest + self.least <= self._window.width()
        area = Qt.DockWidgetArea.RightDockWidgetArea
        owner = area if fits else Qt.DockWidgetArea.BottomDockWidgetArea
        if self._window.corner(_CORNER) != owner:
            self._window.setCorner(_CORNER, owner)

    def want(self, width: int | None) -> None:
        """Make the edge so wide, now and whenever there is room; None leaves it as it is."""
        self._wanted = width
        self._give_corner()
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
        for bar in self._window.findChildren(QTabBar, options=_DIRECT):
            # Names that have no room are scrolled.
            bar.setElideMode(Qt.TextElideMode.ElideNone)
        if QApplication.mouseButtons() & Qt.MouseButton.LeftButton:
            # Somebody drags the border.
            self._wanted = self._width

    def _on_window(self) -> None:
        before, self._window_width = self._window_width, self._window.width()
        if self._window_width < before and self._wanted is None and self._width:
            self._wanted = self._width
        self._give_corner()
        if self._wanted is not None:
            grows = self._window_width > before
            self._give(self._wanted if grows else min(self._wanted, self.least))
