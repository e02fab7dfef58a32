"""One viewport: draws a scene, and says what was clicked, dragged, hovered or dropped."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from qtpy.QtCore import QEvent, QPointF, Qt, Signal
from qtpy.QtGui import (
    QDragEnterEvent,
    QDropEvent,
    QKeyEvent,
    QMouseEvent,
    QResizeEvent,
)
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui import theme
from pinwarp.gui.fast_view import FastView
from pinwarp.gui.marker_layer import MarkerLayer
from pinwarp.gui.scene import Marker, Scene
from pinwarp.gui.surface import Surface, triangles

# A press released within SLOP pixels is a click; one begun within REACH of a landmark grabs it.
SLOP = 4
REACH = 10

_COLOURS = {Side.SOURCE: theme.SOURCE_COLOUR, Side.DESTINATION: theme.DESTINATION_COLOUR}


@dataclass
class _Press:
    """A left press that is not yet known to be a click, a drag of a landmark, or an orbit."""

    at: QPointF
    event: QMouseEvent
    marker: Marker | None
    offset: QPointF
    dragging: bool = False


# Key, fill and rim light: place relative to the camera, and strength.
_LIGHTS = (((-0.5, 0.7, 1.0), 0.85), ((0.9, 0.1, 0.7), 0.42), ((0.0, 0.8, -1.0), 0.25))


class Viewport(FastView):
    """The picture of one side.

    Positions in signals are (3,) arrays in the mesh's frame and unit.
    """

    surface_clicked = Signal(object)
    background_clicked = Signal()
    landmark_clicked = Signal(str)
    landmark_dragged = Signal(str, object)
    landmark_dropped = Signal(str)
    drag_cancelled = Signal()
    hovered = Signal(object)
    files_dropped = Signal(list)

    def __init__(self, side: Side, parent: QWidget | None = None) -> None:
        self._press: _Press | None = None
        super().__init__(parent)
        self.side = side
        self.layer = MarkerLayer(self, side.value.capitalize())
        self.surface: Surface | None = None
        self._scene: Scene | None = None
        self._overlay: pv.PolyData | None = None
        self._overlay_faces: NDArray | None = None
        self._overlay_actor: pv.Actor | None = None
        self._passing: Qt.MouseButton | None = None
        self._hovered: str | None = None
        self.iren.clear_key_event_callbacks()
        self.set_background(theme.BACKGROUND_BOTTOM, top=theme.BACKGROUND_TOP)
        self._set_lights()
        self.renderer.UseFXAAOn()
        self.setAcceptDrops(True)
        self.setMinimumSize(160, 160)

    # Drawing

    def _set_lights(self) -> None:
        """Key, fill and rim light that move with the camera."""
        self.remove_all_lights()
        for place, strength in _LIGHTS:
            light = pv.Light(position=place, light_type="camera light", intensity=strength)
            self.add_light(light)

    def update(self) -> None:
        """Schedule a paint of the bones and of the sheet above them, in the same turn."""
        super().update()
        layer = getattr(self, "layer", None)
        if layer is not None:
            layer.update()

    def show_surface(self, surface: Surface | None) -> None:
        """Show another mesh on this side and look at it, or none."""
        if surface is self.surface:
            return
        self.surface = surface
        self.remove_actor("surface", render=False)
        if surface is not None:
            self.add_mesh(
                surface.polydata,
                name="surface",
                copy_mesh=False,
                color=_COLOURS[self.side],
                lighting=True,
                interpolation="phong",
                ambient=0.2,
                diffuse=0.92,
                specular=0.16,
                specular_power=18,
                reset_camera=False,
                render=False,
                pickable=False,
            )
            self.look_at_all()
        self.update()

    def show_scene(self, scene: Scene) -> None:
        """Show another state of the session; the mesh is set by :meth:`show_surface`."""
        if scene == self._scene:
            return
        self._scene = scene
        self.layer.set_markers(scene.markers)
        self.layer.hint = scene.hint
        self._style_overlay()
        self.update()

    def show_overlay(
        self,
        faces: NDArray | None,
        vertices: NDArray[np.float32] | None,
        normals: NDArray[np.float32] | None,
        inside_out: bool = False,
    ) -> None:
        """Show the warped source over this side's mesh.

        The arrays are copied into the drawn mesh in place: adding it anew costs a frame.
        """
        if faces is None or vertices is None or normals is None:
            self.remove_actor("overlay", render=False)
            self._overlay = self._overlay_actor = None
            self.update()
            return
        if self._overlay is None or self._overlay_faces is not faces:
            self._overlay = triangles(vertices, faces)
            self._overlay_faces = faces
            self._overlay.point_data["Normals"] = normals
            self._overlay.point_data.active_normals_name = "Normals"
            self._overlay_actor = self.add_mesh(
                self._overlay,
                name="overlay",
                copy_mesh=False,
                color=theme.OVERLAY_COLOUR,
                interpolation="phong",
                specular=0.2,
                specular_power=20,
                # One layer of a translucent bone needs no depth peeling.
                culling="front" if inside_out else "back",
                reset_camera=False,
                render=False,
                pickable=False,
            )
        else:
            self._overlay.points[:] = vertices
            self._overlay.point_data["Normals"][:] = normals
            self._overlay.GetPoints().Modified()
            self._overlay.GetPointData().GetNormals().Modified()
            self._overlay.Modified()
        self._style_overlay()
        if not self.camera.is_set:
            self.look_at_all()
        else:
            self.renderer.ResetCameraClippingRange()
        self.update()

    @property
    def overlay_points(self) -> NDArray | None:
        """The vertices of the overlay as drawn, None where there is none."""
        return None if self._overlay is None else np.array(self._overlay.points)

    def _style_overlay(self) -> None:
        actor, scene = self._overlay_actor, self._scene
        if actor is None or scene is None:
            return
        actor.SetVisibility(scene.overlay_visible)
        actor.prop.opacity = scene.overlay_opacity

    # The camera

    def look_at_all(self) -> None:
        """Fit everything, the longest axis upright and the widest across."""
        mesh = self.surface.polydata if self.surface is not None else self._overlay
        if mesh is None:
            return
        size = np.array(mesh.bounds_size)
        up = int(np.argmax(size))
        along = min((axis for axis in range(3) if axis != up), key=lambda axis: size[axis])
        direction, upright = np.zeros(3), np.zeros(3)
        direction[along], upright[up] = 1.0, 1.0
        centre = np.array(mesh.center)
        self.camera.focal_point = centre
        self.camera.position = centre + direction * float(np.linalg.norm(size)) * 2
        self.camera.up = upright
        self.reset_camera(render=False, bounds=mesh.bounds)
        self.camera.zoom(1.25)
        self.camera.is_set = True
        self.renderer.ResetCameraClippingRange()
        self.update()

    def view_key(self) -> tuple[Any, ...]:
        """Return what decides which landmarks are hidden: camera, size and mesh."""
        return (self.camera.GetMTime(), self.width(), self.height(), id(self.surface))

    def _projection(self) -> NDArray:
        aspect = max(1, self.width()) / max(1, self.height())
        matrix = self.camera.GetCompositeProjectionTransformMatrix(aspect, -1, 1)
        return np.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])

    def project(self, points: NDArray) -> NDArray:
        """Return where (n, 3) positions are on the screen: (n, 2) logical pixels."""
        clip = np.column_stack([points, np.ones(len(points))]) @ self._projection().T
        # What lies behind the camera must not appear in front of it.
        depth = np.where(clip[:, 3] > 1e-12, clip[:, 3], np.nan)
        x = (clip[:, 0] / depth + 1) / 2 * self.width()
        y = (1 - clip[:, 1] / depth) / 2 * self.height()
        return np.nan_to_num(np.column_stack([x, y]), nan=-1e6)

    def _ray(self, at: QPointF) -> tuple[NDArray, NDArray]:
        """Return the ends of the line of sight through a place on the screen."""
        x = 2 * at.x() / self.width() - 1
        y = 1 - 2 * at.y() / self.height()
        near_far = np.array([[x, y, -1, 1], [x, y, 1, 1]]) @ np.linalg.inv(self._projection()).T
        near, far = near_far[:, :3] / near_far[:, 3:]
        return near, far

    def pick(self, at: QPointF) -> NDArray | None:
        """Return the position on the surface under a place on the screen, None beside it."""
        if self.surface is None:
            return None
        return self.surface.first_hit(*self._ray(at))

    def behind_surface(self, positions: NDArray) -> NDArray[np.bool_]:
        """Return which positions the mesh hides from the camera."""
        hidden = np.zeros(len(positions), dtype=bool)
        if self.surface is None:
            return hidden
        eye = np.array(self.camera.position)
        if self.camera.parallel_projection:
            eye = eye + np.array(self.camera.direction) * -1e3 * self.surface.diagonal
        for i, position in enumerate(positions):
            hidden[i] = self.surface.hides(eye, position)
        return hidden

    # The mouse and the keyboard

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Hold a left press back until it is known what it becomes; right and middle pan."""
        self.setFocus(Qt.FocusReason.MouseFocusReason)
        if self._passing is not None or self._press is not None:
            return
        if event.button() == Qt.MouseButton.LeftButton:
            at = event.position()
            marker = self.layer.nearest(at, REACH)
            offset = QPointF(0, 0)
            if marker is not None:
                ((x, y),) = self.project(np.array([marker.position]))
                offset = QPointF(x, y) - at
            self._press = _Press(at, QMouseEvent(event), marker, offset)
            return
        self._pass_on(event, QEvent.Type.MouseButtonPress, Qt.MouseButton.MiddleButton)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Orbit, drag a landmark, or hover."""
        press = self._press
        if press is None:
            if not event.buttons():
                self._hover(event.position())
            super().mouseMoveEvent(event)
            return
        moved = event.position() - press.at
        if not press.dragging and max(abs(moved.x()), abs(moved.y())) <= SLOP:
            return
        if press.marker is None or not press.marker.movable:
            self._press = None
            self._pass_on(press.event, QEvent.Type.MouseButtonPress, Qt.MouseButton.LeftButton)
            super().mouseMoveEvent(event)
            return
        press.dragging = True
        position = self.pick(event.position() + press.offset)
        if position is not None:
            self.landmark_dragged.emit(press.marker.name, position)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Tell a click from the end of a drag."""
        press = self._press
        if press is None:
            if self._passing is not None:
                self._pass_on(event, QEvent.Type.MouseButtonRelease, self._passing)
            return
        if event.button() != Qt.MouseButton.LeftButton:
            return
        self._press = None
        if press.dragging and press.marker is not None:
            self.landmark_dropped.emit(press.marker.name)
        elif press.marker is not None:
            self.landmark_clicked.emit(press.marker.name)
        elif (position := self.pick(press.at)) is not None:
            self.surface_clicked.emit(position)
        else:
            self.background_clicked.emit()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Treat a second quick click as a click of its own: it must not get lost."""
        self.mousePressEvent(event)

    def _pass_on(self, event: QMouseEvent, kind: QEvent.Type, button: Qt.MouseButton) -> None:
        """Give VTK's camera style a press or release, as the button that it knows."""
        pressed = kind == QEvent.Type.MouseButtonPress
        self._passing = button if pressed else None
        held = button if pressed else Qt.MouseButton.NoButton
        replayed = QMouseEvent(
            kind, event.position(), event.globalPosition(), button, held, event.modifiers()
        )
        if pressed:
            super().mousePressEvent(replayed)
        else:
            super().mouseReleaseEvent(replayed)

    def _hover(self, at: QPointF) -> None:
        marker = self.layer.nearest(at, REACH)
        name = marker.name if marker is not None else None
        if marker is not None:
            self.setCursor(Qt.CursorShape.PointingHandCursor)
        elif self.pick(at) is not None:
            self.setCursor(Qt.CursorShape.CrossCursor)
        else:
            self.unsetCursor()
        if name != self._hovered:
            self._hovered = name
            self.hovered.emit(name)

    def leaveEvent(self, event: QEvent) -> None:
        """Nothing is hovered any more."""
        super().leaveEvent(event)
        if self._hovered is not None:
            self._hovered = None
            self.hovered.emit(None)

    def event(self, event: QEvent) -> bool:
        """Claim Esc while a landmark is dragged, before the window's shortcut takes it."""
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and self._is_dragging
            and event.key() == Qt.Key.Key_Escape
        ):
            event.accept()
            return True
        return super().event(event)

    @property
    def _is_dragging(self) -> bool:
        return self._press is not None and self._press.dragging

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Cancel a drag with Esc; VTK's own keys (w, s, 3, p, ...) are not for our users."""
        if event.key() == Qt.Key.Key_Escape and self._is_dragging:
            self._press = None
            self.drag_cancelled.emit()
            return
        event.ignore()

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Keep VTK out of it."""
        event.ignore()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the sheet as large as the picture."""
        super().resizeEvent(event)
        self.layer.resize(event.size())

    # Drag and drop

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Take files from the outside."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Say which files were dropped here."""
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            self.files_dropped.emit(paths)
