"""Asks for one of several readings, and never decides by itself."""

from __future__ import annotations

from collections.abc import Mapping

from qtpy.QtCore import QObject, Signal
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.suggesting import words
from pinwarp.gui.suggesting.dialog import PICTURE, Choice, ReadingsDialog
from pinwarp.gui.suggesting.pictures import ReadingPictures
from pinwarp.gui.suggesting.run import Guessed
from pinwarp.gui.views.canvas import Canvas
from pinwarp.session.session import Session


class Asking(QObject):
    """Shows the pictures; ``chosen`` emits a reading and its :class:`Guessed`.

    ``cancelled`` is emitted where the user wants none of them.

    Parameters
    ----------
    views
        Whence the pictures are taken.
    window
        What waits for the answer.
    """

    chosen = Signal(object, object)
    cancelled = Signal()

    def __init__(self, views: Mapping[Side, Canvas], window: QWidget) -> None:
        super().__init__(window)
        self._views, self._window = views, window
        self.dialog: ReadingsDialog | None = None

    @property
    def is_open(self) -> bool:
        """Whether an answer is waited for."""
        return self.dialog is not None

    def ask(self, guessed: Guessed, session: Session) -> None:
        """Show a picture of each reading of a session, and wait for an answer."""
        guess, ratio = guessed.guess, self._window.devicePixelRatioF()
        pictures = ReadingPictures(
            self._views, session, round(ratio * PICTURE.width()), round(ratio * PICTURE.height())
        )
        choices = [
            Choice(pictures.of_reading(reading, drawn), *told)
            for reading, drawn, told in zip(
                guess.readings, guessed.drawn, words.titles(guess.readings), strict=True
            )
        ]
        dialog = ReadingsDialog(guess.words, pictures.of_source(), choices, self._window)
        dialog.chosen.connect(lambda number: self._on_chosen(number, guessed))
        dialog.rejected.connect(self._on_rejected)
        self.dialog = dialog
        dialog.open()

    def close(self) -> None:
        """Ask no more."""
        dialog, self.dialog = self.dialog, None
        if dialog is not None:
            dialog.close()

    def _on_chosen(self, number: int, guessed: Guessed) -> None:
        self.dialog = None
        self.chosen.emit(guessed.guess.readings[number], guessed)

    def _on_rejected(self) -> None:
        if self.dialog is not None:
            self.dialog = None
            self.cancelled.emit()
