"""One side's picture: meshes, overlay, landmarks and camera."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from qtpy.QtCore import QPointF, Signal
from qtpy.QtGui import QResizeEvent
from qtpy.QtWidgets import QWidget
from vtkmodules.vtkCommonCore import vtkLookupTable

from pinwarp.core.landmarks import Side
from pinwarp.gui.drawn.depth import WHOLE_DEPTH
from pinwarp.gui.drawn.folds import DrawnFolds, FoldedSurface
from pinwarp.gui.drawn.lines import DrawnLines
from pinwarp.gui.drawn.mesh import DrawnMesh, OverlayWarp
from pinwarp.gui.drawn.section import Section
from pinwarp.gui.drawn.surface import Surface, shaded
from pinwarp.gui.painted.legend import Legend, LegendContent
from pinwarp.gui.painted.marker_layer import MarkerLayer
from pinwarp.gui.scene.camera_pose import Matrix, Pose, best_frame, fitted
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.style import theme
from pinwarp.gui.views.fast_view import FastView

_COLOURS = {Side.SOURCE: theme.SOURCE_COLOUR, Side.DESTINATION: theme.DESTINATION_COLOUR}
_BONE = {"ambient": 0.2, "diffuse": 0.92, "specular": 0.16, "specular_power": 18}
_OVERLAY = {"specular": 0.2, "specular_power": 20}
# Key, fill and rim light: place relative to the camera, and strength.
_LIGHTS = (((-0.5, 0.7, 1.0), 0.85), ((0.9, 0.1, 0.7), 0.42), ((0.0, 0.8, -1.0), 0.25))
# A frame slower than this is replaced by a stand-in's while something moves.
SLOW_FRAME = 0.030
# Where an overlay that shows a map and the bone stand in the picture's depth: else the bone would
# hide the half of the map that lies inside it.
MAP_DEPTH, DEPTH_BEHIND_MAP = (0.0, 0.5), (0.5, 1.0)


class Canvas(FastView):
    """Draws a scene and the overlay; knows where things are on the screen."""

    orbiting_changed = Signal(bool)

    def __init__(self, side: Side, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.side = side
        self.layer = MarkerLayer(self, side.value.capitalize())
        self.map_legend = Legend(self)
        self.surface: Surface | None = None
        self.is_placing_camera = False
        self._scene: Scene | None = None
        self._section: Section | None = None
        bone = {"color": _COLOURS[side]} | _BONE
        warped = {"color": theme.OVERLAY_COLOUR} | _OVERLAY
        self._full = DrawnMesh(self, "surface", **bone)
        self._coarse = DrawnMesh(self, "surface stand-in", **bone)
        self._overlay = DrawnMesh(self, "overlay", **warped)
        self._coarse_overlay = DrawnMesh(self, "overlay stand-in", **warped)
        self._folds = DrawnFolds(self)
        self._grid = DrawnLines(self, "grid", color=theme.INK, opacity=0.4)
        self._full_frame_seconds = 0.0
        self._warping = self._orbiting = False
        self.set_background(theme.BACKGROUND_BOTTOM, top=theme.BACKGROUND_TOP)
        self._set_lights()
        self.setMinimumSize(160, 160)

    def _set_lights(self) -> None:
        """Key, fill and rim light that move with the camera."""
        self.remove_all_lights()
        for place, strength in _LIGHTS:
            light = pv.Light(position=place, light_type="camera light", intensity=strength)
            self.add_light(light)

    def update(self) -> None:
        """Schedule a paint of the bones, and where it is needed of the sheet above them."""
        super().update()
        layer = getattr(self, "layer", None)
        # The sheet is as it was while the camera stands still, whatever the bones do.
        if layer is not None and layer.painted_for != self.view_key():
            layer.update()

    def show_surface(self, surface: Surface | None) -> None:
        """Show another mesh on this side and look at it, or none."""
        if surface is self.surface:
            return
        self.surface = surface
        self._full.remove()
        self._coarse.remove()
        if surface is not None:
            self._full.show(surface.polydata)
            if surface.stand_in is not None:
                self._coarse.show(shaded(surface.stand_in.vertices, surface.stand_in.faces))
            self.look_at_all()
        if self._section is not None:
            # The other bone is cut from the same side, in its own depth.
            self._cut(self._section.direction, self._section.share)
        self._full_frame_seconds = 0.0
        self._choose_detail()

    def show_scene(self, scene: Scene) -> None:
        """Show another state of the session; the mesh is set by :meth:`show_surface`."""
        before, self._scene = self._scene, scene
        if scene == before:
            return
        # The sheet repaints by itself: no bone is rendered anew for a label.
        self.layer.hint, self.layer.unit = scene.hint, scene.unit
        self.layer.radius = scene.marker_radius
        self.layer.set_markers(scene.markers)
        self.layer.ghost, self.layer.arrows = scene.ghost, scene.arrows
        if before is None or scene.wireframe != before.wireframe:
            for drawn in (self._full, self._coarse):
                drawn.set_wireframe(scene.wireframe)
            self.update()
        if scene.section != (before.section if before is not None else None):
            self._show_section(scene.section)
        if before is None or scene.overlay != before.overlay:
            self._choose_detail()

    def show_overlay(self, warps: Sequence[OverlayWarp | None]) -> None:
        """Show the warped source over this side's mesh: in full, as a stand-in, or both."""
        for drawn, warp in zip((self._overlay, self._coarse_overlay), warps, strict=True):
            if warp is None:
                continue
            # One layer of a translucent bone needs no depth peeling.
            culling = "front" if warp.inside_out else "back"
            drawn.write(warp.mesh, warp.vertices, warp.normals, culling=culling)
        if not self.camera.is_set:
            self.look_at_all()
        else:
            self.renderer.ResetCameraClippingRange()
        self._choose_detail()

    def hide_overlay(self) -> None:
        """Show no warped source."""
        self._overlay.remove()
        self._coarse_overlay.remove()
        self._folds.show(None)
        self._choose_detail()

    def show_map(
        self, levels: Sequence[NDArray[np.float32] | None], table: vtkLookupTable | None
    ) -> None:
        """Colour the overlay, in full and the stand-in; plain where there are no levels."""
        for drawn, colours in zip((self._overlay, self._coarse_overlay), levels, strict=True):
            drawn.colour(colours, table)
        self._choose_detail()

    def show_legend(self, content: LegendContent | None) -> None:
        """Show the legend of a map, or none."""
        if content != self.map_legend.content:
            self.map_legend.show_content(content)
            # Labels give way to it.
            self.layer.update()

    def show_folds(self, folded: FoldedSurface | None) -> None:
        """Show where the warp turns the surface inside out."""
        self._folds.show(folded)
        self._folds.set_clip(self._section.plane if self._section is not None else None)
        self._choose_detail()

    def show_grid(self, lines: NDArray | None) -> None:
        """Show (lines, samples, 3) positions as lines, or none; the camera stays where it is."""
        if lines is None:
            self._grid.remove()
        else:
            self._grid.write(lines)
        self.renderer.ResetCameraClippingRange()
        self._choose_detail()

    @property
    def grid_lines(self) -> NDArray | None:
        """The (lines, samples, 3) positions of the grid as drawn, None where there is none."""
        return self._grid.lines

    def _show_section(self, share: float | None) -> None:
        """Move the cross-section; when it is switched on it faces the camera."""
        if share is not None and self._section is not None:
            self._section.move(share)
            self.update()
        else:
            self._cut(None if share is None else -np.array(self.camera.direction), share or 0.0)

    def _cut(self, direction: NDArray | None, share: float) -> None:
        self._section = None
        if direction is not None:
            points = self.bone.points if self.bone is not None else np.zeros((1, 3))
            self._section = Section(direction, points)
            self._section.move(share)
        plane = self._section.plane if self._section is not None else None
        for drawn in (self._full, self._coarse, self._overlay, self._coarse_overlay):
            drawn.set_clip(plane)
        self._folds.set_clip(plane)
        self.update()

    @property
    def overlay_points(self) -> NDArray | None:
        """The vertices of the overlay as drawn, None where there is none."""
        drawn = self._coarse_overlay if self.is_coarse else self._overlay
        if drawn.polydata is None:
            drawn = self._overlay
        return None if drawn.polydata is None else np.array(drawn.polydata.points)

    # Detail: a stand-in while something moves and a frame in full would be slow

    @property
    def is_slow(self) -> bool:
        """Whether a frame in full detail takes longer than the eye forgives in motion."""
        return self._full_frame_seconds > SLOW_FRAME

    @property
    def is_coarse(self) -> bool:
        """Whether the stand-in is drawn now."""
        return self._is_moving and self.is_slow

    def set_warping(self, warping: bool) -> None:
        """Say whether the overlay is being moved by the hand."""
        if warping != self._warping:
            self._warping = warping
            self._choose_detail()

    def set_orbiting(self, orbiting: bool) -> None:
        """Say whether the camera is being moved by the hand."""
        if orbiting != self._orbiting:
            self._orbiting = orbiting
            self._choose_detail()
            self.orbiting_changed.emit(orbiting)

    @property
    def _is_moving(self) -> bool:
        return self._warping or self._orbiting

    def _choose_detail(self) -> None:
        coarse, scene = self.is_coarse, self._scene
        # Smoothed edges cost half a frame in software: they can wait until things rest.
        self.renderer.SetUseFXAA(not self._is_moving)
        overlay_visible = scene is not None and scene.overlay_visible
        for full, stand_in, visible in (
            (self._full, self._coarse, True),
            (self._overlay, self._coarse_overlay, overlay_visible),
        ):
            replaced = coarse and stand_in.actor is not None
            full.set_visible(visible and not replaced)
            stand_in.set_visible(visible and replaced)
        for drawn in (self._overlay, self._coarse_overlay):
            if scene is not None and drawn.actor is not None:
                coloured = drawn.is_coloured
                drawn.actor.prop.opacity = scene.map_opacity if coloured else scene.overlay_opacity
        self._folds.set_visible(overlay_visible)
        shows_map = overlay_visible and self._overlay.is_coloured
        for drawn in (self._full, self._coarse):
            drawn.set_depth(DEPTH_BEHIND_MAP if shows_map else WHOLE_DEPTH)
        front = MAP_DEPTH if shows_map else WHOLE_DEPTH
        for over in (self._overlay, self._coarse_overlay, self._folds, self._grid):
            over.set_depth(front)
        self.update()

    def paintGL(self) -> None:
        """Render, and remember what a frame in full detail costs."""
        super().paintGL()
        if not self.is_coarse and self._full.actor is not None:
            # The first frame uploads everything: the cheapest one seen tells the truth, slowly
            # forgotten in case the machine has become busier.
            cheapest = self._full_frame_seconds or self.frame_seconds
            self._full_frame_seconds = min(cheapest * 1.1, self.frame_seconds)

    # The camera

    @property
    def bone(self) -> pv.PolyData | None:
        """What the camera is fitted to: this side's mesh, else the overlay, else None."""
        return self.surface.polydata if self.surface is not None else self._overlay.polydata

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

    def view_key(self) -> tuple[Any, ...]:
        """Return what decides which landmarks are hidden: camera, size and mesh."""
        share = self._section.share if self._section is not None else None
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
        start = near if self._section is None else self._section.entry(near, far)
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
            start = eye if self._section is None else self._section.entry(eye, position)
            hidden[i] = start is None or self.surface.hides(start, position)
        return hidden

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the sheet as large as the picture."""
        super().resizeEvent(event)
        self.layer.resize(event.size())
        self.map_legend.place()
