"""Asks which reading of the destination is meant, by pictures."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

from qtpy.QtCore import QSize, Qt, Signal
from qtpy.QtGui import QIcon, QImage, QPixmap
from qtpy.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from pinwarp.gui.style import theme
from pinwarp.gui.suggesting.words import WHICH

# Of a picture, in logical pixels: four beside one another fit a window of 1280 x 720.
PICTURE = QSize(280, 380)


@dataclass(frozen=True, eq=False)
class Choice:
    """A reading as it is offered: its picture, what it is, and how well it fits."""

    picture: QImage
    title: str
    figures: str


class ReadingsDialog(QDialog):
    """A click on a picture chooses it: ``chosen`` emits its number. Nothing is chosen beforehand.

    Parameters
    ----------
    why
        Why it must be asked.
    source
        A picture to compare with.
    choices
        The best first.
    parent
        The window.
    """

    chosen = Signal(int)

    def __init__(
        self, why: str, source: QImage, choices: Sequence[Choice], parent: QWidget
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle("Suggest All")
        self.setWindowModality(Qt.WindowModality.WindowModal)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        reason = QLabel(f"{html.escape(why)} <b>{WHICH}</b>")
        reason.setWordWrap(True)
        row = QHBoxLayout()
        row.setSpacing(2 * theme.SPACE)
        picture = QLabel()
        picture.setPixmap(_pixmap(source))
        # As far from its edge as those in buttons.
        picture.setContentsMargins(4, 4, 4, 4)
        row.addLayout(_card(picture, "The source", "to compare with"))
        self.cards = []
        for number, choice in enumerate(choices):
            button = self._button(number, choice)
            self.cards.append(button)
            row.addLayout(_card(button, choice.title, choice.figures))
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setSpacing(2 * theme.SPACE)
        column.addWidget(reason)
        column.addLayout(row)
        column.addWidget(self.buttons)
        # Enter must not choose what nobody looked at.
        self.buttons.button(QDialogButtonBox.StandardButton.Cancel).setFocus()

    def _button(self, number: int, choice: Choice) -> QToolButton:
        button = QToolButton()
        button.setIcon(QIcon(_pixmap(choice.picture)))
        button.setIconSize(PICTURE)
        button.setCursor(Qt.CursorShape.PointingHandCursor)
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        button.setAccessibleName(choice.title)
        button.setToolTip("This is meant")
        button.clicked.connect(lambda _checked=False: self._choose(number))
        return button

    def _choose(self, number: int) -> None:
        self.accept()
        self.chosen.emit(number)


def _pixmap(picture: QImage) -> QPixmap:
    pixmap = QPixmap.fromImage(picture)
    pixmap.setDevicePixelRatio(picture.width() / PICTURE.width())
    return pixmap


def _card(picture: QWidget, title: str, figures: str) -> QVBoxLayout:
    """Return a picture above what it is and how well it fits."""
    card = QVBoxLayout()
    card.setSpacing(theme.SPACE // 2)
    card.addWidget(picture, 0, Qt.AlignmentFlag.AlignHCenter)
    for text in (f"<b>{html.escape(title)}</b>", html.escape(figures)):
        label = QLabel(text)
        label.setAlignment(Qt.AlignmentFlag.AlignHCenter)
        card.addWidget(label)
    card.addStretch()
    return card
