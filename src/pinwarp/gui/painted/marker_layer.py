"""The landmarks, labels and hints of a viewport, painted by Qt over the rendered bones.

Painted flat rather than rendered: signs and text stay crisp and of one size at every zoom, and
look the same on every graphics driver. What lies behind the surface is painted faintly.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, QRectF, QSizeF, Qt, QTimer, Signal
from qtpy.QtGui import QPainter, QPaintEvent
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Position, Side
from pinwarp.gui.painted.arrows import paint_arrow
from pinwarp.gui.painted.captions import (
    paint_badge,
    paint_caption,
    paint_hint,
    paint_next_click,
    paint_tool_words,
)
from pinwarp.gui.painted.ghosts import GhostPainter
from pinwarp.gui.painted.labels import Labels, draw_label_below
from pinwarp.gui.painted.legend import PaintedLegend
from pinwarp.gui.painted.markers import (
    FAINT,
    HALO,
    STAR_RADIUS,
    draw_crosshair,
    draw_ghost,
    draw_star,
    extent,
    marker_pixmap,
)
from pinwarp.gui.painted.model_elements import ModelPainter
from pinwarp.gui.painted.scale_bar import paint_scale_bar
from pinwarp.gui.painted.semilandmarks import SemilandmarkPainter
from pinwarp.gui.scene.drawables import (
    Arrows,
    Badge,
    Caption,
    Counterpart,
    CurveHandle,
    Dots,
    Drawable,
    Handles,
    Hint,
    Marker,
    Markers,
    NextClick,
    OtherGhosts,
    Paths,
    ScaleBar,
    Slides,
    Star,
    ToolWords,
    WorkWords,
)
from pinwarp.gui.scene.model_drawables import ModelElements
from pinwarp.gui.scene.projection import Projection
from pinwarp.gui.scene.scene import Scene
from pinwarp.session.warp.ghost import Ghost

_Sign = TypeVar("_Sign", Marker, Ghost)

# Once nothing was painted for so long, all is found out about what the bone hides.
_REST_MS = 150
_OUT_OF_SIGHT = "The bone is out of sight.\nHome looks at both bones as a whole."


class MarkerLayer(QWidget):
    """A transparent sheet over one viewport; the mouse does not see it.

    ``looked_anew`` says that it was painted for a camera that stands elsewhere.

    Parameters
    ----------
    projection
        Where places are on the sheet.
    parent
        What it lies on.
    """

    looked_anew = Signal()

    def __init__(self, projection: Projection, parent: QWidget) -> None:
        super().__init__(parent)
        self._projection = projection
        self._legend: PaintedLegend | None = None
        self._labels = Labels()
        self._scene = Scene(Side.SOURCE)
        self.semilandmarks = points = SemilandmarkPainter(projection, self._project)
        self._model = ModelPainter(projection, self._project)
        ghosts = GhostPainter(projection, self._project, self._are_hidden, self._labels)
        self._again = QTimer(self, singleShot=True, interval=_REST_MS)
        self._again.timeout.connect(self._on_rest)
        # In this order: what comes later lies on top.
        self._painters: dict[type[Drawable], Callable[[QPainter, Any], None]] = {
            Caption: self._paint_caption,
            ScaleBar: self._paint_scale_bar,
            Hint: self._paint_hint,
            ModelElements: self._paint_model,
            Paths: points.paint_paths,
            Slides: points.paint_slides,
            Dots: self._paint_dots,
            Handles: self._paint_handles,
            Star: self._paint_star,
            OtherGhosts: ghosts.paint_others,
            Arrows: self._paint_arrows,
            Markers: self._paint_markers,
            Counterpart: self._paint_counterpart,
            Ghost: ghosts.paint_next,
            NextClick: self._paint_next_click,
            Badge: self._paint_badge,
            WorkWords: self._paint_work_words,
            ToolWords: self._paint_tool_words,
        }
        self.painted_for: object = None
        self._crosshair: QPointF | None = None
        self._dark = False
        # Where the scale bar begins.
        self._free_until = 0.0
        # For a picture: signs in so many pixels, places seen from its middle.
        self.pixels_per_pixel = 1.0
        self.offset = (0.0, 0.0)
        # Landmarks that are reached from the right: their labels stand there.
        self._from_right: set[str] = set()
        # Which places the bone hides, as long as the camera stands still.
        self._hidden: dict[Position, bool] = {}
        self._hidden_for: object = None
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)

    def give_way_to(self, legend: PaintedLegend) -> None:
        """Keep labels from under a legend."""
        self._legend = legend

    @property
    def kinds(self) -> frozenset[type[Drawable]]:
        """What is painted here, of all that can be in a scene."""
        return frozenset(self._painters)

    def show_scene(self, scene: Scene) -> None:
        """Paint another scene, where anything on the sheet is another."""
        changed, self._scene = scene.changed_since(self._scene), scene
        if changed & self.kinds:
            self.update()

    @property
    def markers(self) -> tuple[Marker, ...]:
        """The landmarks on this sheet."""
        return self._signs.markers

    @property
    def _signs(self) -> Markers:
        return self._scene.of(Markers) or Markers()

    def places(self) -> NDArray:
        """Return where the landmarks are on the screen: (n, 2) logical pixels."""
        if not self.markers:
            return np.zeros((0, 2))
        return self._project([marker.position for marker in self.markers])

    def _project(self, positions: Sequence[Position] | NDArray) -> NDArray:
        return self._projection.project(np.array(positions)) + self.offset

    def hidden(self) -> NDArray[np.bool_]:
        """Return which landmarks lie behind the surface as the camera stands now."""
        return self._are_hidden([marker.position for marker in self.markers])

    def _are_hidden(self, positions: Sequence[Position]) -> NDArray[np.bool_]:
        key = self._projection.view_key()
        if key != self._hidden_for:
            self._hidden, self._hidden_for = {}, key
        new = [position for position in positions if position not in self._hidden]
        if new:
            found = self._projection.behind_surface(np.array(new))
            self._hidden.update(zip(new, found.tolist(), strict=True))
        return np.array([self._hidden[position] for position in positions], dtype=bool)

    def nearest(self, at: QPointF, within: float) -> Marker | None:
        """Return the seen landmark nearest to a place on the screen, if any is near enough."""
        # A large sign can be grabbed wherever it is seen.
        return self._nearest(self.markers, at, max(within, self._signs.radius + 2))

    @property
    def ghosts(self) -> tuple[Ghost, ...]:
        """The ghosts on this sheet, the next one first."""
        ghost, others = self._scene.of(Ghost), self._scene.of(OtherGhosts)
        first = () if ghost is None else (ghost,)
        return first if others is None else (*first, *others.ghosts)

    def nearest_ghost(self, at: QPointF, within: float) -> Ghost | None:
        """Return the seen ghost nearest to a place on the screen, if any is near enough."""
        return self._nearest(self.ghosts, at, within)

    def _nearest(self, signs: Sequence[_Sign], at: QPointF, within: float) -> _Sign | None:
        if not signs:
            return None
        positions = [sign.position for sign in signs]
        distances = np.hypot(*(self._project(positions) - [at.x(), at.y()]).T)
        distances[self._are_hidden(positions)] = np.inf
        index = int(np.argmin(distances))
        return signs[index] if distances[index] <= within else None

    def nearest_handle(self, at: QPointF, within: float) -> CurveHandle | None:
        """Return the seen handle of a curve nearest to a place on the screen, if near enough."""
        handles = self._scene.of(Handles)
        return None if handles is None else self.semilandmarks.nearest_handle(handles, at, within)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint what the scene holds for this sheet."""
        before, self.painted_for = self.painted_for, self._projection.view_key()
        self._from_right = set()
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self._begin_labels(painter)
            for kind, paint in self._painters.items():
                thing = self._scene.of(kind)
                if thing is not None:
                    paint(painter, thing)
            if self._crosshair is not None:
                draw_crosshair(painter, self._crosshair)
            if self.is_bone_lost and self._scene.of(Hint) is None:
                self._paint_hint(painter, Hint(_OUT_OF_SIGHT))
        points, model = self.semilandmarks, self._model
        points.is_resting = model.is_resting = False
        if points.is_stale or model.is_stale:
            self._again.start()
        if self.painted_for != before:
            self.looked_anew.emit()

    def show_crosshair(self, at: QPointF | None) -> None:
        """Paint the crosshair that the arrow keys move; None takes it away."""
        self._crosshair = at
        self.update()

    def _begin_labels(self, painter: QPainter) -> None:
        legend = self._legend
        beside = QRectF(legend.geometry()) if legend is not None and legend.has_room else None
        self._labels.begin(painter, QSizeF(self.size()), beside)

    def _on_rest(self) -> None:
        self.semilandmarks.is_resting = self._model.is_resting = True
        self.update()

    def set_dark(self, dark: bool) -> None:
        """Write for a dark background, or for a light one."""
        if dark != self._dark:
            self._dark = dark
            self.update()

    @property
    def is_bone_lost(self) -> bool:
        """Whether there is a bone but nothing of it in the view."""
        return self._scene.of(Caption) is not None and self._projection.is_bone_lost

    def _paint_caption(self, painter: QPainter, caption: Caption) -> None:
        paint_caption(painter, caption, self.width(), dark=self._dark)

    def _paint_scale_bar(self, painter: QPainter, bar: ScaleBar) -> None:
        length = self._projection.unit_per_pixel
        if not 0 < length < math.inf:
            return
        ruler, whole = bar.ruler, QRectF(self.rect())
        shown = ruler.factor * length
        where = paint_scale_bar(painter, whole, shown, ruler.unit, dark=self._dark)
        self._free_until = where.left()

    def _paint_next_click(self, painter: QPainter, step: NextClick) -> None:
        view = QRectF(self.rect())
        paint_next_click(painter, step, view, self._free_until, dark=self._dark)

    def _paint_hint(self, painter: QPainter, hint: Hint) -> None:
        paint_hint(painter, hint, QRectF(self.rect()), dark=self._dark)

    def _paint_model(self, painter: QPainter, elements: ModelElements) -> None:
        self._model.paint(painter, elements)
        for words, position in elements.labels:
            ((x, y),) = self._project([position])
            at = QPointF(x, y)
            self._labels.draw(painter, words, at, always=False)

    def _paint_dots(self, painter: QPainter, dots: Dots) -> None:
        self.semilandmarks.paint_dots(painter, dots, self._ratio)

    def _paint_handles(self, painter: QPainter, handles: Handles) -> None:
        self.semilandmarks.paint_handles(painter, handles, self._ratio)

    @property
    def _ratio(self) -> float:
        """How many pixels of the screen, or of a picture, make a logical one."""
        return self.devicePixelRatioF() * self.pixels_per_pixel

    def _paint_tool_words(self, painter: QPainter, tool: ToolWords) -> None:
        paint_tool_words(painter, tool, QRectF(self.rect()))

    def _paint_badge(self, painter: QPainter, badge: Badge) -> None:
        paint_badge(painter, badge, QRectF(self.rect()))

    def _paint_work_words(self, painter: QPainter, work: WorkWords) -> None:
        if self._scene.of(Badge) is None:
            paint_badge(painter, work, QRectF(self.rect()))

    def _paint_counterpart(self, painter: QPainter, counterpart: Counterpart) -> None:
        """Paint a ring around the landmark that the other side's ghost stands for."""
        position = counterpart.position
        ((x, y),), (hidden,) = self._project([position]), self._are_hidden([position])
        at, radius = QPointF(x, y), self._signs.radius + HALO
        painter.setOpacity(0.5 if hidden else 1.0)
        draw_ghost(painter, at, radius)
        painter.setOpacity(1.0)
        self._labels.draw(painter, counterpart.name, at, radius)

    def _paint_star(self, painter: QPainter, star: Star) -> None:
        """Paint a star in a dotted ring where the next landmark helps most."""
        suggestion = star.suggestion
        position = np.array([suggestion.position])
        ((x, y),) = self._project([suggestion.position])
        at, hidden = QPointF(x, y), bool(self._projection.behind_surface(position)[0])
        painter.setOpacity(0.5 if hidden else 1.0)
        draw_star(painter, at)
        words = f"next landmark helps most here (± {star.deviation})"
        self._labels.keep_free(draw_label_below(painter, words, at, self.room_at(at), STAR_RADIUS))
        painter.setOpacity(1.0)

    def room_at(self, at: QPointF) -> float:
        """Return how far right a label beside a place may reach."""
        legend = self._legend
        if legend is None or not legend.has_room:
            return self.width()
        beside = legend.y() - 14 < at.y() < legend.geometry().bottom() + 14
        return legend.x() if beside else self.width()

    def _paint_arrows(self, painter: QPainter, shown: Arrows) -> None:
        arrows, hidden, radius = shown.arrows, self.hidden(), self._signs.radius
        selected = {marker.name for marker in self.markers if marker.selected}
        faint = {marker.name for marker, out in zip(self.markers, hidden, strict=True) if out}
        starts = self._project([arrow.start for arrow in arrows])
        ends = self._project([arrow.end for arrow in arrows])
        for arrow, start, end in zip(arrows, starts.tolist(), ends.tolist(), strict=True):
            chosen = arrow.name in selected
            # What is asked about is seen even behind the bone.
            painter.setOpacity(FAINT if arrow.name in faint and not chosen else 1.0)
            seen = paint_arrow(
                painter,
                QPointF(*start),
                QPointF(*end),
                radius + HALO * chosen,
                left_out=arrow.left_out,
            )
            if seen and start[0] > end[0]:
                self._from_right.add(arrow.name)
        painter.setOpacity(1.0)

    def _paint_markers(self, painter: QPainter, shown: Markers) -> None:
        markers, radius = shown.markers, shown.radius
        places, hidden = self.places(), self.hidden()
        ratio = self._ratio
        # Hidden ones first, selected ones last, so that what matters lies on top.
        order = sorted(
            range(len(markers)),
            key=lambda i: (not hidden[i], markers[i].selected, markers[i].labelled),
        )
        for i in order:
            marker = markers[i]
            pixmap = marker_pixmap(marker.state, marker.selected, bool(hidden[i]), ratio, radius)
            x, y = places[i] - extent(radius) / 2
            painter.drawPixmap(QPointF(x, y), pixmap)
        self._labels.draw_names(painter, shown, places, hidden, self._from_right)
