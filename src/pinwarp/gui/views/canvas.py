"""One side's picture: a scene, and a camera before it."""

from __future__ import annotations

import weakref
from collections.abc import Hashable, Sequence
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
from pinwarp.gui.painted.file_notes import FileNotes
from pinwarp.gui.painted.legend import PaintedLegend
from pinwarp.gui.painted.marker_layer import MarkerLayer
from pinwarp.gui.scene.camera_pose import Matrix, Pose, best_frame, fitted
from pinwarp.gui.scene.drawables import (
    Caption,
    Drawable,
    GridLines,
    Legend,
    Markers,
    Motion,
    Overlay,
)
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.scene.sight import through_ball
from pinwarp.gui.scene.turning import turned_to_see
from pinwarp.gui.style import theme
from pinwarp.gui.views.sighted_view import NOWHERE, SightedView

Kind = TypeVar("Kind", bound=Drawable)

# A frame slower than this is replaced by a stand-in's while something moves.
SLOW_FRAME = 0.030
# Whether edges are smoothed where things rest: it costs half a frame in software.
SMOOTH_EDGES = True
# How near and how far a hand may bring the camera to what it looks at, in diagonals of the bone.
NEAREST, FURTHEST = 1e-3, 50.0
# A click this many pixels beside the bone is meant for the bone.
OUTLINE_REACH = 6
# How the surface beside a line of sight is found: places looked at first, turns at most, when it
# has settled (in diagonals of the bone), and how near to the outline (in pixels).
NEAR_PLACES, TURNS, SETTLED, OUTLINE = 5000, 30, 1e-5, 0.25
# What is no further from what the camera looks at stays in a view however the camera turns: a share
# of half the height that is seen.
IN_REACH = 0.9


class Canvas(SightedView):
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
        self._stage = DrawnScene(self.plotter, side, surfaces)
        self.layer = MarkerLayer(self, self)
        self.map_legend = PaintedLegend(self)
        self.layer.give_way_to(self.map_legend)
        self.file_notes = FileNotes(self)
        self._full_frame_seconds = 0.0
        self._orbiting = False
        self._is_dark: bool | None = None
        self.set_dark(False)
        self.setMinimumSize(160, 160)

    def set_dark(self, dark: bool) -> None:
        """Put the bones before a dark background, or before a light one."""
        if dark is self._is_dark:
            return
        self._is_dark = dark
        bottom, top = theme.backgrounds(dark)
        self.renderer.set_background(bottom, top=top)
        self.update()
        self.layer.set_dark(dark)
        self.file_notes.set_dark(dark)

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
        was_empty = self.bone is None
        changed = self._stage.show(scene)
        # The sheet repaints by itself: no bone is rendered anew for a label.
        self.layer.show_scene(scene)
        if scene.of(Legend) != self.map_legend.content:
            self.map_legend.show_content(scene.of(Legend))
            # Labels give way to it.
            self.layer.update()
        caption = scene.of(Caption)
        self.file_notes.show_notes(caption.notes if caption is not None else ())
        if self.surface is not surface:
            self._full_frame_seconds = 0.0
            self.look_at_all()
        elif was_empty and self.bone is not None:
            self.look_at_all()
        elif changed & {Overlay, GridLines}:
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
        self.renderer.SetUseFXAA(SMOOTH_EDGES and not self._is_moving)
        self._stage.set_coarse(self.is_coarse)
        self.update()

    def render_frame(self, width: int, height: int) -> None:
        """Render, and remember what a frame in full detail costs."""
        super().render_frame(width, height)
        if not self.is_coarse and self.surface is not None:
            # The first frame uploads everything: the cheapest one seen tells the truth, slowly
            # forgotten in case the machine has become busier.
            cheapest = self._full_frame_seconds or self.frame_seconds
            self._full_frame_seconds = min(cheapest * 1.1, self.frame_seconds)

    # The camera

    @property
    def bone(self) -> pv.PolyData | None:
        """What the camera is fitted to: this side's mesh, else the overlay, else its landmarks."""
        return self._stage.bone or self._points

    @property
    def _points(self) -> pv.PolyData | None:
        """The landmarks as far as they are all there is; None for fewer than two places."""
        markers = self.drawn(Markers)
        places = np.array([m.position for m in markers.markers] if markers is not None else [])
        if len(places) < 2 or not np.ptp(places, axis=0).any():
            return None
        return pv.PolyData(places)

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

    def stay_in_reach(self) -> None:
        """Bring the camera back where a hand has taken it nearer or further than is of use."""
        bone, pose = self.bone, Pose.of(self.camera)
        if bone is None:
            return
        if not pose.is_proper:
            self.look_at_all()
            return
        size = float(np.linalg.norm(bone.bounds_size)) or 1.0
        distance = float(np.clip(pose.distance, NEAREST * size, FURTHEST * size))
        if distance != pose.distance:
            # Not as a placed pose: a linked camera comes along.
            self.camera.SetPosition(pose.focused(pose.focal_point, distance).position)
            self.renderer.ResetCameraClippingRange()

    def view_key(self) -> Hashable:
        """Return what decides which landmarks are hidden: camera, size and mesh."""
        share = self.section.share if self.section is not None else None
        camera = self.camera
        # Not its time stamp: the clipping range changes with every warp, and hides nothing.
        pose = (camera.GetPosition(), camera.GetFocalPoint(), camera.GetViewUp())
        lens = (camera.GetViewAngle(), camera.GetParallelScale(), camera.GetParallelProjection())
        # Not the surface itself: who remembers a key would keep it when its session is closed.
        surface = weakref.ref(self.surface) if self.surface is not None else None
        return (pose, lens, self.width(), self.height(), surface, share)

    def pick(self, at: QPointF, reach: float = 0.0) -> NDArray | None:
        """Return the position on the surface under a place on the screen.

        Parameters
        ----------
        at
            The place, in logical pixels.
        reach
            Beside the surface the nearest position of it that is seen is taken, up to this many
            pixels away.

        Returns
        -------
        (3,) float64 or None
            None where there is nothing.
        """
        met = self._under(at)
        return self._beside(at, reach) if met is None and reach else met

    def _beside(self, at: QPointF, reach: float) -> NDArray | None:
        """Return the seen position of the surface nearest to a line of sight that misses it."""
        surface, ray = self.surface, self._ray(at)
        if surface is None or ray is None:
            return None
        start, direction = ray
        points = np.asarray(surface.polydata.points)
        some = points[:: max(1, len(points) // NEAR_PLACES)]
        apart = self.project(some) - [at.x(), at.y()]
        position = np.asarray(some[np.argmin(np.sum(apart**2, axis=1))], dtype=np.float64)
        for _ in range(TURNS):
            # From the line to the surface and back: the two come as near as they get.
            along = max(0.0, float((position - start) @ direction))
            last, (position, _) = position, surface.closest(start + along * direction)
            if np.linalg.norm(position - last) < SETTLED * surface.diagonal:
                break
        ((x, y),) = self.project(position[None])
        way = QPointF(x, y) - at
        length = float(np.hypot(way.x(), way.y()))
        if length > min(reach, NOWHERE / 2):
            return None
        # A line of sight that only touches the outline may miss it by rounding: a little inwards.
        inwards = 1.0 + 2.0 / max(length, 1e-3)
        missing, meeting, met = 0.0, inwards, self._under(at + way * inwards)
        while met is not None and (meeting - missing) * length > OUTLINE:
            middle = (missing + meeting) / 2
            there = self._under(at + way * middle)
            if there is None:
                missing = middle
            else:
                meeting, met = middle, there
        return met

    def _under(self, at: QPointF) -> NDArray | None:
        ray = self._ray(at)
        if self.surface is None or ray is None:
            return None
        part = through_ball(*ray, np.array(self.surface.polydata.center), self.surface.diagonal)
        if part is None:
            return None
        near, far = part
        start = near if self.section is None else self.section.entry(near, far)
        return self.surface.first_hit(start, far) if start is not None else None

    @property
    def is_bone_lost(self) -> bool:
        """Whether there is a bone but nothing of it in the view."""
        return self.bone is not None and not self.is_bone_seen

    @property
    def is_bone_seen(self) -> bool:
        """Whether any of the bone is in the view, as far as a look at some of its places tells."""
        bone, sight = self.bone, self.sight
        if bone is None or sight is None:
            return False
        places = sight.places(np.asarray(bone.points)[:: max(1, bone.n_points // 1000)])
        if (np.abs(places) <= 1).all(axis=1).any():
            return True
        # From so near that it may be seen between those.
        shares = (0.05, 0.25, 0.5, 0.75, 0.95)
        spots = [QPointF(self.width() * x, self.height() * y) for x in shares for y in shares]
        return any(self.pick(spot) is not None for spot in spots)

    def sees(self, position: Sequence[float]) -> bool:
        """Whether a position is in the view, and no bone before it."""
        sight, place = self.sight, np.array([position])
        if sight is None or not (np.abs(sight.places(place)) <= 1).all():
            return False
        return not self.behind_surface(place)[0]

    def pose_to_see(self, position: Sequence[float]) -> Pose:
        """Return where the camera sees a position, turned by as little as that takes."""
        pose, surface, place = Pose.of(self.camera), self.surface, np.array(position)
        bone = self.bone
        if not pose.is_proper or surface is None or bone is None:
            return pose
        sight = self.sight
        half = 0.0 if sight is None else sight.units_per_height(pose.focal_point)
        in_reach = bool(np.linalg.norm(place - pose.focal_point) < IN_REACH * half)
        axis = best_frame(bone.bounds_size)[:, 1]
        return turned_to_see(pose, place, axis, surface.hidden, in_reach=in_reach)

    def behind_surface(self, positions: NDArray) -> NDArray[np.bool_]:
        """Return which positions the mesh hides from the camera."""
        hidden, sight = np.zeros(len(positions), dtype=bool), self.sight
        if self.surface is None or sight is None:
            return hidden
        eye = sight.eye
        if sight.is_parallel:
            eye = eye - sight.along * 1e3 * self.surface.diagonal
        if self.section is None:
            return self.surface.hidden(eye, np.asarray(positions))
        starts = [self.section.entry(eye, position) for position in positions]
        # What is clipped away neither hides nor can be grabbed.
        seen = np.array([start is not None for start in starts], dtype=bool)
        hidden[~seen] = True
        if seen.any():
            eyes = np.array([start for start in starts if start is not None])
            hidden[seen] = self.surface.hidden(eyes, np.asarray(positions)[seen])
        return hidden

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the sheet as large as the picture."""
        super().resizeEvent(event)
        self.layer.resize(event.size())
        self.map_legend.place()
        self.file_notes.place()
