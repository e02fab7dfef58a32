"""One side's picture: a scene, and a camera before it."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TypeVar

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, Signal
from qtpy.QtGui import QResizeEvent
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.drawn.scene import DrawnScene
from pinwarp.gui.drawn.section import Section
from pinwarp.gui.drawn.surface import Surface
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.painted.legend import PaintedLegend
from pinwarp.gui.painted.marker_layer import MarkerLayer
from pinwarp.gui.scene.camera_pose import Matrix, Pose, best_frame, fitted
from pinwarp.gui.scene.drawables import Drawable, GridLines, Legend, Motion, Overlay
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.style import theme
from pinwarp.gui.views.fast_view import FastView

Kind = TypeVar("Kind", bound=Drawable)

# A frame slower than this is replaced by a stand-in's while something moves.
SLOW_FRAME = 0.030


class Canvas(FastView):
    """Shows a scene; knows where things are on the screen.

    Parameters
    ----------
    side
        Whose scenes these are.
    surfaces
        Where meshes become surfaces.
    """

    orbiting_changed = Signal(bool)

    def __init__(self, side: Side, surfaces: Surfaces, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.side = side
        self.is_placing_camera = False
        self._stage = DrawnScene(self, side, surfaces)
        self.layer = MarkerLayer(self, self)
        self.map_legend = PaintedLegend(self)
        self.layer.give_way_to(self.map_legend)
        self._full_frame_seconds = 0.0
        self._orbiting = False
        self.set_background(theme.BACKGROUND_BOTTOM, top=theme.BACKGROUND_TOP)
        self.setMinimumSize(160, 160)

    def update(self) -> None:
        """Schedule a paint of the bones, and where it is needed of the sheet above them."""
        super().update()
        layer = getattr(self, "layer", None)
        # The sheet is as it was while the camera stands still, whatever the bones do.
        if layer is not None and layer.painted_for != self.view_key():
            layer.update()

    # The scene

    def show_scene(self, scene: Scene) -> None:
        """Show another scene: drawn and painted is only what is new in it."""
        surface, moved = self.surface, scene.of(Motion) != self.drawn(Motion)
        changed = self._stage.show(scene)
        # The sheet repaints by itself: no bone is rendered anew for a label.
        self.layer.show_scene(scene)
        if scene.of(Legend) != self.map_legend.content:
            self.map_legend.show_content(scene.of(Legend))
            # Labels give way to it.
            self.layer.update()
        if self.surface is not surface:
            self._full_frame_seconds = 0.0
            self.look_at_all()
        elif changed & {Overlay, GridLines}:
            if not self.camera.is_set and Overlay in changed:
                self.look_at_all()
            else:
                self.renderer.ResetCameraClippingRange()
        if changed or moved:
            self._choose_detail()

    @property
    def scene(self) -> Scene:
        """What is shown."""
        return self._stage.scene

    def drawn(self, kind: type[Kind]) -> Kind | None:
        """Return what is shown of a kind, None where nothing is."""
        return self.scene.of(kind)

    @property
    def drawn_kinds(self) -> frozenset[type[Drawable]]:
        """All kinds that somebody here draws."""
        return self._stage.kinds | self.layer.kinds | {Legend, Motion}

    @property
    def surface(self) -> Surface | None:
        """The bone of this side."""
        return self._stage.surface

    @property
    def section(self) -> Section | None:
        """The cut through the bones."""
        return self._stage.section

    def draw_into(self, plotter: pv.Plotter, scene: Scene) -> DrawnScene:
        """Draw a scene in another plotter as it would be drawn here, cut from the same side."""
        return self._stage.draw_into(plotter, scene)

    @property
    def overlay_points(self) -> NDArray | None:
        """The vertices of the overlay as drawn, None where there is none."""
        return self._stage.overlay_points

    @property
    def grid_lines(self) -> NDArray | None:
        """The (lines, samples, 3) positions of the grid as drawn, None where there is none."""
        return self._stage.grid_lines

    # Detail: a stand-in while something moves and a frame in full would be slow

    @property
    def is_slow(self) -> bool:
        """Whether a frame in full detail takes longer than the eye forgives in motion."""
        return self._full_frame_seconds > SLOW_FRAME

    @property
    def is_coarse(self) -> bool:
        """Whether the stand-in is drawn now."""
        return self._is_moving and self.is_slow

    def set_orbiting(self, orbiting: bool) -> None:
        """Say whether the camera is being moved by the hand."""
        if orbiting != self._orbiting:
            self._orbiting = orbiting
            self._choose_detail()
            self.orbiting_changed.emit(orbiting)

    @property
    def _is_moving(self) -> bool:
        return self._orbiting or self.drawn(Motion) is not None

    def _choose_detail(self) -> None:
        # Smoothed edges cost half a frame in software: they can wait until things rest.
        self.renderer.SetUseFXAA(not self._is_moving)
        self._stage.set_coarse(self.is_coarse)
        self.update()

    def paintGL(self) -> None:
        """Render, and remember what a frame in full detail costs."""
        super().paintGL()
        if not self.is_coarse and self.surface is not None:
            # The first frame uploads everything: the cheapest one seen tells the truth, slowly
            # forgotten in case the machine has become busier.
            cheapest = self._full_frame_seconds or self.frame_seconds
            self._full_frame_seconds = min(cheapest * 1.1, self.frame_seconds)

    # The camera

    @property
    def bone(self) -> pv.PolyData | None:
        """What the camera is fitted to: this side's mesh, else the overlay, else None."""
        return self._stage.bone

    def look_at_all(self, frame: Matrix | None = None) -> None:
        """Fit everything, the longest axis upright and the widest across, or from a given side."""
        bone = self.bone
        if bone is None:
            return
        if frame is None:
            frame = best_frame(bone.bounds_size)
        # A few thousand vertices tell how large a bone looks.
        points = np.asarray(bone.points)[:: max(1, bone.n_points // 5000)]
        aspect = max(1, self.width()) / max(1, self.height())
        self.set_pose(fitted(points, frame, self.camera.GetViewAngle(), aspect))

    def set_pose(self, pose: Pose) -> None:
        """Put the camera somewhere; :attr:`is_placing_camera` tells that no hand moves it."""
        camera, self.is_placing_camera = self.camera, True
        camera.SetFocalPoint(pose.focal_point)
        camera.SetPosition(pose.position)
        camera.SetViewUp(pose.up)
        camera.SetParallelScale(pose.parallel_scale)
        camera.is_set = True
        self.is_placing_camera = False
        self.renderer.ResetCameraClippingRange()
        self.update()

    def view_key(self) -> Hashable:
        """Return what decides which landmarks are hidden: camera, size and mesh."""
        share = self.section.share if self.section is not None else None
        camera = self.camera
        # Not its time stamp: the clipping range changes with every warp, and hides nothing.
        pose = (camera.GetPosition(), camera.GetFocalPoint(), camera.GetViewUp())
        lens = (camera.GetViewAngle(), camera.GetParallelScale(), camera.GetParallelProjection())
        return (pose, lens, self.width(), self.height(), id(self.surface), share)

    @property
    def unit_per_pixel(self) -> float:
        """The length that a logical pixel shows where the camera looks, in mesh units."""
        camera, height = self.camera, max(1, self.height())
        if camera.GetParallelProjection():
            return 2 * camera.GetParallelScale() / height
        return 2 * camera.GetDistance() * np.tan(np.radians(camera.GetViewAngle()) / 2) / height

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
        near, far = self._ray(at)
        start = near if self.section is None else self.section.entry(near, far)
        return self.surface.first_hit(start, far) if start is not None else None

    def in_view_plane(self, at: QPointF, through: NDArray) -> NDArray:
        """Return the position under a place on the screen, as deep in the view as another one."""
        near, far = self._ray(at)
        along = np.array(self.camera.direction)
        towards = far - near
        return near + towards * float((through - near) @ along / (towards @ along))

    def view_axes(self) -> tuple[NDArray, NDArray]:
        """Return the unit vectors that point right and up on the screen."""
        along, up = np.array(self.camera.direction), np.array(self.camera.up)
        right = np.cross(along, up)
        right /= np.linalg.norm(right)
        return right, np.cross(right, along)

    def pixels_per_unit(self, position: NDArray) -> float:
        """Return how many logical pixels a mesh unit takes at a position."""
        right, _ = self.view_axes()
        size = self.surface.diagonal * 0.01 if self.surface is not None else 1.0
        a, b = self.project(np.array([position, position + right * size]))
        return float(np.linalg.norm(b - a)) / size

    def behind_surface(self, positions: NDArray) -> NDArray[np.bool_]:
        """Return which positions the mesh hides from the camera."""
        hidden = np.zeros(len(positions), dtype=bool)
        if self.surface is None:
            return hidden
        eye = np.array(self.camera.position)
        if self.camera.parallel_projection:
            eye = eye + np.array(self.camera.direction) * -1e3 * self.surface.diagonal
        for i, position in enumerate(positions):
            # What is clipped away neither hides nor can be grabbed.
            start = eye if self.section is None else self.section.entry(eye, position)
            hidden[i] = start is None or self.surface.hides(start, position)
        return hidden

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the sheet as large as the picture."""
        super().resizeEvent(event)
        self.layer.resize(event.size())
        self.map_legend.place()
