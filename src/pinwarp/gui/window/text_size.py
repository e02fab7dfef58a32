"""View > Text Size: all words of the window, as large as one needs them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from qtpy.QtCore import QObject, QSettings
from qtpy.QtWidgets import QApplication

from pinwarp.gui.capability.action import Action, one_of
from pinwarp.gui.capability.capability import Capability

# In per cent of the system's.
SIZES = (100, 125, 150, 200)
_REMEMBERED = "text_size"


def remembered_size(settings: QSettings) -> int:
    """Return the size that was chosen, in per cent of the system's."""
    stored = str(settings.value(_REMEMBERED, SIZES[0]))
    return int(stored) if stored.isdecimal() and int(stored) in SIZES else SIZES[0]


def write_in(size: int) -> None:
    """Write all words of windows that are made from now on in a size, in per cent of the system's.

    Rows, fields and columns are as large as their words when a window is made.
    """
    font = QApplication.font()
    font.setPointSizeF(font.pointSizeF() * size / 100)
    QApplication.setFont(font)


class TextSize(Capability):
    """Asks for another size; it holds from the next start on.

    Parameters
    ----------
    settings
        Where it is remembered.
    say
        Says a sentence in passing.
    parent
        The window.
    """

    def __init__(self, settings: QSettings, say: Callable[[str], None], parent: QObject) -> None:
        self._settings = settings
        self._say = say
        self.actions = (
            *one_of(
                (
                    Action(
                        f"text_{size}",
                        f"{size} %",
                        partial(self._choose, size),
                        checked=partial(self._is_chosen, size),
                        at=f"text_size.1{number}",
                        tip=f"Words at {size} % of the system's size, from the next start on",
                    )
                    for number, size in enumerate(SIZES, 1)
                ),
                parent,
            ),
        )

    def _is_chosen(self, size: int) -> bool:
        return remembered_size(self._settings) == size

    def _choose(self, size: int) -> None:
        self._settings.setValue(_REMEMBERED, size)
        self._say(f"The text is at {size} % when pinwarp is started the next time")
