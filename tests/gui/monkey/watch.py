"""What must never happen at a window: collected from wherever it would be told."""

from __future__ import annotations

import logging
import sys
import threading
import traceback
from types import TracebackType

from qtpy.QtCore import QEvent, QObject, qInstallMessageHandler
from vtkmodules.vtkCommonCore import vtkFileOutputWindow, vtkOutputWindow

# Of the platform, and true of any window under a bare X server.
_HARMLESS = (
    "This plugin does not support propagateSizeHints",
    "QXcbConnection: XCB error",
    "This plugin does not support raise()",
    # Drags go beyond the window.
    "occurs outside target window",
    # A row that its new name takes out of the filter leaves with its line, after the commit.
    "commitData called with an editor that does not belong to this view",
    # Of opening a second window in one process, which only tests do.
    "Setting a new default format with a different version or profile",
)


class Watch:
    """Collects exceptions that reach the event loop, warnings of Qt and VTK, and logged errors."""

    def __init__(self, vtk_log: str) -> None:
        self.seen: list[str] = []
        self._vtk_log = vtk_log
        self._handler = _Logged(self.seen)

    def __enter__(self) -> Watch:
        self._hooks = sys.excepthook, threading.excepthook, sys.unraisablehook
        sys.excepthook = self._on_exception
        threading.excepthook = lambda args: self._on_exception(
            args.exc_type, args.exc_value, args.exc_traceback
        )
        sys.unraisablehook = lambda args: self._on_exception(
            args.exc_type, args.exc_value, args.exc_traceback
        )
        self._messages = qInstallMessageHandler(self._on_message)
        self._output = vtkOutputWindow.GetInstance()
        window = vtkFileOutputWindow()
        window.SetFileName(self._vtk_log)
        window.SetFlush(True)
        vtkOutputWindow.SetInstance(window)
        logging.getLogger("pinwarp").addHandler(self._handler)
        return self

    def __exit__(self, *_error: object) -> None:
        sys.excepthook, threading.excepthook, sys.unraisablehook = self._hooks
        qInstallMessageHandler(self._messages)
        vtkOutputWindow.SetInstance(self._output)
        logging.getLogger("pinwarp").removeHandler(self._handler)

    def take(self) -> list[str]:
        """Return what was seen since the last time."""
        seen = list(self.seen)
        self.seen.clear()
        return seen

    def note(self, error: BaseException) -> None:
        """Take an exception that was caught on its way."""
        self._on_exception(type(error), error, error.__traceback__)

    def _on_exception(
        self,
        kind: type[BaseException],
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.seen.append("".join(traceback.format_exception(kind, error, trace)))

    def _on_message(self, kind: object, _context: object, text: str) -> None:
        if not any(words in text for words in _HARMLESS):
            self.seen.append(f"Qt says ({kind}): {text}")


class Events(QObject):
    """Counts the events of mouse, wheel and keyboard that reach the program.

    One that a widget hands on to its parent is the same one.
    """

    KINDS = (
        QEvent.Type.MouseButtonPress,
        QEvent.Type.MouseButtonRelease,
        QEvent.Type.MouseButtonDblClick,
        QEvent.Type.MouseMove,
        QEvent.Type.Wheel,
        QEvent.Type.KeyPress,
        QEvent.Type.KeyRelease,
    )

    def __init__(self) -> None:
        super().__init__()
        self.count = 0
        self._last: object = None

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        if event.type() in self.KINDS:
            this = (event.type(), event.timestamp())
            self.count += this != self._last
            self._last = this
        return False


class _Logged(logging.Handler):
    """Hands on what the program logs as an error."""

    def __init__(self, seen: list[str]) -> None:
        super().__init__(logging.WARNING)
        self._seen = seen

    def emit(self, record: logging.LogRecord) -> None:
        self._seen.append(self.format(record))
