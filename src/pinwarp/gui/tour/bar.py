"""The bar above the bones that asks for the steps of the tour, and the button that offers it."""

from __future__ import annotations

from qtpy.QtCore import QEvent, QObject, QRect, Qt, Signal
from qtpy.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QWidget,
)

from pinwarp.gui.style import theme

# Below the middle of an empty view, where a plate says what may be dropped there.
_BELOW_MIDDLE = 76


class TourBar(QFrame):
    """Says what is to be done; asks to skip a step and to leave."""

    skip_requested = Signal()
    left = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setAutoFillBackground(True)
        self.words = QLabel(textFormat=Qt.TextFormat.RichText, wordWrap=True)
        # Long words must not push the table aside.
        self.words.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.progress = QProgressBar(format="%v of %m")
        self.progress.setFixedWidth(110)
        self.skip = QPushButton("Skip", toolTip="Go on to the next step")
        self.leave = QPushButton(toolTip="Help > Take the Tour goes on where you left")
        for button, signal in ((self.skip, self.skip_requested), (self.leave, self.left)):
            # The keyboard stays with the bones.
            button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            button.clicked.connect(lambda _checked=False, signal=signal: signal.emit())
        row = QHBoxLayout(self)
        row.setContentsMargins(12, 6, 8, 6)
        row.setSpacing(theme.SPACE)
        row.addWidget(self.words, 1)
        for widget in (self.progress, self.skip, self.leave):
            row.addWidget(widget)
        self.hide()

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
        self.progress.setRange(0, total)
        self.progress.setValue(number)
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
