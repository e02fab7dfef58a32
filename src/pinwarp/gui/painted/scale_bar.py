"""The scale bar: a round length, as long as it looks at the focal plane."""

from __future__ import annotations

from qtpy.QtCore import QLineF, QPointF, QRectF, Qt
from qtpy.QtGui import QColor, QFontMetricsF, QPainter, QPen

from pinwarp.gui.style import theme
from pinwarp.gui.style.lengths import round_length

# Logical pixels that a bar takes at most, and its distance from the corner.
LONGEST = 120
MARGIN = 14


def length_text(length: float, unit: str) -> str:
    """Return a length in words.

    Examples
    --------
    >>> length_text(50.0, "mm"), length_text(0.05, "m")
    ('50 mm', '0.05 m')
    """
    return f"{length:.12g} {unit}".rstrip()


def paint_scale_bar(
    painter: QPainter, view: QRectF, unit_per_pixel: float, unit: str, *, dark: bool = False
) -> QRectF:
    """Paint the bar into the lower right corner of a view and return where it is.

    Parameters
    ----------
    painter, view
        Where.
    unit_per_pixel, unit
        The length of a pixel, and its unit.
    dark
        Whether the background is.
    """
    length = round_length(LONGEST * unit_per_pixel)
    if not length:
        return QRectF()
    pixels = length / unit_per_pixel
    end = QPointF(view.right() - MARGIN, view.bottom() - MARGIN)
    start = QPointF(end.x() - pixels, end.y())
    text = length_text(length, unit)
    metrics = QFontMetricsF(painter.font())
    width = max(pixels, metrics.horizontalAdvance(text)) + 2
    words = QRectF(end.x() - width, end.y() - 7 - metrics.height(), width, metrics.height())
    ticks = [QLineF(p, p - QPointF(0, 5)) for p in (start, end)]
    ink, _ = theme.inks(dark)
    edge = QColor(0, 0, 0, 190) if dark else QColor(255, 255, 255, 190)
    # An edge keeps it readable on a bone that reaches into the corner.
    for colour, thickness in ((edge, 4.5), (ink, 1.6)):
        painter.setPen(QPen(colour, thickness, Qt.PenStyle.SolidLine, Qt.PenCapStyle.SquareCap))
        painter.drawLines([QLineF(start, end), *ticks])
    painter.setPen(edge)
    for shift in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        painter.drawText(words.translated(*shift), Qt.AlignmentFlag.AlignCenter, text)
    painter.setPen(ink)
    painter.drawText(words, Qt.AlignmentFlag.AlignCenter, text)
    return QRectF(start, end).united(words)
