"""A bar above the bones: words at the left, how far one is, and buttons at the right."""

from __future__ import annotations

from typing import Any

from qtpy.QtCore import Qt
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


class Bar(QFrame):
    """Hidden until there is something to say.

    Parameters
    ----------
    progress_width
        In pixels.
    """

    def __init__(self, progress_width: int) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setAutoFillBackground(True)
        self.words = QLabel()
        self.words.setTextFormat(Qt.TextFormat.RichText)
        # Long words must not push the table aside.
        self.words.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.progress = QProgressBar()
        self.progress.setFixedWidth(progress_width)
        self.progress.setFormat("%v of %m")
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(12, 4, 8, 4)
        self._row.setSpacing(theme.SPACE)
        self._row.addWidget(self.words, 1)
        self._row.addWidget(self.progress)
        self.hide()

    def add_button(self, text: str, tip: str, signal: Any) -> QPushButton:
        """Add a button that emits a signal.

        Parameters
        ----------
        text, tip
            What it says.
        signal
            Without arguments.
        """
        button = QPushButton(text)
        button.setToolTip(tip)
        # The keyboard stays with the bones.
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        button.clicked.connect(lambda _checked=False: signal.emit())
        self._row.addWidget(button)
        return button

    def show_share(self, done: int, total: int) -> None:
        """Show how many of how many are done."""
        self.progress.setRange(0, total)
        self.progress.setValue(done)

    def only(self, *widgets: QWidget) -> None:
        """Show these of progress and buttons, and hide the others."""
        for widget in (self.progress, *self.findChildren(QPushButton)):
            widget.setVisible(widget in widgets)
