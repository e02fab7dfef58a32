"""What a view is of, and what may be done with an empty one."""

from __future__ import annotations

from qtpy.QtCore import QPointF, QRectF, Qt
from qtpy.QtGui import QColor, QFont, QPainter, QPen

from pinwarp.gui.scene.drawables import Badge, Caption, Hint, NextClick, ToolWords, WorkWords
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


def paint_next_click(
    painter: QPainter, step: NextClick, view: QRectF, right: float, *, dark: bool
) -> None:
    """Paint what the next click does into the lower left corner, no further than ``right``."""
    ink, _ = theme.inks(dark)
    edge = QColor(0, 0, 0, 190) if dark else QColor(255, 255, 255, 190)
    metrics = painter.fontMetrics()
    room = max(0, round(right - 2 * _MARGIN))
    words = metrics.elidedText(step.words, Qt.TextElideMode.ElideRight, room)
    at = QPointF(_MARGIN, view.bottom() - _MARGIN - metrics.descent())
    # An edge keeps it readable on a bone that reaches into the corner.
    painter.setPen(edge)
    for shift in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        painter.drawText(at + QPointF(*shift), words)
    painter.setPen(ink)
    painter.drawText(at, words)


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


def paint_tool_words(painter: QPainter, tool: ToolWords, view: QRectF) -> None:
    """Say at the lower edge what to do, in as many lines as it takes."""
    room = QRectF(0, 0, min(460, view.width() - 24) - 20, view.height() / 2)
    flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
    plate = painter.boundingRect(room, flags, tool.words).adjusted(-10, -5, 10, 5)
    # Above the scale bar.
    plate.moveBottom(view.height() - 44)
    plate.moveLeft((view.width() - plate.width()) / 2)
    _paint_plate(painter, plate, flags, tool.words)


def paint_badge(painter: QPainter, badge: Badge | WorkWords, view: QRectF) -> None:
    """Say in the upper right corner that something unusual is shown, or being made."""
    metrics, margin = painter.fontMetrics(), 10
    room = round(view.width() - 2 * margin - 20)
    words = metrics.elidedText(badge.words, Qt.TextElideMode.ElideRight, room)
    plate = QRectF(0, margin, metrics.horizontalAdvance(words) + 20, metrics.height() + 8)
    plate.moveRight(view.width() - margin)
    _paint_plate(painter, plate, Qt.AlignmentFlag.AlignCenter, words)


def _paint_plate(painter: QPainter, plate: QRectF, flags: int, words: str) -> None:
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(theme.INK))
    painter.drawRoundedRect(plate, 6, 6)
    painter.setPen(QColor(theme.PAPER))
    painter.drawText(plate, flags, words)
