"""How a landmark's state looks: the same sign in the viewports and in the table."""

from __future__ import annotations

import functools
import math

from qtpy.QtCore import QLineF, QPointF, QRectF, Qt
from qtpy.QtGui import QBrush, QColor, QIcon, QPainter, QPen, QPixmap, QPolygonF

from pinwarp.core.landmarks import LandmarkState
from pinwarp.gui.style import theme

RADIUS = 6.0
STAR_RADIUS = 11.0
GHOST_RADIUS = 8.0
# By how much the ring around a selected one is wider.
HALO = 5.0
# How much is seen of what lies behind the surface.
FAINT = 0.3


def extent(radius: float) -> float:
    """Return the width of a sign's picture: room for the halo around it."""
    return 2 * (radius + 7)


@functools.lru_cache(maxsize=256)
def marker_pixmap(
    state: LandmarkState, selected: bool, hidden: bool, ratio: float, radius: float = RADIUS
) -> QPixmap:
    """Return the picture of a landmark, :func:`extent` logical pixels wide.

    Paired is a filled disc, one that is only suggested a disc filled by half, half-placed a hollow
    ring, a passenger a diamond, a disabled one a grey disc with a bar. Behind the surface all are
    faint.
    """
    width = extent(radius)
    pixmap = QPixmap(round(width * ratio), round(width * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    with QPainter(pixmap) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setOpacity(FAINT if hidden else 1.0)
        centre = QPointF(width / 2, width / 2)
        if selected:
            painter.setPen(QPen(QColor(theme.OUTLINE), 1.0))
            painter.setBrush(QColor(theme.SELECTED_COLOUR))
            painter.drawEllipse(centre, radius + HALO, radius + HALO)
        colour = QColor(theme.STATE_COLOURS[state])
        outline = QPen(QColor(theme.OUTLINE), 1.2)
        match state:
            case LandmarkState.SOURCE_ONLY | LandmarkState.DESTINATION_ONLY | LandmarkState.EMPTY:
                painter.setPen(QPen(QColor(theme.OUTLINE), 5.0))
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.drawEllipse(centre, radius, radius)
                painter.setPen(QPen(colour, 2.8))
                painter.drawEllipse(centre, radius, radius)
            case LandmarkState.SUGGESTED:
                painter.setPen(outline)
                painter.setBrush(QColor(theme.PAPER))
                painter.drawEllipse(centre, radius, radius)
                painter.setBrush(QBrush(colour))
                circle = QRectF(centre.x() - radius, centre.y() - radius, 2 * radius, 2 * radius)
                # Its lower half; Qt counts in sixteenths of a degree, from three o'clock.
                painter.drawChord(circle, 180 * 16, 180 * 16)
            case LandmarkState.PASSENGER:
                painter.setPen(outline)
                painter.setBrush(QBrush(colour))
                r = radius + 1
                painter.drawPolygon(
                    QPolygonF([centre + QPointF(*d) for d in ((0, -r), (r, 0), (0, r), (-r, 0))])
                )
            case _:
                painter.setPen(outline)
                painter.setBrush(QBrush(colour))
                painter.drawEllipse(centre, radius, radius)
                if state is LandmarkState.DISABLED:
                    painter.setPen(QPen(QColor(theme.PAPER), 2))
                    bar = QPointF(radius / 2, -radius / 2)
                    painter.drawLine(centre - bar, centre + bar)
    return pixmap


@functools.lru_cache(maxsize=16)
def state_icon(state: LandmarkState) -> QIcon:
    """Return the sign of a state as an icon for lists."""
    pixmap = marker_pixmap(state, selected=False, hidden=False, ratio=2.0)
    icon = QIcon(pixmap)
    # Else Qt tints it in a selected row.
    icon.addPixmap(pixmap, QIcon.Mode.Selected)
    return icon


def draw_ghost(painter: QPainter, at: QPointF, radius: float) -> None:
    """Draw a dotted ring: a place that asks for a landmark."""
    for pen in (
        QPen(QColor(theme.PAPER), 4),
        QPen(QColor(theme.GHOST_COLOUR), 2, Qt.PenStyle.DotLine),
    ):
        painter.setPen(pen)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(at, radius, radius)


def draw_star(painter: QPainter, at: QPointF) -> None:
    """Draw a star in a dotted ring: a place that asks for a landmark."""
    angles = [math.pi * (i / 5 - 0.5) for i in range(10)]
    lengths = (7.0, 3.0) * 5
    star = QPolygonF(
        [
            at + QPointF(length * math.cos(angle), length * math.sin(angle))
            for angle, length in zip(angles, lengths, strict=True)
        ]
    )
    draw_ghost(painter, at, STAR_RADIUS)
    painter.setPen(QPen(QColor(theme.PAPER), 1.2))
    painter.setBrush(QColor(theme.GHOST_COLOUR))
    painter.drawPolygon(star)


def draw_crosshair(painter: QPainter, at: QPointF) -> None:
    """Draw the crosshair that the arrow keys move, dark within light: seen on anything."""
    inner, outer = 4.0, 16.0
    lines = [
        QLineF(at + QPointF(x * inner, y * inner), at + QPointF(x * outer, y * outer))
        for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
    ]
    for colour, width in ((theme.PAPER, 5.0), (theme.OUTLINE, 2.0)):
        painter.setPen(QPen(QColor(colour), width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
        painter.drawLines(lines)
