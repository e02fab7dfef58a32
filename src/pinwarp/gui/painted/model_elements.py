"""What stands on a body of a model, as painted over the bones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, Qt
from qtpy.QtGui import QColor, QPainter, QPen, QPolygonF

from pinwarp.gui.painted.hidden import HiddenPlaces, runs
from pinwarp.gui.painted.markers import FAINT
from pinwarp.gui.scene.model_drawables import ElementLine, ModelElements
from pinwarp.gui.scene.projection import Projection
from pinwarp.gui.style import theme
from pinwarp.session.model.elements import OutlineKind

RADIUS = 2.8
# Colour, width and dashes of what a line is part of.
_LOOKS: dict[OutlineKind, tuple[str, float, list[float]]] = {
    OutlineKind.WRAP: (theme.WRAP_COLOUR, 1.0, []),
    OutlineKind.MUSCLE: (theme.MUSCLE_COLOUR, 1.8, []),
    OutlineKind.STUB: (theme.MUSCLE_COLOUR, 1.4, [3.0, 3.0]),
    OutlineKind.AXIS_X: (theme.AXIS_COLOURS[0], 2.2, []),
    OutlineKind.AXIS_Y: (theme.AXIS_COLOURS[1], 2.2, []),
    OutlineKind.AXIS_Z: (theme.AXIS_COLOURS[2], 2.2, []),
}
_WRAP_RIM = QColor(theme.PAPER)
_WRAP_RIM.setAlphaF(0.6)


class ModelPainter:
    """Paints muscles, points, wraps and frames; what the bone hides is faint.

    Parameters
    ----------
    projection
        Sees the bone.
    project
        Returns where (n, 3) positions are on the sheet.

    Attributes
    ----------
    is_resting : bool
        Whether the next paint may take its time to find out all that the bone hides.
    """

    def __init__(self, projection: Projection, project: Callable[[NDArray], NDArray]) -> None:
        self._project = project
        self.is_resting = False
        self._hidden = HiddenPlaces(projection)
        self._places: tuple[ModelElements | None, NDArray] = (None, np.zeros((0, 3)))

    @property
    def is_stale(self) -> bool:
        """Whether another paint would know better what is hidden."""
        return self._hidden.is_stale

    def paint(self, painter: QPainter, elements: ModelElements) -> None:
        """Paint all of it, what is chosen last."""
        places = self._places_of(elements)
        if not len(places):
            return
        hidden = self._hidden.of(places, exactly=self.is_resting)
        sizes = [len(elements.points), *(len(line.places) for line in elements.lines)]
        edges = np.cumsum(sizes)[:-1]
        points, *lines = np.split(self._project(places), edges)
        points_hidden, *lines_hidden = np.split(hidden, edges)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        order = list(_LOOKS)
        together = sorted(
            zip(elements.lines, lines, lines_hidden, strict=True),
            key=lambda one: (one[0].is_chosen, order.index(one[0].kind)),
        )
        for line, on_sheet, behind in together:
            for run, is_hidden in runs(on_sheet, behind):
                _paint_line(painter, line, run, is_hidden)
        for row in np.argsort(elements.is_chosen, kind="stable").tolist():
            _paint_point(
                painter,
                QPointF(*points[row]),
                bool(elements.is_of_muscle[row]),
                bool(elements.is_chosen[row]),
                bool(points_hidden[row]),
            )
        painter.setOpacity(1.0)

    def _places_of(self, elements: ModelElements) -> NDArray:
        known, places = self._places
        if known is not elements:
            places = np.concatenate([elements.points, *(line.places for line in elements.lines)])
            self._places = (elements, places)
        return places


def _paint_line(painter: QPainter, line: ElementLine, run: NDArray, is_hidden: bool) -> None:
    name, width, dashes = _LOOKS[line.kind]
    polygon = QPolygonF([QPointF(x, y) for x, y in run.tolist()])
    painter.setOpacity(FAINT if is_hidden and not line.is_chosen else 1.0)
    if line.is_chosen:
        painter.setPen(QPen(QColor(theme.SELECTED_COLOUR), width + 4.0))
        painter.drawPolyline(polygon)
    else:
        # A rim, so that it is seen before every background; wraps are many, theirs is faint.
        rim = _pen(theme.PAPER, width + 1.6, width, dashes)
        if line.kind is OutlineKind.WRAP:
            rim.setColor(_WRAP_RIM)
        painter.setPen(rim)
        painter.drawPolyline(polygon)
    painter.setPen(_pen(name, width + 0.6 * line.is_chosen, width, dashes))
    painter.drawPolyline(polygon)


def _pen(colour: str, width: float, usual: float, dashes: list[float]) -> QPen:
    """Return a pen whose dashes are as long as those of the usual width."""
    pen = QPen(QColor(colour), width)
    if dashes:
        pen.setDashPattern([dash * usual / width for dash in dashes])
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    return pen


def _paint_point(
    painter: QPainter, at: QPointF, of_muscle: bool, is_chosen: bool, is_hidden: bool
) -> None:
    """Paint a dot where a muscle runs through, a square for markers and stations."""
    painter.setOpacity(FAINT if is_hidden and not is_chosen else 1.0)
    if is_chosen:
        painter.setPen(QPen(QColor(theme.OUTLINE), 1.0))
        painter.setBrush(QColor(theme.SELECTED_COLOUR))
        painter.drawEllipse(at, RADIUS + 4, RADIUS + 4)
    painter.setPen(QPen(QColor(theme.PAPER), 1.0))
    painter.setBrush(QColor(theme.MUSCLE_COLOUR if of_muscle else theme.MODEL_MARKER_COLOUR))
    if of_muscle:
        painter.drawEllipse(at, RADIUS + 0.5, RADIUS + 0.5)
    else:
        corner = QPointF(RADIUS, RADIUS)
        painter.drawPolygon(
            QPolygonF(
                [
                    at - corner,
                    at + QPointF(RADIUS, -RADIUS),
                    at + corner,
                    at + QPointF(-RADIUS, RADIUS),
                ]
            )
        )
    painter.setBrush(Qt.BrushStyle.NoBrush)
