"""Signals whose listeners cannot harm one another: what one raises, the others never see."""

from __future__ import annotations

import sys
from typing import Any

import psygnal


class _Isolated(psygnal.SignalInstance):
    """Calls every listener, whatever those before it raised."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        # psygnal has no public way to go on after an exception.
        self._run_emit_loop_inner = self._call_each

    def _call_each(self) -> None:
        values = self._emit_queue.popleft()
        for listener in list(self._slots):
            if not listener._is_alive():
                continue
            try:
                listener.cb(values)
            except Exception as error:  # whatever it is, it is not the emitter's
                sys.excepthook(type(error), error, error.__traceback__)


def isolated(*types: type) -> psygnal.Signal:
    """Return a signal whose listeners cannot harm one another.

    What a listener raises goes to :data:`sys.excepthook`, as an exception in a slot of Qt does;
    the emitter goes on as if nothing had happened.

    Parameters
    ----------
    *types
        What it emits.

    Examples
    --------
    >>> class Bell:
    ...     rung = isolated(int)
    >>> bell, heard = Bell(), []
    >>> tell = sys.excepthook
    >>> sys.excepthook = lambda kind, error, where: heard.append(kind.__name__)
    >>> _ = bell.rung.connect(lambda times: 1 / 0)
    >>> _ = bell.rung.connect(heard.append)
    >>> bell.rung.emit(3)
    >>> heard
    ['ZeroDivisionError', 3]
    >>> sys.excepthook = tell
    """
    return psygnal.Signal(*types, signal_instance_class=_Isolated)
