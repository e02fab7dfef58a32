"""One viewport: a picture that says what was clicked, dragged, hovered or dropped on it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from qtpy.QtGui import (
    QDragEnterEvent,
    QDropEvent,
    QKeyEvent,
    QKeySequence,
    QMouseEvent,
    QWheelEvent,
)
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.scene.drawables import CurveHandle, Marker
from pinwarp.gui.tasks.dropping import dropped_files
from pinwarp.gui.views.canvas import OUTLINE_REACH, Canvas
from pinwarp.gui.views.tool import Tool
from pinwarp.session.warp.ghost import Ghost

# A press released within SLOP pixels is a click; one begun within REACH of a landmark
# or a handle grabs it.
SLOP = 4
REACH = 10
# A click that begins so soon after a drag ended belongs to it: the hand let go too early.
AFTER_DRAG_MS = 333
# The wheel has come to rest when no notch came for this long.
ZOOM_REST_MS = 250
_ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, 1),
    Qt.Key.Key_Down: (0, -1),
}
_ENTER = (Qt.Key.Key_Return, Qt.Key.Key_Enter)
# Of the crosshair, in pixels; with Shift ten times as far.
CROSSHAIR_STEP = 4
# By which an arrow key with Ctrl turns the bone, in degrees, and a page key zooms.
_TURN, _ZOOM = 15, 1.25


@dataclass
class _Press:
    """A left press that is not yet known to be a click, a drag of something, or an orbit."""

    at: QPointF
    event: QMouseEvent
    grip: Marker | CurveHandle | Ghost | None
    offset: QPointF
    dragging: bool = False
    twice: bool = False
    # Begun when a drag had just ended.
    stray: bool = False


class Viewport(Canvas):
    """The picture of one side.

    Positions in signals are (3,) arrays in the mesh's frame and unit. That of a clicked ghost is
    where the bone was clicked; None beside it. A handle comes with its curve
    and number, and while it is dragged with the landmark that it is dragged onto, if any.

    Attributes
    ----------
    tool : Tool or None
        What takes clicks before anybody else.
    crosshair : QPointF or None
        Where arrow keys have moved the crosshair that stands for the mouse.
    """

    surface_clicked = Signal(object)
    surface_ctrl_clicked = Signal(object)
    surface_shift_clicked = Signal(object)
    stray_clicked = Signal()
    turning_alone = Signal(bool)
    nudged = Signal(int, int)
    background_clicked = Signal()
    landmark_clicked = Signal(str)
    landmark_dragged = Signal(str, object)
    landmark_dropped = Signal(str)
    ghost_clicked = Signal(str, object)
    handle_clicked = Signal(str, int)
    handle_dragged = Signal(str, int, object, str)
    handle_dropped = Signal(str, int)
    drag_cancelled = Signal()
    crosshair_left = Signal(bool)
    hovered = Signal(object)
    files_dropped = Signal(list)

    def __init__(self, side: Side, surfaces: Surfaces, parent: QWidget | None = None) -> None:
        self._press: _Press | None = None
        super().__init__(side, surfaces, parent)
        self.setAccessibleName(f"{side.value.capitalize()} bone")
        self.tool: Tool | None = None
        self.crosshair: QPointF | None = None
        self._passing: Qt.MouseButton | None = None
        self._is_alone = False
        self._drag_ended: int | None = None
        self._hovered: str | None = None
        self._zoom_rest = QTimer(self)
        self._zoom_rest.setSingleShot(True)
        self._zoom_rest.setInterval(ZOOM_REST_MS)
        self._zoom_rest.timeout.connect(lambda: self.set_orbiting(False))
        self.setAcceptDrops(True)

    # The mouse and the keyboard

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Hold a left press back until it is known what it becomes; right and middle pan."""
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        if self._passing is not None or self._press is not None:
            return
        if event.button() == Qt.MouseButton.LeftButton:
            at = event.position()
            grip = self._grip(at)
            offset = QPointF(0, 0)
            if grip is not None:
                ((x, y),) = self.project(np.array([grip.position]))
                offset = QPointF(x, y) - at
            ended = self._drag_ended
            stray = ended is not None and 0 <= event.timestamp() - ended < AFTER_DRAG_MS
            self._press = _Press(at, QMouseEvent(event), grip, offset, stray=stray)
            return
        self._pass_on(event, QEvent.Type.MouseButtonPress, Qt.MouseButton.MiddleButton)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Orbit, drag a landmark, or hover."""
        press = self._press
        if press is None:
            if not event.buttons():
                self._hover(event.position())
            super().mouseMoveEvent(event)
            if self._passing is not None:
                self.stay_in_reach()
            return
        moved = event.position() - press.at
        if not press.dragging and max(abs(moved.x()), abs(moved.y())) <= SLOP:
            return
        grip = press.grip
        fixed = isinstance(grip, Marker | CurveHandle) and not grip.movable
        stays = grip is None or fixed or self.tool is not None
        if stays and not press.dragging:
            self._press = None
            if press.event.modifiers() & Qt.KeyboardModifier.ControlModifier:
                self._is_alone = True
                self.turning_alone.emit(True)
            self._pass_on(press.event, QEvent.Type.MouseButtonPress, Qt.MouseButton.LeftButton)
            super().mouseMoveEvent(event)
            return
        assert press.grip is not None, "else it is an orbit"
        press.dragging = True
        at = event.position() + press.offset
        if self.surface is None or event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            # Off the surface: a femoral head's centre lies inside the bone.
            position: NDArray | None = self.in_view_plane(at, np.array(press.grip.position))
        else:
            # Crests and tubercles lie on outlines: past one, it stays where it is nearest.
            position = self.pick(at, math.inf)
        if position is None:
            return
        if isinstance(press.grip, CurveHandle):
            onto = self.layer.nearest(event.position(), REACH)
            name = onto.name if onto is not None else ""
            self.handle_dragged.emit(press.grip.curve, press.grip.number, position, name)
        else:
            self.landmark_dragged.emit(press.grip.name, position)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Tell a click from the end of a drag."""
        press = self._press
        if press is None:
            if self._passing is not None:
                self._pass_on(event, QEvent.Type.MouseButtonRelease, self._passing)
                self._drag_ended = event.timestamp()
                if self._is_alone:
                    self._is_alone = False
                    self.turning_alone.emit(False)
            return
        if event.button() != Qt.MouseButton.LeftButton:
            return
        self._press = None
        grip = press.grip
        if not press.dragging:
            if press.stray:
                self.stray_clicked.emit()
            else:
                self._click(press.at, grip, event.modifiers(), press.twice)
            return
        self._drag_ended = event.timestamp()
        if isinstance(grip, CurveHandle):
            self.handle_dropped.emit(grip.curve, grip.number)
        elif grip is not None:
            self.landmark_dropped.emit(grip.name)

    def _click(
        self,
        at: QPointF,
        grip: Marker | CurveHandle | Ghost | None,
        modifiers: Qt.KeyboardModifier,
        twice: bool,
    ) -> None:
        """Say what was clicked, by the mouse or at the crosshair."""
        if self.tool is not None:
            self.tool.click(self, at, twice)
        elif modifiers & Qt.KeyboardModifier.ShiftModifier:
            # Also onto another landmark: the selected one is meant, wherever it is.
            self.surface_shift_clicked.emit(self.pick(at, OUTLINE_REACH))
        elif isinstance(grip, CurveHandle):
            self.handle_clicked.emit(grip.curve, grip.number)
        elif isinstance(grip, Ghost):
            self.ghost_clicked.emit(grip.name, self.pick(at))
        elif grip is not None:
            self.landmark_clicked.emit(grip.name)
        elif (position := self.pick(at, OUTLINE_REACH)) is not None:
            with_ctrl = bool(modifiers & Qt.KeyboardModifier.ControlModifier)
            (self.surface_ctrl_clicked if with_ctrl else self.surface_clicked).emit(position)
        else:
            self.background_clicked.emit()

    def _grip(self, at: QPointF) -> Marker | CurveHandle | Ghost | None:
        """Return what a press grabs; a landmark before a handle of a curve, this before a ghost."""
        layer = self.layer
        return (
            layer.nearest(at, REACH)
            or layer.nearest_handle(at, REACH)
            or layer.nearest_ghost(at, REACH)
        )

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Treat a second quick click as a click of its own: it must not get lost."""
        self.mousePressEvent(event)
        if self._press is not None:
            self._press.twice = True

    def _pass_on(self, event: QMouseEvent, kind: QEvent.Type, button: Qt.MouseButton) -> None:
        """Give VTK's camera style a press or release, as the button that it knows."""
        pressed = kind == QEvent.Type.MouseButtonPress
        self._passing = button if pressed else None
        self.set_orbiting(pressed)
        held = button if pressed else Qt.MouseButton.NoButton
        # With Ctrl VTK would spin instead of turn.
        modifiers = Qt.KeyboardModifier.NoModifier if self._is_alone else event.modifiers()
        replayed = QMouseEvent(
            kind, event.position(), event.globalPosition(), button, held, modifiers
        )
        if pressed:
            super().mousePressEvent(replayed)
        else:
            super().mouseReleaseEvent(replayed)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom."""
        self.set_orbiting(True)
        self._zoom_rest.start()
        super().wheelEvent(event)
        self.stay_in_reach()

    def _hover(self, at: QPointF) -> None:
        grip = self._grip(at)
        # The next ghost has its name already, and a click does something else there.
        told = grip if grip != self.drawn(Ghost) else None
        name = told.name if isinstance(told, Marker | Ghost) else None
        if self.tool is not None:
            self.tool.hover(self, at)
        if grip is not None:
            self.setCursor(Qt.CursorShape.PointingHandCursor)
        elif self.pick(at, OUTLINE_REACH) is not None:
            self.setCursor(Qt.CursorShape.CrossCursor)
        else:
            self.unsetCursor()
        if name != self._hovered:
            self._hovered = name
            self.hovered.emit(name)

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing is hovered any more."""
        super().leaveEvent(event)
        if self.tool is not None:
            self.tool.hover(self, None)
        if self._hovered is not None:
            self._hovered = None
            self.hovered.emit(None)

    def event(self, event: QEvent) -> bool:
        """Claim keys that mean something here before the window's shortcuts take them.

        All of them while a landmark is dragged: none changes the session under the hand. While
        there is a crosshair its keys, Tab among them.
        """
        kind = event.type()
        if kind not in (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress):
            return super().event(event)
        key, has_crosshair = event.key(), self.crosshair is not None
        if kind == QEvent.Type.ShortcutOverride:
            if self._is_dragging or (has_crosshair and key in (Qt.Key.Key_Escape, *_ENTER)):
                event.accept()
                return True
        elif has_crosshair and key in (Qt.Key.Key_Tab, Qt.Key.Key_Backtab):
            self.crosshair_left.emit(True)
            return True
        return super().event(event)

    @property
    def _is_dragging(self) -> bool:
        return self._press is not None and self._press.dragging

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Cancel a drag with Esc or undo; VTK's own keys (w, s, 3, p, ...) are not for users."""
        key, modifiers = event.key(), event.modifiers()
        if self._is_dragging:
            if key == Qt.Key.Key_Escape or event.matches(QKeySequence.StandardKey.Undo):
                self._press = None
                self.drag_cancelled.emit()
        elif key in _ARROWS:
            across, upwards = _ARROWS[key]
            steps = 10 if modifiers & Qt.KeyboardModifier.ShiftModifier else 1
            if modifiers & Qt.KeyboardModifier.ControlModifier:
                self._turn(across, upwards)
            elif self.crosshair is not None:
                step = CROSSHAIR_STEP * steps
                self.put_crosshair(self.crosshair + QPointF(across * step, -upwards * step))
            else:
                self.nudged.emit(across * steps, upwards * steps)
        elif key in (Qt.Key.Key_PageUp, Qt.Key.Key_PageDown):
            self.camera.Dolly(_ZOOM if key == Qt.Key.Key_PageUp else 1 / _ZOOM)
            self.stay_in_reach()
            self.renderer.ResetCameraClippingRange()
            self.update()
        elif self.crosshair is not None and key in _ENTER:
            self._click(self.crosshair, self._grip(self.crosshair), modifiers, False)
        elif self.crosshair is not None and key == Qt.Key.Key_Escape:
            self.crosshair_left.emit(False)
        else:
            event.ignore()

    def _turn(self, across: int, upwards: int) -> None:
        """Turn the bone by the keyboard, as a drag of the mouse in that direction does."""
        self.camera.Azimuth(-_TURN * across)
        self.camera.Elevation(-_TURN * upwards)
        self.camera.OrthogonalizeViewUp()
        self.renderer.ResetCameraClippingRange()
        self.update()

    def put_crosshair(self, at: QPointF | None) -> None:
        """Put the crosshair somewhere in the view, or take it away."""
        if at is not None:
            at = QPointF(
                min(max(at.x(), 0.0), self.width() - 1.0), min(max(at.y(), 0.0), self.height() - 1)
            )
        self.crosshair = at
        self.layer.show_crosshair(at)
        if at is not None:
            self._hover(at)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Keep VTK out of it."""
        event.ignore()

    # Drag and drop

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take files from the outside."""
        dropped_files(event)

    def dropEvent(self, event: QDropEvent) -> None:
        """Say which files were dropped here."""
        if paths := dropped_files(event):
            self.files_dropped.emit(paths)
