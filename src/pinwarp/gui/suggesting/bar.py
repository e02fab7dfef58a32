"""The bar above the bones that offers a first guess, and tells how it stands."""

from __future__ import annotations

from qtpy.QtCore import QEvent, QObject, Qt, Signal
from qtpy.QtWidgets import QWidget

from pinwarp.gui.style.bar import Bar
from pinwarp.gui.suggesting import words

_KEYS = (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress)


class SuggestBar(Bar):
    """Says one thing at a time; asks to begin, to stop, or to take the destination for a part.

    ``left`` is emitted by its last button and by Esc, whatever is shown but the offer, which Esc
    leaves alone: it has other meanings.

    Parameters
    ----------
    window
        Whose Esc leaves.
    """

    suggest_requested = Signal()
    part_requested = Signal()
    closed = Signal()
    left = Signal()

    def __init__(self, window: QWidget) -> None:
        super().__init__(progress_width=150)
        self.words.setWordWrap(True)
        self.suggest = self.add_button("Suggest All", "", self.suggest_requested)
        self.part = self.add_button(
            "It Is Only a Part",
            "The destination is a cut or broken bone: look for the part that is there",
            self.part_requested,
        )
        self.close_offer = self.add_button(
            "Not Now", "Not offered again in this session", self.closed
        )
        self.leave = self.add_button("", "", self.left)
        self._takes_escape = False
        window.installEventFilter(self)

    # What is shown

    def show_offer(self, text: str) -> None:
        """Offer a first guess."""
        self._show(text, self.suggest, self.close_offer)

    def show_busy(self, share: float, stage: str) -> None:
        """Show how far the first guess is."""
        self.progress.setFormat("%p%")
        self.show_share(round(100 * share), 100)
        self._show(stage[:1].upper() + stage[1:], self.progress, self.leave, leaving="Cancel")

    def show_going(self, text: str, done: int, total: int) -> None:
        """Show which landmark is next, and how many are placed."""
        self.progress.setFormat("%v of %m")
        self.show_share(done, total)
        self._show(text, self.progress, self.leave, leaving="Leave")

    def show_problem(self, text: str, *, may_be_part: bool) -> None:
        """Show why nothing is suggested, and the way out."""
        also = (self.part,) if may_be_part else ()
        self._show(text, *also, self.leave, leaving="Close")

    def show_nothing(self) -> None:
        """Hide."""
        self._takes_escape = False
        self.hide()

    def _show(self, text: str, *widgets: QWidget, leaving: str = "") -> None:
        if text != self.words.text():
            self.words.setText(text)
        self.only(*widgets)
        self.leave.setText(leaving)
        self.leave.setToolTip({"Cancel": "Esc", "Leave": f"Esc: {words.LEFT}"}.get(leaving, "Esc"))
        self._takes_escape = bool(leaving)
        self.show()

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        """Leave by Esc, before it deselects."""
        if not self._takes_escape or event.type() not in _KEYS:
            return False
        if event.key() != Qt.Key.Key_Escape or event.modifiers():
            return False
        event.accept()
        if event.type() == QEvent.Type.KeyPress:
            self.left.emit()
        return True
