"""Hands levels from the worker to the window, no faster than they can be seen."""

from __future__ import annotations

import threading

from qtpy.QtCore import QObject, QTimer, Signal

from pinwarp.core.refinement import Level

# So long a level stands at least (ms), and so long the worker waits for a window that is busy (s).
SHOWN_MS = 60
PATIENCE = 0.5


class LevelRelay(QObject):
    """``reached`` emits each level in the UI thread; the next one waits until it was seen."""

    reached = Signal(object)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._seen = threading.Event()
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(SHOWN_MS)
        self._timer.timeout.connect(self._seen.set)

    def tell(self, level: Level) -> None:
        """Tell of a level, and wait until it was seen; for the worker."""
        self._seen.clear()
        self.reached.emit(level)
        self._seen.wait(PATIENCE)

    def drawn(self) -> None:
        """Say that the level is on the screen, or will be in a moment."""
        self._timer.start()

    def let_go(self) -> None:
        """Let the worker go on at once."""
        self._seen.set()
