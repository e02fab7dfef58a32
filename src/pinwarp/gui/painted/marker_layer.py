"""The landmarks, labels and hints of a viewport, painted by Qt over the rendered bones.

Painted flat rather than rendered: signs and text stay crisp and of one size at every zoom, and
look the same on every graphics driver. What lies behind the surface is painted faintly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, QRectF, Qt
from qtpy.QtGui import QColor, QFont, QPainter, QPaintEvent, QPen
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Position
from pinwarp.core.maps import Suggestion
from pinwarp.gui.painted.arrows import paint_arrow
from pinwarp.gui.painted.markers import (
    FAINT,
    HALO,
    RADIUS,
    STAR_RADIUS,
    draw_label,
    draw_label_below,
    draw_star,
    extent,
    marker_pixmap,
)
from pinwarp.gui.painted.scale_bar import paint_scale_bar
from pinwarp.gui.scene.scene import Arrow, Marker
from pinwarp.gui.style import theme
from pinwarp.session.warp.ghost import Ghost

if TYPE_CHECKING:
    from pinwarp.gui.views.canvas import Canvas


class MarkerLayer(QWidget):
    """A transparent sheet over one viewport; the mouse does not see it."""

    def __init__(self, canvas: Canvas, title: str) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self._title = title
        self.caption = ""
        self.hint = ""
        self.ghost: Ghost | None = None
        self._suggestion: Suggestion | None = None
        self.arrows: tuple[Arrow, ...] = ()
        self.unit = ""
        self.radius = RADIUS
        self.painted_for: object = None
        # For a picture: signs in so many pixels, places seen from its middle, with a frame or not.
        self.pixels_per_pixel = 1.0
        self.offset = (0.0, 0.0)
        self.framed = True
        self._markers: tuple[Marker, ...] = ()
        self._badge = ""
        # Which places the bone hides, as long as the camera stands still.
        self._hidden: dict[Position, bool] = {}
        self._hidden_for: object = None
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)

    @property
    def markers(self) -> tuple[Marker, ...]:
        """The landmarks on this sheet."""
        return self._markers

    def set_markers(self, markers: tuple[Marker, ...]) -> None:
        """Show other landmarks."""
        self._markers = markers
        self.update()

    @property
    def badge(self) -> str:
        """What is said on a plate in the corner."""
        return self._badge

    def show_badge(self, words: str) -> None:
        """Say that something unusual is shown; empty words take the plate away."""
        if words != self._badge:
            self._badge = words
            self.update()

    @property
    def suggestion(self) -> Suggestion | None:
        """The place that is marked for the next landmark."""
        return self._suggestion

    def show_suggestion(self, suggestion: Suggestion | None) -> None:
        """Mark where the next landmark helps most, or nothing."""
        if suggestion != self._suggestion:
            self._suggestion = suggestion
            self.update()

    def places(self) -> NDArray:
        """Return where the landmarks are on the screen: (n, 2) logical pixels."""
        if not self._markers:
            return np.zeros((0, 2))
        return self._project([marker.position for marker in self._markers])

    def _project(self, positions: Sequence[Position]) -> NDArray:
        return self._canvas.project(np.array(positions)) + self.offset

    def hidden(self) -> NDArray[np.bool_]:
        """Return which landmarks lie behind the surface as the camera stands now."""
        key = self._canvas.view_key()
        if key != self._hidden_for:
            self._hidden, self._hidden_for = {}, key
        new = [x.position for x in self._markers if x.position not in self._hidden]
        if new:
            found = self._canvas.behind_surface(np.array(new))
            self._hidden.update(zip(new, found.tolist(), strict=True))
        return np.array([self._hidden[x.position] for x in self._markers], dtype=bool)

    def nearest(self, at: QPointF, within: float) -> Marker | None:
        """Return the seen landmark nearest to a place on the screen, if any is near enough."""
        if not self._markers:
            return None
        distances = np.hypot(*(self.places() - [at.x(), at.y()]).T)
        distances[self.hidden()] = np.inf
        index = int(np.argmin(distances))
        # A large sign can be grabbed wherever it is seen.
        return self._markers[index] if distances[index] <= max(within, self.radius + 2) else None

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint title, scale bar, landmarks, labels and the hint of an empty viewport."""
        self.painted_for = self._canvas.view_key()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self.framed:
            self._paint_title(painter)
        if self.framed and self._canvas.bone is not None:
            length = self._canvas.unit_per_pixel
            paint_scale_bar(painter, QRectF(self.rect()), length, self.unit)
        if self.hint:
            self._paint_hint(painter)
        if self._suggestion is not None:
            self._paint_suggestion(painter, self._suggestion)
        if self.ghost is not None:
            self._paint_ghost(painter, self.ghost)
        places, hidden = self.places(), self.hidden()
        reached_from_right = self._paint_arrows(painter, hidden)
        self._paint_markers(painter, places, hidden, reached_from_right)
        if self._badge:
            self._paint_badge(painter)
        painter.end()

    def _paint_title(self, painter: QPainter) -> None:
        font = QFont(self.font())
        font.setWeight(QFont.Weight.DemiBold)
        painter.setFont(font)
        painter.setPen(QColor(theme.INK))
        margin = 12
        line = painter.fontMetrics().height()
        painter.drawText(QPointF(margin, margin + line * 0.8), self._title)
        painter.setFont(self.font())
        painter.setPen(QColor(theme.QUIET_INK))
        caption = painter.fontMetrics().elidedText(
            self.caption, Qt.TextElideMode.ElideMiddle, self.width() - 2 * margin
        )
        painter.drawText(QPointF(margin, margin + line * 1.9), caption)

    def _paint_hint(self, painter: QPainter) -> None:
        plate = QRectF(0, 0, min(340, self.width() - 24), 120)
        plate.moveCenter(QPointF(self.width() / 2, self.height() / 2))
        painter.setPen(QPen(QColor(theme.QUIET_INK), 1.5, Qt.PenStyle.DashLine))
        painter.setBrush(QColor(255, 255, 255, 120))
        painter.drawRoundedRect(plate, 10, 10)
        painter.setPen(QColor(theme.INK))
        painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, self.hint)

    def _paint_badge(self, painter: QPainter) -> None:
        metrics, margin = painter.fontMetrics(), 10
        words = metrics.elidedText(
            self._badge, Qt.TextElideMode.ElideRight, self.width() - 2 * margin - 20
        )
        plate = QRectF(0, margin, metrics.horizontalAdvance(words) + 20, metrics.height() + 8)
        plate.moveRight(self.width() - margin)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(theme.INK))
        painter.drawRoundedRect(plate, 6, 6)
        painter.setPen(QColor(theme.PAPER))
        painter.drawText(plate, Qt.AlignmentFlag.AlignCenter, words)

    def _paint_ghost(self, painter: QPainter, ghost: Ghost) -> None:
        """Paint a dashed ring where a landmark is expected, in a disc as wide as the doubt."""
        position = np.array(ghost.position)
        ((x, y),) = self._canvas.project(position[None])
        at = QPointF(x, y)
        colour = QColor(theme.GHOST_COLOUR)
        if ghost.deviation is not None:
            radius = ghost.deviation * self._canvas.pixels_per_unit(position)
            colour.setAlphaF(0.22)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(colour)
            painter.drawEllipse(at, radius, radius)
        for pen in (
            QPen(QColor(theme.PAPER), 3.5),
            QPen(QColor(theme.GHOST_COLOUR), 2, Qt.PenStyle.DotLine),
        ):
            painter.setPen(pen)
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(at, 8, 8)
        draw_label(painter, f"{ghost.name}?", at, self._room(at))

    def _paint_suggestion(self, painter: QPainter, suggestion: Suggestion) -> None:
        """Paint a star in a dotted ring where the next landmark helps most."""
        position = np.array([suggestion.position])
        ((x, y),) = self._canvas.project(position)
        at, hidden = QPointF(x, y), bool(self._canvas.behind_surface(position)[0])
        painter.setOpacity(0.5 if hidden else 1.0)
        draw_star(painter, at)
        words = f"next landmark helps most here (± {suggestion.deviation:.2g} {self.unit})"
        draw_label_below(painter, words, at, self._room(at), STAR_RADIUS)
        painter.setOpacity(1.0)

    def _room(self, at: QPointF) -> float:
        """Return how far right a label beside a place may reach."""
        legend = self._canvas.map_legend
        beside = legend.isVisible() and legend.y() - 14 < at.y() < legend.geometry().bottom() + 14
        return legend.x() if beside else self.width()

    def _paint_arrows(self, painter: QPainter, hidden: NDArray[np.bool_]) -> set[str]:
        """Paint the arrows; return which landmarks are reached from the right."""
        from_right: set[str] = set()
        if not self.arrows:
            return from_right
        selected = {marker.name for marker in self._markers if marker.selected}
        faint = {marker.name for marker, out in zip(self._markers, hidden, strict=True) if out}
        starts = self._project([arrow.start for arrow in self.arrows])
        ends = self._project([arrow.end for arrow in self.arrows])
        for arrow, start, end in zip(self.arrows, starts.tolist(), ends.tolist(), strict=True):
            chosen = arrow.name in selected
            # What is asked about is seen even behind the bone.
            painter.setOpacity(FAINT if arrow.name in faint and not chosen else 1.0)
            seen = paint_arrow(
                painter,
                QPointF(*start),
                QPointF(*end),
                self.radius + HALO * chosen,
                left_out=arrow.left_out,
            )
            if seen and start[0] > end[0]:
                from_right.add(arrow.name)
        painter.setOpacity(1.0)
        return from_right

    def _paint_markers(
        self,
        painter: QPainter,
        places: NDArray,
        hidden: NDArray[np.bool_],
        leftwards: set[str],
    ) -> None:
        ratio = self.devicePixelRatioF() * self.pixels_per_pixel
        # Hidden ones first, selected ones last, so that what matters lies on top.
        order = sorted(
            range(len(self._markers)),
            key=lambda i: (not hidden[i], self._markers[i].selected, self._markers[i].labelled),
        )
        for i in order:
            marker = self._markers[i]
            pixmap = marker_pixmap(
                marker.state, marker.selected, bool(hidden[i]), ratio, self.radius
            )
            x, y = places[i] - extent(self.radius) / 2
            painter.drawPixmap(QPointF(x, y), pixmap)
        for i in order:
            if self._markers[i].labelled:
                painter.setOpacity(0.5 if hidden[i] else 1.0)
                at = QPointF(*places[i])
                name = self._markers[i].name
                draw_label(
                    painter, name, at, self._room(at), self.radius, leftwards=name in leftwards
                )
        painter.setOpacity(1.0)
