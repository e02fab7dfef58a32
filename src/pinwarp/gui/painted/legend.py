"""The legend of a map: colours and values, painted crisply over a viewport."""

from __future__ import annotations

from qtpy.QtCore import QPointF, QRectF, QSize, Qt, Signal
from qtpy.QtGui import (
    QColor,
    QFont,
    QFontMetricsF,
    QImage,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPolygonF,
)
from qtpy.QtWidgets import QWidget

from pinwarp.gui.scene.drawables import Legend
from pinwarp.gui.style import theme
from pinwarp.gui.style.colour_scale import ColourScale

# In logical pixels: the bar, the room around everything, and between bar and numbers.
BAR_WIDTH = 14
BAR_HEIGHT = 190
LEAST_BAR = 60
PADDING = 8
GAP = 8
TIP = 9
MARGIN = 10
TITLE_WIDTH = 108


class PaintedLegend(QWidget):
    """Stands in the upper right corner of its viewport; a click asks to fix its range, or not."""

    clicked = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.content: Legend | None = None
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.hide()

    def show_content(self, content: Legend | None) -> None:
        """Show the legend of a map, or none."""
        if content == self.content:
            return
        self.content = content
        if content is not None:
            self.setAccessibleName(f"Legend: {content.title}")
            self.setToolTip(
                "The range is fixed: click to let it follow the map"
                if content.fixed
                else "The range follows the map: click to fix it, so that maps can be compared"
            )
        self.place()
        self.update()

    def place(self) -> None:
        """Stand below the viewport's title and above its scale bar, where there is room."""
        view, line = self.parentWidget().rect(), self.fontMetrics().height()
        top = round(12 + 2.4 * line)
        room = view.height() - top - 3 * line
        size = self._size(room)
        self.setGeometry(view.right() - size.width() - MARGIN, top, size.width(), size.height())
        enough = self._bar_height(room) >= LEAST_BAR and view.width() > 2.5 * size.width()
        self.setVisible(self.content is not None and enough)

    @property
    def has_room(self) -> bool:
        """Whether there is a legend, and room enough for it."""
        return self.isVisibleTo(self.parentWidget())

    def _title_font(self) -> QFont:
        font = QFont(self.font())
        font.setWeight(QFont.Weight.DemiBold)
        return font

    def _title_height(self) -> float:
        if self.content is None:
            return 0.0
        height = self._words_height(self.content.title, self._title_font())
        return height + self._words_height(self.content.note, self.font()) + GAP

    def _words_height(self, text: str, font: QFont) -> float:
        if not text:
            return 0.0
        box = QRectF(0, 0, TITLE_WIDTH, 1000)
        return QFontMetricsF(font).boundingRect(box, Qt.TextFlag.TextWordWrap, text).height()

    def _bar_height(self, room: float) -> float:
        return min(BAR_HEIGHT, room - self._title_height() - 2 * PADDING - 2 * TIP)

    def _size(self, room: float) -> QSize:
        bar = max(LEAST_BAR, self._bar_height(room))
        height = self._title_height() + bar + 2 * PADDING + 2 * TIP
        return QSize(TITLE_WIDTH + 2 * PADDING, round(height))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Keep the press from the viewport below."""
        event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Tell a click."""
        if event.button() == Qt.MouseButton.LeftButton and self.rect().contains(event.pos()):
            self.clicked.emit()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint plate, title, bar and values."""
        content = self.content
        if content is None:
            return
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            paper = QColor(theme.PAPER)
            paper.setAlphaF(0.88)
            painter.setPen(QPen(QColor(0, 0, 0, 40), 1))
            painter.setBrush(paper)
            plate = QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5)
            painter.drawRoundedRect(plate, 6, 6)
            top = self._paint_title(painter, content)
            bar = QRectF(PADDING + 1, top + TIP, BAR_WIDTH, self.height() - top - 2 * TIP - PADDING)
            self._paint_bar(painter, content, bar)
            self._paint_values(painter, content, bar)
            if content.fixed:
                _paint_lock(painter, QPointF(self.width() - PADDING - 6, bar.top() + 2))

    def _paint_title(self, painter: QPainter, content: Legend) -> float:
        top = float(PADDING)
        for text, font, colour in (
            (content.title, self._title_font(), theme.INK),
            (content.note, self.font(), theme.QUIET_INK),
        ):
            height = self._words_height(text, font)
            painter.setFont(font)
            painter.setPen(QColor(colour))
            painter.drawText(
                QRectF(PADDING, top, TITLE_WIDTH, height), Qt.TextFlag.TextWordWrap, text
            )
            top += height
        return top + GAP / 2

    def _paint_bar(self, painter: QPainter, content: Legend, bar: QRectF) -> None:
        scale = ColourScale(content.kind, content.range, content.factor)
        low, high = scale.ends
        rows = 256
        levels = [high - (high - low) * (row + 0.5) / rows for row in range(rows)]
        colours = scale.colours(levels)
        # Kept while it is painted: the image only points at it.
        pixels = colours.tobytes()
        image = QImage(pixels, 1, rows, 3, QImage.Format.Format_RGB888)
        painter.drawImage(bar, image)
        outline = [bar.topLeft(), bar.topRight(), bar.bottomRight(), bar.bottomLeft()]
        below, above = content.clipped
        middle = bar.center().x()
        for clipped, colour, corners, tip in (
            (below, colours[-1], outline[2:], QPointF(middle, bar.bottom() + TIP)),
            (above, colours[0], outline[:2], QPointF(middle, bar.top() - TIP)),
        ):
            if clipped:
                # What lies beyond the end has the end's colour: an arrow says that it goes on.
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(QColor(*(int(part) for part in colour)))
                painter.drawPolygon(QPolygonF([*corners, tip]))
        if above:
            outline.insert(1, QPointF(middle, bar.top() - TIP))
        if below:
            outline.insert(-1, QPointF(middle, bar.bottom() + TIP))
        painter.setPen(QPen(QColor(theme.OUTLINE), 1))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPolygon(QPolygonF(outline))

    def _paint_values(self, painter: QPainter, content: Legend, bar: QRectF) -> None:
        painter.setFont(self.font())
        painter.setPen(QPen(QColor(theme.INK), 1))
        line = painter.fontMetrics().height()
        for tick in ColourScale(content.kind, content.range, content.factor).ticks():
            y = bar.bottom() - tick.share * bar.height()
            painter.drawLine(QPointF(bar.right(), y), QPointF(bar.right() + 4, y))
            box = QRectF(bar.right() + GAP, y - line / 2, self.width(), line)
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, tick.text)


def _paint_lock(painter: QPainter, at: QPointF) -> None:
    """Paint a small padlock about a place."""
    painter.setPen(QPen(QColor(theme.INK), 1.5))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.drawArc(QRectF(at.x() - 3, at.y() - 6, 6, 8), 0, 180 * 16)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.setBrush(QColor(theme.INK))
    painter.drawRoundedRect(QRectF(at.x() - 4.5, at.y() - 2, 9, 7), 1.5, 1.5)
