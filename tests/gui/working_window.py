"""A window that works until it is killed; run by test_kill.py in a process of its own.

    python -m tests.gui.working_window SESSION STATE_FOLDER

Every committed session is told on the standard output: when, and a digest of it.
"""

from __future__ import annotations

import hashlib
import os
import sys
import time
from pathlib import Path

import numpy as np
from qtpy.QtCore import QPointF, Qt, QTimer
from qtpy.QtTest import QTest

from pinwarp.core.landmarks import Side
from pinwarp.gui.app import begin, make_application, no_settings
from pinwarp.gui.files.documents import Opening
from pinwarp.gui.window.main_window import MainWindow
from pinwarp.io.session_file import SessionRecord
from pinwarp.session import edits
from pinwarp.session.session import to_record

EVERY_MS = 70


def digest_of(record: SessionRecord) -> str:
    """Tell one session from another, also across processes."""
    return hashlib.sha256(repr(record).encode()).hexdigest()


class Worker:
    """Clicks, drags, types, undoes and redoes, one after the other."""

    def __init__(self, window: MainWindow) -> None:
        self._window = window
        self._rng = np.random.default_rng()
        self._things = [self._click, self._move, self._move, self._undo, self._redo, self._penalty]
        self._last = None
        window.editor.session_changed.connect(self._tell)

    def _tell(self, _session: object) -> None:
        committed = self._window.editor.committed
        if committed is not self._last:
            self._last = committed
            line = f"{time.monotonic()} {digest_of(to_record(committed))}\n"
            os.write(1, line.encode())

    def work(self) -> None:
        """Do one of them, once the session is there."""
        if self._window.jobs.is_idle and self._window.editor.session.landmarks:
            self._rng.choice(self._things)()

    def _click(self) -> None:
        viewport = self._window.viewports[Side.SOURCE]
        for _ in range(50):
            x, y = self._rng.uniform(0.1, 0.9, 2) * (viewport.width(), viewport.height())
            if viewport.pick(QPointF(x, y)) is not None:
                QTest.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=QPointF(x, y).toPoint())
                return

    def _move(self) -> None:
        editor = self._window.editor
        landmark = self._rng.choice(editor.committed.pairs)
        place = tuple(np.add(landmark.destination, self._rng.normal(size=3)).tolist())
        moved = edits.move(editor.committed, landmark.name, Side.DESTINATION, place)
        # A drag under way, then its end.
        editor.preview(moved)
        editor.commit(moved, f"Move {landmark.name}")

    def _penalty(self) -> None:
        editor = self._window.editor
        penalty = float(self._rng.uniform(0, 10))
        editor.commit(edits.set_penalty(editor.committed, penalty), "Change penalty", "penalty")

    def _undo(self) -> None:
        self._press(Qt.KeyboardModifier.ControlModifier)

    def _redo(self) -> None:
        self._press(Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)

    def _press(self, modifiers: Qt.KeyboardModifier) -> None:
        QTest.keyClick(self._window, Qt.Key.Key_Z, modifiers)


def main(session: Path, state_folder: Path) -> None:
    """Open the window on a session and work on it for ever."""
    application = make_application()
    settings = no_settings()
    window = MainWindow(settings, state_folder=state_folder)
    window.resize(1000, 640)
    window.show()
    begin(window, Opening(session=session))
    worker = Worker(window)
    timer = QTimer(window)
    timer.timeout.connect(worker.work)
    timer.start(EVERY_MS)
    application.exec()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
