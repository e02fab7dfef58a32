"""Says that a map is being made and how far it is, and stops it."""

from __future__ import annotations

from qtpy.QtCore import QEvent, QObject, Qt, QTimer, Signal
from qtpy.QtWidgets import QHBoxLayout, QProgressBar, QPushButton, QWidget

# What is done sooner shows no bar: it would only flash. Between two steps of the bar.
SHOWN_AFTER_MS = 300
STEP_MS = 150
_KEYS = (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress)


class MapWork(QWidget):
    """A bar and a button while a map is made that takes long; Esc is the button's key.

    ``changed`` emits at every step, ``stop_requested`` when it is to end.
    """

    changed = Signal()
    stop_requested = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._title = ""
        self._share = 0.0
        self.bar = QProgressBar()
        self.bar.setRange(0, 100)
        self.bar.setFormat("Working – %p%")
        self.stop = QPushButton("Stop")
        self.stop.setToolTip("Show no map instead (Esc)")
        self.stop.clicked.connect(self.stop_requested)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.bar, 1)
        row.addWidget(self.stop)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._step)
        self.hide()

    @property
    def words(self) -> str:
        """What the view says of it; nothing while there is nothing to be waited for."""
        return "" if self.isHidden() else f"{self._title}: {self.bar.value()} % – Esc stops it"

    def show_work(self, title: str) -> None:
        """Say that something is being made, or with an empty title that nothing is."""
        if title == self._title:
            return
        self._title, self._share = title, 0.0
        if title:
            self.bar.setValue(0)
            self._timer.start(SHOWN_AFTER_MS)
            return
        self._timer.stop()
        if not self.isHidden():
            self.hide()
            self.changed.emit()

    def show_share(self, share: float) -> None:
        """Note how much of it is done; shown at the next step."""
        self._share = share

    def _step(self) -> None:
        self._timer.setInterval(STEP_MS)
        self.bar.setValue(round(100 * self._share))
        self.show()
        self.changed.emit()

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        """Stop by Esc, before it deselects."""
        if self.isHidden() or event.type() not in _KEYS:
            return False
        if event.key() != Qt.Key.Key_Escape or event.modifiers():
            return False
        event.accept()
        if event.type() == QEvent.Type.KeyPress:
            self.stop_requested.emit()
        return True
