"""The figures over the penalty, drawn above the slider on the slider's own axis.

Painted by hand: every place comes from the slider's handle, which no plotting library knows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from qtpy.QtCore import QEvent, QLineF, QMarginsF, QPoint, QPointF, QRectF, QSize, Qt, Signal
from qtpy.QtGui import (
    QColor,
    QFont,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QPixmap,
    QPolygonF,
)
from qtpy.QtWidgets import QSizePolicy, QWidget

from pinwarp.core.factor import SourceFactor
from pinwarp.core.lengths import Ruler
from pinwarp.core.quality import PenaltyCurve
from pinwarp.gui.penalty.slider import PenaltySlider
from pinwarp.gui.style import theme
from pinwarp.gui.style.lengths import ticks

# How near to the suggestion's sign a click takes it, and half of its width.
REACH = 7
DIAMOND = 5.0
HEIGHT = 88


@dataclass(frozen=True, eq=False)
class Plotted:
    """What is drawn.

    Attributes
    ----------
    curve, factor
        The figures, and the source landmarks that give a place on the axis its penalty.
    ruler, on_destination
        How lengths on the source, such as the penalty, and on the destination are told.
    suggests
        Whether the suggestion may be taken.
    title
        Quiet words above the curves.
    """

    curve: PenaltyCurve
    factor: SourceFactor
    ruler: Ruler
    on_destination: Ruler
    suggests: bool
    title: str

    @property
    def looks(self) -> tuple[object, ...]:
        """All that axis and curves depend on: the same figures come anew while one slides."""
        curve = self.curve
        return (
            curve.leave_one_out.tobytes(),
            curve.residual.tobytes(),
            self.ruler,
            self.on_destination,
        )

    @cached_property
    def top(self) -> float:
        """The largest length on the vertical axis."""
        lines = np.concatenate([self.curve.leave_one_out, self.curve.residual])
        largest = float(np.nanmax(lines))
        return 1.12 * largest if largest > 0 and not self.curve.is_affine else 1.0

    def reading(self, share: float) -> str:
        """Return the figures at a share of the axis, in words."""
        left_out, residual = self.curve.at(1.0 - share)
        penalty = self.factor.penalty_at(1.0 - share)
        of_penalty = self.ruler.to_the(self.factor.basis.power)
        words = [
            "affine fit" if math.isinf(penalty) else f"penalty {of_penalty.text(penalty, 3)}",
            f"flexibility {1 - share:.0%}",
        ]
        if math.isfinite(left_out):
            words.append(f"leave-one-out {self.on_destination.text(left_out, 3)}")
        words.append(f"residual {self.on_destination.text(residual, 3)}")
        return "   ".join(words)


class PenaltyPlot(QWidget):
    """Leave-one-out error and residual over the penalty; a click asks for the penalty there.

    Parameters
    ----------
    slider
        Whose axis it shares; both are to be in the same parent.
    """

    penalty_requested = Signal(float)

    def __init__(self, slider: PenaltySlider, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._slider = slider
        self._plotted: Plotted | None = None
        self._hint = ""
        self._present: float | None = None
        self._present_figures: tuple[float, float] | None = None
        self._hovered: float | None = None
        self._picture = QPixmap()
        self._picture_for: object = None
        self.setAccessibleName("Leave-one-out error and residual over the warping penalty")
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumHeight(HEIGHT)

    def sizeHint(self) -> QSize:
        """Take no more height than needed; the bones are the picture."""
        return QSize(320, HEIGHT)

    @property
    def plotted(self) -> Plotted | None:
        """What is drawn now."""
        return self._plotted

    def show_curve(self, plotted: Plotted | None, hint: str = "") -> None:
        """Draw other figures, or say in words why there are none."""
        self._plotted, self._hint = plotted, hint
        self.setCursor(Qt.CursorShape.PointingHandCursor if plotted else Qt.CursorShape.ArrowCursor)
        self.update()

    def show_present(self, share: float | None, figures: tuple[float, float] | None) -> None:
        """Mark the present penalty, with its leave-one-out error and residual if they apply."""
        self._present, self._present_figures = share, figures
        self.update()

    # Geometry

    @property
    def _line(self) -> int:
        return self.fontMetrics().height()

    @property
    def _shift(self) -> int:
        parent = self.parentWidget()
        return self._slider.mapTo(parent, QPoint(0, 0)).x() - self.x()

    def place_of(self, share: float) -> float:
        """Return where a share of the axis is: right above the handle's centre there."""
        return self._slider.place_of(share) + self._shift

    def share_at(self, x: float) -> float:
        """Return which share of the axis is at x."""
        return self._slider.share_at(x - self._shift)

    @property
    def _area(self) -> QRectF:
        """Where the curves are."""
        top = self._line + 2
        left, right = self.place_of(0.0), self.place_of(1.0)
        return QRectF(left, top, right - left, self.height() - top - 5)

    def _level(self, length: float) -> float:
        area = self._area
        assert self._plotted is not None, "lengths have a place only on a curve"
        return area.bottom() - length / self._plotted.top * area.height()

    def suggested_place(self) -> QPointF | None:
        """Return where the suggestion's sign is, None without one."""
        plotted = self._plotted
        if plotted is None or plotted.curve.suggested is None:
            return None
        flexibility = plotted.factor.flexibility(plotted.curve.suggested)
        left_out, _ = plotted.curve.at(flexibility)
        return QPointF(self.place_of(1.0 - flexibility), self._level(left_out))

    # The mouse

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Tell the figures at the mouse."""
        self._hovered = self.share_at(event.position().x()) if self._plotted else None
        self.update()

    def leaveEvent(self, _event: QEvent) -> None:
        """Nothing is hovered any more."""
        self._hovered = None
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Ask for the penalty at the mouse: the suggested one, where it was aimed at."""
        plotted = self._plotted
        if plotted is None or event.button() != Qt.MouseButton.LeftButton:
            return
        at, sign = event.position(), self.suggested_place()
        suggested = plotted.curve.suggested if plotted.suggests else None
        if suggested is not None and sign is not None and _near(at, sign):
            self.penalty_requested.emit(suggested)
            return
        self.penalty_requested.emit(plotted.factor.penalty_at(1.0 - self.share_at(at.x())))

    # Painting

    def _paint_hint(self, painter: QPainter, area: QRectF) -> None:
        """Write why there is no curve, where axes would stand if it needs the room."""
        border = QMarginsF(12, 0, 12, 0)
        needed = painter.boundingRect(area - border, _CENTRED, self._hint)
        if needed.height() > area.height():
            area = QRectF(0, 0, self.width(), self.height())
        painter.fillRect(area, self.palette().color(QPalette.ColorRole.Base))
        painter.setPen(self._quiet)
        painter.drawText(area - border, _CENTRED, self._hint)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint axis, curves, the present penalty, the suggestion and what is hovered."""
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            area = self._area
            if self._plotted is None:
                self._paint_hint(painter, area)
            else:
                painter.drawPixmap(0, 0, self._resting_picture(area, self._plotted))
                self._paint_present(painter, area)
                self._paint_suggestion(painter)
                self._paint_title(painter, area, self._plotted)

    def _resting_picture(self, area: QRectF, plotted: Plotted) -> QPixmap:
        """Return axis and curves, drawn once: the slider moves over them at every frame."""
        ratio, palette = self.devicePixelRatioF(), self.palette()
        key = (plotted.looks, area, self.size(), ratio, palette.cacheKey(), self.font().key())
        if key != self._picture_for:
            self._picture_for = key
            self._picture = QPixmap(self.size() * ratio)
            self._picture.setDevicePixelRatio(ratio)
            self._picture.fill(Qt.GlobalColor.transparent)
            with QPainter(self._picture) as painter:
                painter.setRenderHint(QPainter.RenderHint.Antialiasing)
                painter.setFont(self.font())
                painter.fillRect(area, palette.color(QPalette.ColorRole.Base))
                self._paint_axis(painter, area, plotted)
                self._paint_curves(painter, area, plotted)
        return self._picture

    @property
    def _quiet(self) -> QColor:
        return theme.quiet_text_colour()

    def _paint_axis(self, painter: QPainter, area: QRectF, plotted: Plotted) -> None:
        line = self._line
        faint = QColor(self._quiet)
        faint.setAlphaF(0.25)
        ruler = plotted.on_destination
        lengths = [ruler.stored(shown) for shown in ticks(ruler.factor * plotted.top)]
        for length in lengths if not plotted.curve.is_affine else (0.0,):
            y = round(self._level(length)) + 0.5
            painter.setPen(QPen(faint, 1))
            painter.drawLine(QLineF(area.left(), y, area.right(), y))
            last = length == lengths[-1]
            text = f"{ruler.factor * length:.12g}" + (f" {ruler.unit}" if last else "")
            painter.setPen(self._quiet)
            words = QRectF(0, y - line / 2 - 1, area.left() - 6, line)
            painter.drawText(words, Qt.AlignmentFlag.AlignRight, text)

    def _paint_curves(self, painter: QPainter, area: QRectF, plotted: Plotted) -> None:
        curve = plotted.curve
        lines = [
            (curve.residual, theme.residual_colour(), "Residual"),
            (curve.leave_one_out, theme.leave_one_out_colour(), "Leave-one-out"),
        ]
        # All at once: each place by itself would ask the slider for its handle.
        places = area.left() + (1.0 - curve.flexibility) * area.width()
        heights = [area.bottom() - x / plotted.top * area.height() for x, _, _ in lines]
        ends = [float(levels[-1]) for levels in heights]
        # The words at the ends keep out of each other's way; the residual is never the larger.
        height = self._line
        ends[1] = max(ends[1], area.top() + height / 2 - 4)
        ends[0] = min(max(ends[0], ends[1] + height), area.bottom() - height / 2 + 4)
        ends[1] = min(ends[1], ends[0] - height)
        for levels, (_, colour, words), end in zip(heights, lines, ends, strict=True):
            if not np.isfinite(levels).all():
                continue
            painter.setPen(QPen(colour, 1.8))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            spots = np.column_stack((places, levels)).tolist()
            painter.drawPolyline(QPolygonF([QPointF(x, y) for x, y in spots]))
            painter.drawText(QPointF(area.right() + 8, end + height * 0.3), words)

    def _paint_present(self, painter: QPainter, area: QRectF) -> None:
        if self._present is None:
            return
        # On a whole pixel, for a crisp line.
        x = math.floor(self.place_of(self._present)) + 0.5
        painter.setPen(QPen(theme.text_colour(), 1))
        painter.drawLine(QLineF(x, area.top(), x, self.height()))
        if self._present_figures is None:
            return
        shown = [
            (value, colour)
            for value, colour in zip(
                self._present_figures,
                (theme.leave_one_out_colour(), theme.residual_colour()),
                strict=True,
            )
            if math.isfinite(value)
        ]
        told = self._plotted.on_destination if self._plotted is not None else Ruler()
        height = self._line
        lowest = area.bottom() - height * (len(shown) - 0.5)
        highest = area.top() + height / 2
        # One figure above its curve, the other below: both rise towards the affine fit.
        for aside, (value, colour) in zip((-0.6, 0.6), shown, strict=False):
            level = self._level(value)
            painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Base), 1.5))
            painter.setBrush(colour)
            painter.drawEllipse(QPointF(x, level), 4, 4)
            middle = min(max(level + aside * height, highest), lowest)
            self._paint_figure(painter, told.number(value, 3), colour, QPointF(x, middle))
            # The residual, which is never the larger, stands below.
            highest, lowest = middle + height, lowest + height

    def _paint_figure(self, painter: QPainter, text: str, colour: QColor, at: QPointF) -> None:
        """Write a figure beside the line of the present penalty, on paper."""
        bold = QFont(self.font())
        bold.setWeight(QFont.Weight.DemiBold)
        painter.setFont(bold)
        width, height = painter.fontMetrics().horizontalAdvance(text) + 6, 0.9 * self._line
        left = at.x() + 7
        if left + width > self.place_of(1.0):
            left = at.x() - 7 - width
        plate = QRectF(left, at.y() - height / 2, width, height)
        paper = self.palette().color(QPalette.ColorRole.Base)
        paper.setAlphaF(0.85)
        painter.fillRect(plate, paper)
        painter.setPen(colour)
        painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, text)
        painter.setFont(self.font())

    def _paint_suggestion(self, painter: QPainter) -> None:
        at = self.suggested_place()
        if at is None:
            return
        painter.setPen(QPen(self.palette().color(QPalette.ColorRole.Base), 1.5))
        painter.setBrush(theme.leave_one_out_colour())
        r = DIAMOND + 1
        painter.drawPolygon(
            QPolygonF([at + QPointF(*d) for d in ((0, -r), (r, 0), (0, r), (-r, 0))])
        )

    def _paint_title(self, painter: QPainter, area: QRectF, plotted: Plotted) -> None:
        words = plotted.title
        painter.setPen(self._quiet)
        if self._hovered is not None:
            x = self.place_of(self._hovered)
            painter.setPen(QPen(self._quiet, 1, Qt.PenStyle.DashLine))
            painter.drawLine(QLineF(x, area.top(), x, area.bottom()))
            words = plotted.reading(self._hovered)
            painter.setPen(theme.text_colour())
        height = self._line
        width = painter.fontMetrics().horizontalAdvance(words)
        # A long reading may begin left of the curves, where nothing else is.
        left = max(0.0, min(area.left(), self.width() - width - 4.0))
        painter.drawText(QRectF(left, 0, self.width() - left, height), 0, words)


_CENTRED = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap


def _near(a: QPointF, b: QPointF) -> bool:
    return math.hypot(a.x() - b.x(), a.y() - b.y()) <= REACH
