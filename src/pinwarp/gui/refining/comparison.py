"""The warp without its refinement: for as long as R is held, or until it is switched back."""

from __future__ import annotations

from collections.abc import Callable

from qtpy.QtCore import QObject, Qt, Signal
from qtpy.QtGui import QKeySequence, QShortcut
from qtpy.QtWidgets import QWidget

from pinwarp.gui.capability.action import Action
from pinwarp.gui.refining.words import NOTHING_TO_COMPARE
from pinwarp.gui.tasks.passing import Passing


class WithoutRefinement(QObject):
    """Knows whether one wants to look at the warp of the landmarks alone.

    ``changed`` is emitted when that changes.

    Parameters
    ----------
    possible
        Whether there is another to compare it with.
    say
        Shows a message in the status bar.
    window
        Where the key counts.
    """

    changed = Signal()

    def __init__(
        self, possible: Callable[[], bool], say: Callable[[str], None], window: QWidget
    ) -> None:
        super().__init__(window)
        self._possible = possible
        self._say = say
        self._is_switched = False
        self._passing = Passing(self, Qt.Key.Key_R)
        self._passing.ended.connect(self.changed)
        key = QShortcut(QKeySequence(Qt.Key.Key_R), window)
        key.setAutoRepeat(False)
        key.activated.connect(self._on_held)
        self.action = Action(
            "without_refinement",
            # Behind the tab stands the key that is held; the action itself has none.
            "Show Without Refine&ment\tR (hold)",
            switches=self._switch,
            checked=lambda: self._is_switched,
            at="Warp.42",
            tip="The warp of the landmarks alone; hold R only to look at it",
            button="Before (Hold R)",
            possible=possible,
        )

    @property
    def is_on(self) -> bool:
        """Whether the refinement is to be left out."""
        return self._is_switched or self._passing.is_up

    @property
    def badge(self) -> str:
        """What says so in the view."""
        if self._passing.is_up:
            return "R: without refinement (hold)"
        return "Without refinement" if self._is_switched else ""

    def follow(self) -> None:
        """Look whether there is still anything to compare."""
        if not self._possible():
            self.end()
        self.action.renew()

    def end(self) -> None:
        """Show the refined warp again."""
        self._passing.end()
        self._switch(False)
        self.action.renew()

    def _switch(self, on: bool) -> None:
        if on != self._is_switched:
            self._is_switched = on
            self.changed.emit()

    def _on_held(self) -> None:
        if self._possible():
            self._passing.begin()
            self.changed.emit()
        else:
            self._say(NOTHING_TO_COMPARE)
