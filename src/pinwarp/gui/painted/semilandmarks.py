"""Semilandmarks as painted over the bones: dots, the curves they are on, handles, slides."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, QRectF, Qt
from qtpy.QtGui import QColor, QPainter, QPen, QPixmap, QPolygonF

from pinwarp.gui.painted.hidden import HiddenPlaces, runs
from pinwarp.gui.painted.markers import FAINT
from pinwarp.gui.scene.drawables import CurveHandle, DotKind, Dots, Handles, Paths, Slides
from pinwarp.gui.scene.projection import Projection
from pinwarp.gui.style import theme

DOT_RADIUS = 2.2
HANDLE_RADIUS = 4.5
# Along a curve every so many places it is asked whether the bone hides it.
_STEP = 4
# Slides shorter than this are not seen, in logical pixels.
_SHORTEST = 3.0
_DASHES = [4.0, 3.0]
# A line is drawn through places that are so far apart, in logical pixels.
_SMOOTH = 4.0


class SemilandmarkPainter:
    """Paints what a scene holds of semilandmarks.

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
        self._hidden_dots = HiddenPlaces(projection)
        self._hidden_paths = HiddenPlaces(projection)
        self._hidden_handles = HiddenPlaces(projection)
        nowhere = np.zeros((0, 3))
        self._path_places: tuple[Paths | None, NDArray, NDArray] = (None, nowhere, nowhere)
        self._handle_places: tuple[Handles | None, NDArray] = (None, nowhere)

    @property
    def is_stale(self) -> bool:
        """Whether another paint would know better what is hidden."""
        return self._hidden_dots.is_stale or self._hidden_paths.is_stale

    # Dots

    def hidden_dots(self, dots: Dots) -> NDArray[np.bool_]:
        """Return which dots the bone hides."""
        return self._hidden_dots.of(dots.positions, exactly=True)

    def paint_dots(self, painter: QPainter, dots: Dots, ratio: float) -> None:
        """Paint a dot for each semilandmark: hollow where it was freed, faint behind the bone."""
        if not len(dots.positions):
            return
        hidden = self._hidden_dots.of(dots.positions, exactly=self.is_resting)
        places = self._project(dots.positions)
        device = painter.device()
        seen = ((places >= -9) & (places <= [device.width() + 9, device.height() + 9])).all(axis=1)
        # Those behind the bone first, what is chosen last.
        looks = np.column_stack([~hidden, dots.kinds, dots.colours % len(theme.GROUP_COLOURS)])
        rows = np.flatnonzero(seen)
        order = rows[np.lexsort(looks[rows].T[::-1])]
        edges = np.flatnonzero((np.diff(looks[order], axis=0) != 0).any(axis=1)) + 1
        draw, half = painter.drawPixmap, _dot_extent() / 2
        for run in np.split(order, edges):
            if not len(run):
                continue
            is_seen, kind, colour = looks[run[0]].tolist()
            pixmap = dot_pixmap(colour, kind, not is_seen, ratio)
            for at in map(QPointF, *(places[run] - half).T.tolist()):
                draw(at, pixmap)

    # Paths

    def paint_paths(self, painter: QPainter, paths: Paths) -> None:
        """Paint curves as lines: dashed where they are only expected, faint behind the bone."""
        places, samples = self._places_of(paths)
        # All at once: to ask the camera takes longer than to paint a line.
        places, hidden = (
            self._project(places),
            self._hidden_paths.of(samples, exactly=self.is_resting),
        )
        painter.setBrush(Qt.BrushStyle.NoBrush)
        first = first_sample = 0
        for line in paths.lines:
            on_sheet = places[first : first + len(line.places)]
            count = len(line.places[::_STEP])
            behind = hidden[first_sample : first_sample + count].repeat(_STEP)[: len(on_sheet)]
            first, first_sample = first + len(on_sheet), first_sample + count
            rows = _apart(on_sheet)
            for run, is_hidden in runs(on_sheet[rows], behind[rows]):
                polygon = QPolygonF([QPointF(x, y) for x, y in run.tolist()])
                for pen in _pens(line.colour, line.is_ghost, line.is_chosen, is_hidden):
                    painter.setPen(pen)
                    painter.drawPolyline(polygon)

    def _places_of(self, paths: Paths) -> tuple[NDArray, NDArray]:
        """Return all places of curves, and those of which it is asked whether they are hidden."""
        known, places, samples = self._path_places
        if known is not paths:
            places = np.vstack([line.places for line in paths.lines])
            samples = np.vstack([line.places[::_STEP] for line in paths.lines])
            self._path_places = (paths, places, samples)
        return places, samples

    # Handles

    def handle_places(self, handles: Handles) -> NDArray:
        """Return where handles are on the sheet: (n, 2)."""
        return self._project(self._handle_positions(handles))

    def nearest_handle(self, handles: Handles, at: QPointF, within: float) -> CurveHandle | None:
        """Return the seen handle nearest to a place on the sheet, if any is near enough."""
        if not handles.handles:
            return None
        distances = np.hypot(*(self.handle_places(handles) - [at.x(), at.y()]).T)
        distances[self._hidden_handles.of(self._handle_positions(handles), exactly=True)] = np.inf
        row = int(np.argmin(distances))
        return handles.handles[row] if distances[row] <= within else None

    def paint_handles(self, painter: QPainter, handles: Handles, ratio: float) -> None:
        """Paint handles as squares: hollow where they are only expected."""
        hidden = self._hidden_handles.of(self._handle_positions(handles), exactly=True)
        places = self.handle_places(handles).tolist()
        half = _handle_extent() / 2
        for handle, (x, y), is_hidden in zip(handles.handles, places, hidden.tolist(), strict=True):
            row = handle.colour % len(theme.GROUP_COLOURS)
            pixmap = handle_pixmap(row, handle.is_ghost, is_hidden, ratio)
            painter.drawPixmap(QPointF(x - half, y - half), pixmap)

    def _handle_positions(self, handles: Handles) -> NDArray:
        known, places = self._handle_places
        if known is not handles:
            positions = [handle.position for handle in handles.handles]
            places = np.array(positions, np.float64).reshape(-1, 3)
            self._handle_places = (handles, places)
        return places

    # Slides

    def paint_slides(self, painter: QPainter, slides: Slides) -> None:
        """Paint a thin line with a head for each semilandmark that slid far enough to be seen."""
        starts, ends = self._project(slides.starts), self._project(slides.ends)
        along = ends - starts
        lengths = np.hypot(*along.T)
        for row in np.flatnonzero(lengths > _SHORTEST).tolist():
            start, end = QPointF(*starts[row]), QPointF(*ends[row])
            direction = QPointF(*(along[row] / lengths[row]))
            across = QPointF(-direction.y(), direction.x())
            head = min(5.0, 0.6 * float(lengths[row]))
            neck = end - direction * head
            colour = theme.group_colour(int(slides.colours[row]))
            painter.setPen(QPen(colour, 1.2))
            painter.setBrush(colour)
            painter.drawLine(start, neck)
            painter.drawPolygon(
                QPolygonF([end, neck + across * head * 0.4, neck - across * head * 0.4])
            )


def _apart(places: NDArray) -> NDArray[np.int64]:
    """Return which places of a line are drawn: those about so far apart on the screen."""
    steps = np.hypot(*np.diff(places, axis=0).T)
    cells = np.concatenate([[0.0], np.cumsum(steps)]) // _SMOOTH
    new = np.ones(len(places), np.bool_)
    new[1:-1] = np.diff(cells[:-1]) > 0
    return np.flatnonzero(new)


@functools.lru_cache(maxsize=64)
def _pens(colour: int, is_ghost: bool, is_chosen: bool, is_hidden: bool) -> tuple[QPen, QPen]:
    """Return what a curve is painted with: its rim, and itself."""
    rim, ink = (
        QColor(theme.SELECTED_COLOUR if is_chosen else theme.PAPER),
        theme.group_colour(colour),
    )
    if is_hidden:
        # Not the painter's opacity, which takes ten times as long.
        for one in (rim, ink):
            one.setAlphaF(FAINT)
    pens = (QPen(rim, 6.0 if is_chosen else 4.0), QPen(ink, 2.0))
    for pen in pens:
        pen.setCapStyle(Qt.PenCapStyle.FlatCap)
        pen.setJoinStyle(Qt.PenJoinStyle.BevelJoin)
        if is_ghost:
            # As long on the screen under and over.
            pen.setDashPattern([2 * dash / pen.widthF() for dash in _DASHES])
    return pens


def _dot_extent() -> float:
    return 2 * (DOT_RADIUS + 4)


def _handle_extent() -> float:
    return 2 * (HANDLE_RADIUS + 4)


@functools.lru_cache(maxsize=64)
def handle_pixmap(colour: int, is_ghost: bool, hidden: bool, ratio: float) -> QPixmap:
    """Return the picture of a handle: a square, hollow where it is only expected."""
    width, ink = _handle_extent(), theme.group_colour(colour)
    pixmap = _empty(width, ratio)
    square = QRectF(4, 4, 2 * HANDLE_RADIUS, 2 * HANDLE_RADIUS)
    with QPainter(pixmap) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setOpacity(FAINT if hidden else 1.0)
        painter.setPen(QPen(QColor(theme.PAPER), 4.4))
        painter.drawRect(square)
        painter.setPen(QPen(ink, 2.0))
        painter.setBrush(QColor(theme.PAPER) if is_ghost else ink)
        painter.drawRect(square)
    return pixmap


def _empty(width: float, ratio: float) -> QPixmap:
    pixmap = QPixmap(round(width * ratio), round(width * ratio))
    pixmap.setDevicePixelRatio(ratio)
    pixmap.fill(Qt.GlobalColor.transparent)
    return pixmap


@functools.lru_cache(maxsize=256)
def dot_pixmap(colour: int, kind: int, hidden: bool, ratio: float) -> QPixmap:
    """Return the picture of a semilandmark: a dot, a ring where it was freed."""
    width = _dot_extent()
    pixmap = _empty(width, ratio)
    centre, ink = QPointF(width / 2, width / 2), theme.group_colour(colour)
    with QPainter(pixmap) as painter:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setOpacity(FAINT if hidden else 1.0)
        paper = QColor(theme.PAPER)
        if kind == DotKind.FREED:
            painter.setPen(QPen(paper, 3.6))
            painter.drawEllipse(centre, DOT_RADIUS + 1, DOT_RADIUS + 1)
            painter.setPen(QPen(ink, 1.6))
            painter.drawEllipse(centre, DOT_RADIUS + 1, DOT_RADIUS + 1)
        elif kind == DotKind.EXCLUDED:
            painter.setPen(QPen(QColor(theme.QUIET_INK), 1.4))
            bar = QPointF(DOT_RADIUS, DOT_RADIUS)
            painter.drawLine(centre - bar, centre + bar)
            bar = QPointF(DOT_RADIUS, -DOT_RADIUS)
            painter.drawLine(centre - bar, centre + bar)
        else:
            if kind == DotKind.CHOSEN:
                painter.setPen(QPen(QColor(theme.OUTLINE), 1.0))
                painter.setBrush(QColor(theme.SELECTED_COLOUR))
                painter.drawEllipse(centre, DOT_RADIUS + 3, DOT_RADIUS + 3)
            painter.setPen(QPen(paper, 1.0))
            painter.setBrush(ink)
            painter.drawEllipse(centre, DOT_RADIUS + 0.5, DOT_RADIUS + 0.5)
    return pixmap
