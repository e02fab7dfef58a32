"""Arrows from where landmarks are carried to where they belong."""

from __future__ import annotations

import math

from qtpy.QtCore import QPointF, Qt
from qtpy.QtGui import QColor, QPainter, QPen, QPolygonF

from pinwarp.gui.style import theme

# Shorter ones than this are not seen beside a landmark's sign, in logical pixels.
SHORTEST = 3.0
_HEAD = 8.0


def paint_arrow(
    painter: QPainter, start: QPointF, end: QPointF, gap: float, *, left_out: bool = False
) -> bool:
    """Paint a thin arrow with a light rim, so that it is seen on every bone.

    Parameters
    ----------
    painter
        Paints.
    start, end
        Where it begins and points to, in logical pixels.
    gap
        How far before its end it stops: the radius of the sign that stands there.
    left_out
        Whether it begins where the other pairs expect the landmark: dashed, from a ring.

    Returns
    -------
    bool
        False where it was too short to be seen.
    """
    along = end - start
    length = math.hypot(along.x(), along.y())
    if length < gap + SHORTEST:
        return False
    direction = along / length
    across = QPointF(-direction.y(), direction.x())
    tip = end - direction * gap
    head = min(_HEAD, max(length - gap, 2 * SHORTEST))
    neck = tip - direction * head
    triangle = QPolygonF([tip, neck + across * head * 0.4, neck - across * head * 0.4])
    colour = QColor(theme.LEFT_OUT_COLOUR if left_out else theme.ARROW_COLOUR)
    line = Qt.PenStyle.CustomDashLine if left_out else Qt.PenStyle.SolidLine
    for ink, width, style in (
        (QColor(theme.PAPER), 3.6, Qt.PenStyle.SolidLine),
        (colour, 1.7, line),
    ):
        pen = QPen(ink, width, style, Qt.PenCapStyle.FlatCap, Qt.PenJoinStyle.RoundJoin)
        if style == Qt.PenStyle.CustomDashLine:
            pen.setDashPattern([3, 2])
        painter.setPen(pen)
        painter.drawLine(start, neck)
        painter.setPen(QPen(ink, width - 1.2, Qt.PenStyle.SolidLine))
        painter.setBrush(colour)
        painter.drawPolygon(triangle)
        radius = 3.5 if left_out else 1.5
        painter.drawEllipse(start, radius, radius)
    return True
