"""Hands levels from the worker to the window, no faster than they can be seen."""

from __future__ import annotations

import threading

from qtpy.QtCore import QObject, QTimer, Signal

from pinwarp.core.refinement import Level
from pinwarp.gui.tasks.jobs import SlowJob

# So long a level stands at least (ms), and so long the worker waits for a window that is busy (s).
SHOWN_MS = 60
PATIENCE = 10.0
_LOOK = 0.05


class LevelRelay(QObject):
    """``reached`` emits each level in the UI thread; the next one waits until it was seen.

    Parameters
    ----------
    jobs
        The worker: once it is cancelled nothing waits.
    parent
        The owner.
    """

    reached = Signal(object)

    def __init__(self, jobs: SlowJob, parent: QObject) -> None:
        super().__init__(parent)
        self._jobs = jobs
        self._seen = threading.Event()
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(SHOWN_MS)
        self._timer.timeout.connect(self._seen.set)

    def tell(self, level: Level) -> None:
        """Tell of a level, and wait until it was seen; for the worker."""
        self._seen.clear()
        self.reached.emit(level)
        for _ in range(round(PATIENCE / _LOOK)):
            if self._seen.wait(_LOOK) or self._jobs.is_cancelled:
                return

    def drawn(self) -> None:
        """Say that the level is on the screen, or will be in a moment."""
        self._timer.start()
