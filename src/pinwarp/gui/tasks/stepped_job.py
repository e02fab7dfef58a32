"""Slow work that must happen on the UI thread, such as rendering: in small steps."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

from qtpy.QtCore import QObject, QTimer, Signal

from pinwarp.core.errors import Cancelled, PinwarpError

Steps = Generator[tuple[float, str], None, Any]


@dataclass
class _Running:
    steps: Steps
    done: Callable[[Any], None]
    failed: Callable[[Exception], None]


class SteppedJob(QObject):
    """Runs a generator step by step between the events of the window; one at a time.

    A generator yields the share that is done and the stage, and returns the result. When it is
    cancelled it is closed where it stands: what it holds it lets go of in ``finally``.
    """

    started = Signal(str)
    progressed = Signal(float, str)
    ended = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._running: _Running | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(0)
        self._timer.timeout.connect(self._step)

    @property
    def is_idle(self) -> bool:
        """Whether nothing runs."""
        return self._running is None

    def run(
        self,
        title: str,
        steps: Steps,
        done: Callable[[Any], None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Start a job; ``done`` takes what it returns, ``failed`` what it raises."""
        if self._running is not None:
            steps.close()
            failed(PinwarpError("Something else is still being made: wait for it or cancel it."))
            return
        self._running = _Running(steps, done, failed)
        self.started.emit(title)
        self._timer.start()

    def _step(self) -> None:
        running = self._running
        if running is None:
            return
        try:
            share, stage = next(running.steps)
        except StopIteration as end:
            self._end()
            running.done(end.value)
        except Exception as error:  # handed to whoever started it, as a worker's is
            self._end()
            running.failed(error)
        else:
            self.progressed.emit(share, stage)

    def cancel(self) -> None:
        """Stop where it stands."""
        running = self._running
        if running is not None:
            running.steps.close()
            self._end()
            running.failed(Cancelled("Cancelled."))

    def _end(self) -> None:
        self._timer.stop()
        self._running = None
        self.ended.emit()

    def shut_down(self) -> None:
        """Stop without a word."""
        if self._running is not None:
            self._running.steps.close()
        self._timer.stop()
        self._running = None
