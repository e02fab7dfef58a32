"""What slow jobs look like: a bar in the status bar, and a button that cancels."""

from __future__ import annotations

import time
from collections.abc import Sequence

from qtpy.QtCore import QObject, QTimer
from qtpy.QtWidgets import QProgressBar, QPushButton, QStatusBar

from pinwarp.gui.tasks.jobs import SlowJob
from pinwarp.gui.tasks.stepped_job import SteppedJob

# Seconds between two steps of the bar.
PAUSE = 0.1
# What is done sooner shows no bar: it would only flash, and each of its steps draws the whole
# window anew where there is no graphics card.
SHOWN_AFTER_MS = 200


class JobProgress(QObject):
    """Shows the bar and the button while any job runs.

    Parameters
    ----------
    place
        Where they stand.
    jobs
        What is watched.
    """

    def __init__(self, place: QStatusBar, jobs: Sequence[SlowJob | SteppedJob]) -> None:
        super().__init__(place)
        self._jobs = jobs
        self._shown_at = 0.0
        self.bar = QProgressBar()
        self.bar.setRange(0, 100)
        self.bar.setFixedWidth(220)
        self.bar.hide()
        self.cancel = QPushButton("Cancel")
        self.cancel.setFlat(True)
        self.cancel.hide()
        self._delay = QTimer(self)
        self._delay.setSingleShot(True)
        self._delay.setInterval(SHOWN_AFTER_MS)
        self._delay.timeout.connect(self._show)
        place.addPermanentWidget(self.bar)
        place.addPermanentWidget(self.cancel)
        for job in jobs:
            job.started.connect(self._on_started)
            job.progressed.connect(self._on_progressed)
            job.ended.connect(self._on_ended)
            self.cancel.clicked.connect(job.cancel)

    @property
    def is_idle(self) -> bool:
        """Whether no job runs."""
        return all(job.is_idle for job in self._jobs)

    def _on_started(self, title: str) -> None:
        self.bar.setFormat(title)
        self.bar.setValue(0)
        if not self.bar.isVisible() and not self._delay.isActive():
            self._delay.start()

    def _show(self) -> None:
        self.bar.show()
        self.cancel.show()

    def _on_progressed(self, share: float, stage: str) -> None:
        self.bar.setFormat(f"{stage} – %p%")
        # A bar paints itself, and what lies behind it, at once: nobody reads faster than this.
        if time.monotonic() - self._shown_at > PAUSE:
            self._shown_at = time.monotonic()
            self.bar.setValue(round(100 * share))

    def _on_ended(self) -> None:
        if self.is_idle:
            self._delay.stop()
            self.bar.hide()
            self.cancel.hide()
