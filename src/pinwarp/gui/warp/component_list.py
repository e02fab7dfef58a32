"""What of the warp is applied, to choose from, and how far each choice leaves the pairs apart."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from qtpy.QtCore import QRectF, QSize, Qt, Signal
from qtpy.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent
from qtpy.QtWidgets import (
    QButtonGroup,
    QGridLayout,
    QLabel,
    QRadioButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.components import Components
from pinwarp.gui.style import theme
from pinwarp.session.warp.component_words import COMPONENT_WORDS


@dataclass(frozen=True)
class Remainder:
    """What a choice leaves between the pairs: in words, and as a share of the largest."""

    text: str
    share: float


class ShareBar(QWidget):
    """A thin bar, as long as a share of its room."""

    def __init__(self) -> None:
        super().__init__()
        self.share = 0.0
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Preferred)

    def sizeHint(self) -> QSize:
        """Return a room that leaves the words beside it theirs."""
        return QSize(64, 10)

    def set_share(self, share: float) -> None:
        """Show another share."""
        self.share = share
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint a faint track and the bar on it."""
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setPen(Qt.PenStyle.NoPen)
            track = QRectF(0, self.height() / 2 - 2, self.width(), 4)
            faint = theme.text_colour()
            faint.setAlphaF(0.1)
            painter.setBrush(faint)
            painter.drawRoundedRect(track, 2, 2)
            if self.share > 0:
                track.setWidth(max(4.0, self.share * track.width()))
                painter.setBrush(QColor(theme.OVERLAY_COLOUR))
                painter.drawRoundedRect(track, 2, 2)


class ComponentRow(QWidget):
    """One choice; a click anywhere on it chooses."""

    def __init__(self, title: str, meaning: str) -> None:
        super().__init__()
        self.button = QRadioButton(title)
        self.meaning = QLabel(meaning)
        theme.make_quiet(self.meaning)
        self.bar = ShareBar()
        self.rms = QLabel()
        self.rms.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.rms.setMinimumWidth(self.fontMetrics().horizontalAdvance("0.00000 mm"))
        indent = self.button.style().pixelMetric(
            self.button.style().PixelMetric.PM_ExclusiveIndicatorWidth
        )
        self.meaning.setIndent(indent + 6)
        # Words give way before the figures do.
        self.meaning.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(theme.SPACE)
        grid.setVerticalSpacing(0)
        grid.addWidget(self.button, 0, 0)
        grid.addWidget(self.bar, 0, 1)
        grid.addWidget(self.rms, 0, 2)
        grid.addWidget(self.meaning, 1, 0, 1, 3)
        grid.setColumnStretch(0, 1)
        self.setToolTip(f"{title}: {meaning}")

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.button.click()


class ComponentList(QWidget):
    """One row for each choice."""

    chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.rows = {
            part: ComponentRow(words.title, words.meaning)
            for part, words in COMPONENT_WORDS.items()
        }
        group = QButtonGroup(self)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        for part, row in self.rows.items():
            group.addButton(row.button)
            column.addWidget(row)
            row.button.clicked.connect(lambda _checked=False, part=part: self.chosen.emit(part))

    def show_choice(self, components: Components) -> None:
        """Show what is applied."""
        self.rows[components].button.setChecked(True)

    def show_remainders(self, remainders: Mapping[Components, Remainder]) -> None:
        """Show what each choice leaves between the pairs; nothing where that is not known."""
        for part, row in self.rows.items():
            remainder = remainders.get(part)
            row.rms.setText("–" if remainder is None else remainder.text)
            row.bar.set_share(0.0 if remainder is None else remainder.share)
