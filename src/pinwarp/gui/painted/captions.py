"""What a view is of, and what may be done with an empty one."""

from __future__ import annotations

from qtpy.QtCore import QPointF, QRectF, Qt
from qtpy.QtGui import QColor, QFont, QPainter, QPen

from pinwarp.gui.scene.drawables import Caption, Hint
from pinwarp.gui.style import theme

_MARGIN = 12


def paint_caption(painter: QPainter, caption: Caption, width: int, *, dark: bool) -> None:
    """Paint which side and file a view shows into its upper left corner.

    Parameters
    ----------
    painter, width
        Where, and how wide the view is.
    caption
        The words.
    dark
        Whether the background is.
    """
    ink, quiet_ink = theme.inks(dark)
    plain = painter.font()
    font = QFont(plain)
    font.setWeight(QFont.Weight.DemiBold)
    painter.setFont(font)
    painter.setPen(ink)
    line = painter.fontMetrics().height()
    painter.drawText(QPointF(_MARGIN, _MARGIN + line * 0.8), caption.title)
    painter.setFont(plain)
    painter.setPen(quiet_ink)
    file = painter.fontMetrics().elidedText(
        caption.file, Qt.TextElideMode.ElideMiddle, width - 2 * _MARGIN
    )
    painter.drawText(QPointF(_MARGIN, _MARGIN + line * 1.9), file)


def paint_hint(painter: QPainter, hint: Hint, view: QRectF, *, dark: bool) -> None:
    """Paint what may be done with an empty view onto a plate in its middle; as above."""
    ink, quiet_ink = theme.inks(dark)
    plate = QRectF(0, 0, min(340, view.width() - 24), 120)
    plate.moveCenter(view.center())
    painter.setPen(QPen(quiet_ink, 1.5, Qt.PenStyle.DashLine))
    painter.setBrush(QColor(255, 255, 255, 20 if dark else 120))
    painter.drawRoundedRect(plate, 10, 10)
    painter.setPen(ink)
    painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, hint.words)
