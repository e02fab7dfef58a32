"""Work off the UI thread: the latest request wins, and one slow thing at a time with progress."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

from qtpy.QtCore import QObject, Signal

from pinwarp.core.errors import Cancelled


class _Outcome(QObject):
    """Carries a result across threads; signals between threads are queued by Qt."""

    finished = Signal(int, object, object)
    progressed = Signal(float, str)


class _Worker:
    """One thread that does what it is asked to, one thing after the other.

    Not Qt's pool: on a busy machine PySide now and then keeps what was run there for ever.

    Parameters
    ----------
    outcome
        Told of each result or error, by the number it was asked for with.
    """

    def __init__(self, outcome: _Outcome) -> None:
        self._outcome = outcome
        self._thread = ThreadPoolExecutor(1)

    def start(self, number: int, function: Callable[[], Any]) -> None:
        """Do something once all before it is done."""
        self._thread.submit(self._run, number, function)

    def _run(self, number: int, function: Callable[[], Any]) -> None:
        result, error = None, None
        try:
            result = function()
        except Exception as exception:  # handed to the UI thread, which shows or raises it
            error = exception
        with suppress(RuntimeError):  # the window closed while this was computed
            self._outcome.finished.emit(number, result, error)

    def shut_down(self) -> None:
        """Wait until all is done."""
        self._thread.shutdown()


class LatestWins(QObject):
    """Computes at most one request at a time and remembers only the newest one waiting.

    Parameters
    ----------
    function
        Called with a request in the worker thread; its result arrives by ``computed``. Where it
        passes :meth:`checkpoint` it ends as soon as its result is no longer wanted.
    """

    computed = Signal(object)
    failed = Signal(object)
    progressed = Signal(float)
    stopped = Signal()

    def __init__(self, function: Callable[[Any], Any], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._function = function
        self._outcome = _Outcome()
        self._worker = _Worker(self._outcome)
        self._outcome.finished.connect(self._on_finished)
        self._outcome.progressed.connect(self._on_progressed)
        self._waiting: list[Any] = []
        self._unwanted = threading.Event()
        self._told = 0.0
        self._busy = self._is_shut_down = False

    @property
    def is_idle(self) -> bool:
        """Whether nothing is being computed or waiting."""
        return not self._busy

    def request(self, request: Any) -> None:
        """Ask for a result; a request still waiting is dropped for this one."""
        if self._busy:
            self._waiting = [request]
            self._unwanted.set()
        else:
            self._start(request)

    def stop(self) -> None:
        """Want nothing any more: ``stopped`` emits once what runs has passed a checkpoint."""
        self._waiting.clear()
        self._unwanted.set()

    def checkpoint(self, share: float) -> None:
        """Tell which share is done; Cancelled where the result is unwanted. For the worker."""
        if self._unwanted.is_set():
            raise Cancelled("Cancelled.")
        # Not more often than can be seen.
        if abs(share - self._told) >= 0.01:
            self._told = share
            self._outcome.progressed.emit(share, "")

    def request_if_idle(self, request: Any) -> None:
        """Ask for something that can wait: dropped where anything else is under way."""
        if not self._busy:
            self._start(request)

    def _start(self, request: Any) -> None:
        self._busy = True
        self._unwanted.clear()
        self._told = 0.0
        self._worker.start(0, lambda: self._function(request))

    def _on_progressed(self, share: float, _stage: str) -> None:
        self.progressed.emit(share)

    def _on_finished(self, _number: int, result: Any, error: Exception | None) -> None:
        self._busy = False
        if self._is_shut_down:
            # Qt delivers what was on its way before the disconnection.
            return
        if self._waiting:
            self._start(self._waiting.pop())
        if isinstance(error, Cancelled):
            if not self._busy:
                self.stopped.emit()
        elif error is not None:
            self.failed.emit(error)
        else:
            self.computed.emit(result)

    def shut_down(self) -> None:
        """Forget what waits and let the running computation end, at its next checkpoint."""
        self._is_shut_down = True
        self.stop()
        self._outcome.progressed.disconnect(self._on_progressed)
        self._outcome.finished.disconnect(self._on_finished)
        self._worker.shut_down()


class SlowJob(QObject):
    """Runs slow things one after the other, each with progress and a way to cancel it."""

    started = Signal(str)
    progressed = Signal(float, str)
    ended = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._outcome = _Outcome()
        self._worker = _Worker(self._outcome)
        self._outcome.finished.connect(self._on_finished)
        self._outcome.progressed.connect(self.progressed)
        self._cancel = threading.Event()
        self._number = 0
        self._handlers: dict[int, tuple[Callable[[Any], None], Callable[[Exception], None]]] = {}

    @property
    def is_idle(self) -> bool:
        """Whether nothing runs or waits."""
        return not self._handlers

    def run(
        self,
        title: str,
        function: Callable[[Callable[[float, str], None]], Any],
        done: Callable[[Any], None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Start a job.

        Parameters
        ----------
        title
            What the user reads meanwhile.
        function
            Runs in the worker with a progress callback (share done, stage), which raises
            :class:`Cancelled` once the user cancelled.
        done, failed
            One of them is called in the UI thread.
        """
        if self.is_idle:
            self._cancel.clear()
        self._number += 1
        self._handlers[self._number] = (done, failed)
        self.started.emit(title)
        self._worker.start(self._number, lambda: function(self._progress))

    def _progress(self, share: float, stage: str) -> None:
        if self._cancel.is_set():
            raise Cancelled("Cancelled.")
        self._outcome.progressed.emit(share, stage)

    def cancel(self) -> None:
        """Ask the running job to stop at its next stage."""
        self._cancel.set()

    @property
    def is_cancelled(self) -> bool:
        """Whether the running job was asked to stop; also for the worker."""
        return self._cancel.is_set()

    def _on_finished(self, number: int, result: Any, error: Exception | None) -> None:
        if number not in self._handlers:
            # Shut down: Qt delivers what was on its way before the disconnection.
            return
        done, failed = self._handlers.pop(number)
        if self.is_idle:
            self.ended.emit()
        if error is not None:
            failed(error)
        else:
            done(result)

    def shut_down(self) -> None:
        """Cancel what runs and wait for it."""
        self.cancel()
        self._handlers.clear()
        self._outcome.finished.disconnect(self._on_finished)
        self._worker.shut_down()
