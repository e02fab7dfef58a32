"""A small histogram of a map, drawn over its legend's colours."""

from __future__ import annotations

import numpy as np
from qtpy.QtCore import QPointF, QRectF, QSize, Qt
from qtpy.QtGui import QColor, QPainter, QPaintEvent, QPalette, QPen, QPolygonF
from qtpy.QtWidgets import QSizePolicy, QWidget

from pinwarp.core.maps import Histogram, SurfaceMap
from pinwarp.gui.style import theme
from pinwarp.gui.style.colour_scale import ColourScale

_MARGIN = 8


class HistogramView(QWidget):
    """Bars in the colours of the map; a second sample as a line over them."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._map: SurfaceMap | None = None
        self._scale: ColourScale | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAccessibleName("How often each value occurs")

    def show_map(self, found: SurfaceMap | None, scale: ColourScale | None) -> None:
        """Show how often each value of a map occurs."""
        self._map, self._scale = found, scale
        self.update()

    def sizeHint(self) -> QSize:
        """Return a height that shows the shape of a distribution."""
        return QSize(240, 110 + self.fontMetrics().height())

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint bars, line and values."""
        if self._map is None or self._scale is None:
            return
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            line = self.fontMetrics().height()
            area = QRectF(self.rect()).adjusted(_MARGIN, 4, -_MARGIN, -line - 8)
            histograms = self._map.histograms
            most = max(float(histogram.shares.max()) for histogram in histograms)
            self._paint_bars(painter, area, histograms[0], most)
            for other in histograms[1:]:
                self._paint_line(painter, area, other, most)
            ink = self.palette().color(QPalette.ColorRole.WindowText)
            painter.setPen(QPen(ink, 1))
            painter.drawLine(area.bottomLeft(), area.bottomRight())
            self._paint_values(painter, area)

    def _paint_bars(
        self, painter: QPainter, area: QRectF, histogram: Histogram, most: float
    ) -> None:
        assert self._scale is not None
        middles = (histogram.edges[1:] + histogram.edges[:-1]) / 2
        colours = self._scale.colours(middles)
        # A hairline of the window's text around them: the ends of a scale may be as pale as paper.
        rim = self.palette().color(QPalette.ColorRole.WindowText)
        rim.setAlphaF(0.35)
        painter.setPen(QPen(rim, 0.5))
        width = area.width() / len(middles)
        for row, (share, colour) in enumerate(zip(histogram.shares, colours, strict=True)):
            height = area.height() * float(share) / most
            if height > 0:
                painter.setBrush(QColor(*colour.tolist()))
                left = area.left() + row * width
                painter.drawRect(QRectF(left, area.bottom() - height, width, height))

    def _paint_line(
        self, painter: QPainter, area: QRectF, histogram: Histogram, most: float
    ) -> None:
        lefts = np.linspace(area.left(), area.right(), len(histogram.shares) + 1)
        heights = area.bottom() - area.height() * histogram.shares / most
        corners = [
            QPointF(x, y)
            for left, right, y in zip(lefts[:-1], lefts[1:], heights, strict=True)
            for x in (left, right)
        ]
        painter.setPen(QPen(QColor(theme.WARNING_COLOUR), 1.6))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolyline(QPolygonF(corners))

    def _paint_values(self, painter: QPainter, area: QRectF) -> None:
        assert self._map is not None
        edges, kind = self._map.histograms[0].edges, self._map.kind
        low, high = float(edges[0]), float(edges[-1])
        ends = (2.0**low, 2.0**high) if kind.is_ratio else (low, high)
        metrics, taken = self.fontMetrics(), -1e9
        factor = self._scale.factor if self._scale is not None else 1.0
        for tick in ColourScale(kind, ends, factor).ticks():
            x = area.left() + tick.share * area.width()
            width = metrics.horizontalAdvance(tick.text)
            left = min(max(x - width / 2, 0.0), self.width() - width)
            painter.drawLine(QPointF(x, area.bottom()), QPointF(x, area.bottom() + 4))
            if left > taken + 6:
                painter.drawText(QPointF(left, area.bottom() + 5 + metrics.ascent()), tick.text)
                taken = left + width
