"""The bar above the bones that asks for the steps of the tour, and the button that offers it."""

from __future__ import annotations

from qtpy.QtCore import QEvent, QObject, QRect, Signal
from qtpy.QtWidgets import QPushButton, QWidget

from pinwarp.gui.style.bar import Bar

# Below the middle of an empty view, where a plate says what may be dropped there.
_BELOW_MIDDLE = 76


class TourBar(Bar):
    """Says what is to be done; asks to skip a step and to leave."""

    skip_requested = Signal()
    left = Signal()

    def __init__(self) -> None:
        super().__init__(progress_width=110)
        self.words.setWordWrap(True)
        self.skip = self.add_button("Skip", "Go on to the next step", self.skip_requested)
        self.leave = self.add_button("", "Help > Take the Tour goes on where you left", self.left)

    def show_step(self, words: str, number: int, total: int) -> None:
        """Ask for a step.

        Parameters
        ----------
        words
            HTML.
        number
            How many are done.
        total
            How many there are.
        """
        self.words.setText(words)
        self.show_share(number, total)
        self.skip.setVisible(number < total)
        self.leave.setText("Leave" if number < total else "Close")
        self.show()


class TourOffer(QPushButton):
    """Stands in an empty view.

    Parameters
    ----------
    view
        The view.
    """

    def __init__(self, view: QWidget) -> None:
        super().__init__(view)
        self.setProperty("primary", True)
        self.setToolTip("Five steps on the sample bones, three minutes")
        self.hide()
        view.installEventFilter(self)

    def offer(self, text: str) -> None:
        """Offer it in such words; empty ones take the offer away."""
        self.setText(text)
        self.setVisible(bool(text))
        self._place()

    def eventFilter(self, _view: QObject, event: QEvent) -> bool:
        """Stay below the middle."""
        if event.type() == QEvent.Type.Resize:
            self._place()
        return False

    def _place(self) -> None:
        view = self.parentWidget()
        where = QRect(0, 0, self.sizeHint().width(), self.sizeHint().height())
        where.moveCenter(view.rect().center())
        where.translate(0, _BELOW_MIDDLE + where.height() // 2)
        self.setGeometry(where)
