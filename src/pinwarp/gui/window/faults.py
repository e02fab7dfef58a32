"""What no part of the window foresaw: told once, written into a log, and the window goes on."""

from __future__ import annotations

import logging
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from logging.handlers import RotatingFileHandler
from pathlib import Path
from types import TracebackType

from qtpy.QtCore import QObject, Signal

LOG = "log.txt"
LOG_SIZE = 200_000
"""Bytes; one older log of that size is kept beside it."""
# A report must fit into a message to us; what follows from the first faults says little.
MOST_REPORTS = 20
_Key = tuple[str, tuple[tuple[str, int | None], ...]]


class Faults(QObject):
    """Takes exceptions that nobody caught, from any thread.

    ``told`` emits a sentence for the user, once for each fault: one that comes back with every
    movement of the mouse is no news.

    Parameters
    ----------
    folder
        Where the log is written, None for none.
    parent
        The window.

    Attributes
    ----------
    reports : list of str
        The traceback of each fault, the first before the others.
    """

    told = Signal(str)
    _taken = Signal(object, str, str)

    def __init__(self, folder: Path | None, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.reports: list[str] = []
        self._counts: dict[_Key, int] = {}
        self._log = _log_in(folder) if folder is not None else None
        # From another thread it is told in the window's.
        self._taken.connect(self._on_taken)

    @property
    def count(self) -> int:
        """How often something failed, repetitions included."""
        return sum(self._counts.values())

    def take(
        self, kind: type[BaseException], error: BaseException, where: TracebackType | None
    ) -> None:
        """Take an exception; what is no fault, such as Ctrl+C, is handed on.

        Parameters
        ----------
        kind, error, where
            As :data:`sys.excepthook` is given them.
        """
        if not isinstance(error, Exception):
            sys.__excepthook__(kind, error, where)
            return
        frames = tuple((frame.filename, frame.lineno) for frame in traceback.extract_tb(where))
        text = "".join(traceback.format_exception(kind, error, where))
        for kept in ("last_exc", "last_value", "last_traceback"):
            # Python keeps the last one for debuggers, and with its frames all that they hold.
            vars(sys).pop(kept, None)
        try:
            self._taken.emit((kind.__name__, frames), kind.__name__, text)
        except RuntimeError:  # the window is gone
            sys.__excepthook__(kind, error, where)

    @contextmanager
    def taken_over(self) -> Iterator[None]:
        """Take everything that is not caught in this process, until the end of the context."""
        before = sys.excepthook, threading.excepthook

        def take_from_thread(args: threading.ExceptHookArgs) -> None:
            if args.exc_value is not None:
                self.take(args.exc_type, args.exc_value, args.exc_traceback)

        sys.excepthook, threading.excepthook = self.take, take_from_thread
        try:
            yield
        finally:
            sys.excepthook, threading.excepthook = before

    def shut_down(self) -> None:
        """Close the log."""
        if self._log is not None:
            self._log.close()

    def _on_taken(self, key: _Key, name: str, text: str) -> None:
        is_news = key not in self._counts
        self._counts[key] = self._counts.get(key, 0) + 1
        if not is_news:
            return
        if len(self.reports) < MOST_REPORTS:
            self.reports.append(text)
        if self._log is not None:
            self._log.handle(logging.LogRecord("pinwarp", logging.ERROR, "", 0, text, None, None))
        if sys.stderr is not None:
            print(text, file=sys.stderr)
        self.told.emit(
            f"Something went wrong ({name}) and was left out; the rest goes on. "
            "Help > Copy Details has what to report."
        )


class _Log(RotatingFileHandler):
    def handleError(self, record: logging.LogRecord) -> None:
        """Go on without: a log that cannot be written must not be one more fault."""


def _log_in(folder: Path) -> _Log:
    log = _Log(folder / LOG, maxBytes=LOG_SIZE, backupCount=1, encoding="utf-8", delay=True)
    log.setFormatter(logging.Formatter("%(asctime)s process %(process)d\n%(message)s"))
    return log
