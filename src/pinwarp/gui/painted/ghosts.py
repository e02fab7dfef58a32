"""Where landmarks are expected, in discs as wide as the doubt."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, Qt
from qtpy.QtGui import QColor, QPainter, QPen

from pinwarp.core.landmarks import Position
from pinwarp.gui.painted.labels import Labels
from pinwarp.gui.painted.markers import FAINT, GHOST_RADIUS, draw_ghost
from pinwarp.gui.scene.drawables import OtherGhosts
from pinwarp.gui.scene.projection import Projection
from pinwarp.gui.style import theme
from pinwarp.session.warp.ghost import Ghost

# A disc is so many deviations wide: about three of four true places lie within it.
DOUBT = 2.0


class GhostPainter:
    """Paints ghosts onto a sheet.

    Parameters
    ----------
    projection
        Where places are.
    project
        Returns where (n, 3) positions are on the sheet.
    are_hidden
        Returns which positions the bone hides.
    labels
        Finds room for names.
    """

    def __init__(
        self,
        projection: Projection,
        project: Callable[[Sequence[Position]], NDArray[np.float64]],
        are_hidden: Callable[[Sequence[Position]], NDArray[np.bool_]],
        labels: Labels,
    ) -> None:
        self._projection = projection
        self._project = project
        self._are_hidden = are_hidden
        self._labels = labels

    def paint_next(self, painter: QPainter, ghost: Ghost) -> None:
        """Paint the next ghost, faintly behind the bone, and its name, which is always read."""
        ((x, y),), (hidden,) = self._project([ghost.position]), self._are_hidden([ghost.position])
        at = QPointF(x, y)
        painter.setOpacity(0.5 if hidden else 1.0)
        self._paint_doubt(painter, ghost, at, 0.22, edge=0.6)
        draw_ghost(painter, at, GHOST_RADIUS)
        painter.setOpacity(1.0)
        # Said, too: a ring may look faint for other reasons.
        words = f"{ghost.name}? (behind)" if hidden else f"{ghost.name}?"
        self._labels.draw(painter, words, at)

    def paint_others(self, painter: QPainter, others: OtherGhosts) -> None:
        """Paint smaller rings without names, in discs that leave the bone to be seen."""
        positions = [ghost.position for ghost in others.ghosts]
        places, hidden = self._project(positions).tolist(), self._are_hidden(positions).tolist()
        for ghost, place, out in zip(others.ghosts, places, hidden, strict=True):
            painter.setOpacity(FAINT if out else 1.0)
            self._paint_doubt(painter, ghost, QPointF(*place), 0.1)
        for ghost, place, out in zip(others.ghosts, places, hidden, strict=True):
            painter.setOpacity(FAINT if out else 1.0)
            draw_ghost(painter, QPointF(*place), GHOST_RADIUS - 3)
            if ghost.name == others.labelled:
                at = QPointF(*place)
                self._labels.draw(painter, f"{ghost.name}?", at)
        painter.setOpacity(1.0)

    def _paint_doubt(
        self, painter: QPainter, ghost: Ghost, at: QPointF, alpha: float, edge: float = 0.0
    ) -> None:
        """Paint a disc as wide as the doubt, with an edge as strong as is asked for."""
        if ghost.deviation is None:
            return
        radius = (
            DOUBT * ghost.deviation * self._projection.pixels_per_unit(np.array(ghost.position))
        )
        colour = QColor(theme.GHOST_COLOUR)
        colour.setAlphaF(alpha)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(colour)
        painter.drawEllipse(at, radius, radius)
        if edge:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            # Light around dark: one of them is seen on any background, the warp's blue too.
            light = QColor(theme.PAPER)
            for line, width, strength in ((light, 3.0, 0.6 * edge), (colour, 1.2, edge)):
                line.setAlphaF(strength)
                painter.setPen(QPen(line, width))
                painter.drawEllipse(at, radius, radius)
