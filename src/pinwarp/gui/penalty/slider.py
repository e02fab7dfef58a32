"""The slider of the penalty: its scale is flexibility, from interpolation to the affine fit."""

from __future__ import annotations

from qtpy.QtCore import QLineF, Qt
from qtpy.QtGui import QColor, QPainter, QPaintEvent, QPen
from qtpy.QtWidgets import QSlider, QStyle, QStyleOptionSlider, QWidget

from pinwarp.gui.style import theme

STEPS = 1000


class PenaltySlider(QSlider):
    """A slider that can show where the poles of the OPYNSIM convention lie."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self.setRange(0, STEPS)
        self.setPageStep(STEPS // 20)
        self._poles: tuple[float, ...] = ()

    @property
    def poles(self) -> tuple[float, ...]:
        """Where the poles are, as shares of the slider's length."""
        return self._poles

    def set_poles(self, shares: tuple[float, ...]) -> None:
        """Mark poles at these shares of the slider's length."""
        if shares != self._poles:
            self._poles = shares
            self.update()

    def place_of(self, share: float) -> float:
        """Return where the handle's centre is at a share of the slider's length, in pixels."""
        handle = self._handle_width()
        return handle / 2 + share * (self.width() - handle)

    def share_at(self, x: float) -> float:
        """Return the share of the slider's length whose handle would be centred at x."""
        handle = self._handle_width()
        return min(1.0, max(0.0, (x - handle / 2) / max(1, self.width() - handle)))

    def _handle_width(self) -> int:
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        handle = self.style().subControlRect(
            QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, self
        )
        return int(handle.width())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the slider, and a tick above the groove for each pole."""
        super().paintEvent(event)
        if not self._poles:
            return
        with QPainter(self) as painter:
            painter.setPen(QPen(QColor(theme.WARNING_COLOUR), 1.5))
            painter.drawLines(
                [QLineF(x, 0, x, 7) for x in (self.place_of(share) for share in self._poles)]
            )
