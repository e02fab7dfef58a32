"""What readings look like: the source as it is, and as each of them lays it on the destination."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from qtpy.QtGui import QImage
from scipy.spatial.distance import cdist

from pinwarp.core.guessed import Reading
from pinwarp.core.landmarks import LandmarkState, Position, Side
from pinwarp.gui.drawn.surface import Surface, shading_normals, triangles
from pinwarp.gui.exporting.picture import picture_of
from pinwarp.gui.scene.camera_pose import Matrix, Pose
from pinwarp.gui.scene.drawables import Bone, Drawable, Marker, Markers, Overlay, OverlayWarp
from pinwarp.gui.scene.fronts import fronts
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.views.canvas import Canvas
from pinwarp.session.session import Session
from pinwarp.session.suggesting import ghosts_of
from pinwarp.session.suggesting.guessing import missing_of

# So many landmarks are named in a picture, those furthest from one another.
MOST_NAMED = 4
_RADIUS, _OPACITY = 4.0, 0.6


def drawn_reading(reading: Reading, surface: Surface) -> OverlayWarp:
    """Return the source as a reading warps it, coarsely where it is large; for the worker."""
    mesh = surface.stand_in or surface.mesh
    assert mesh is not None, "the session holds it"
    vertices = np.asarray(reading.spline.evaluate(mesh.vertices), np.float32)
    normals = shading_normals(triangles(vertices, mesh.faces))
    return OverlayWarp(mesh, vertices, normals, surface.inside_out != reading.mirrored)


@dataclass(frozen=True, eq=False)
class ReadingPictures:
    """Makes pictures that can be compared: all show the bone from the same anatomical side.

    So the same hand looks as the source does, and the other hand as in a mirror.

    Parameters
    ----------
    views
        Of both sides; where they look is put back.
    session
        Whose landmarks are named.
    width, height
        Of a picture, in pixels.
    """

    views: Mapping[Side, Canvas]
    session: Session
    width: int
    height: int

    def of_source(self) -> QImage:
        """Return a picture of the source with the landmarks that are missing."""
        return self._picture(Side.SOURCE, self._front(), self._sources(), LandmarkState.SOURCE_ONLY)

    def of_reading(self, reading: Reading, drawn: OverlayWarp) -> QImage:
        """Return a picture of a reading; ``drawn`` is what :func:`drawn_reading` made of it."""
        front = reading.pose.rotation @ self._front()
        # From the same side also in a mirror: a frame is no mirror image.
        front[:, 0] = np.cross(front[:, 1], front[:, 2])
        places = {ghost.name: ghost.position for ghost in ghosts_of(reading, self.session)}
        overlay = Overlay(drawn, opacity=_OPACITY)
        return self._picture(Side.DESTINATION, front, places, LandmarkState.SUGGESTED, overlay)

    def _sources(self) -> dict[str, Position]:
        return {x.name: x.source for x in missing_of(self.session) if x.source is not None}

    @cached_property
    def _named(self) -> frozenset[str]:
        """A few landmarks that are seen far apart in the source's picture: named in all."""
        sources = self._sources()
        names, positions = list(sources), np.array(list(sources.values()))
        view = self.views[Side.SOURCE]
        with _looking_from(view, self._front()):
            seen = np.flatnonzero(~view.behind_surface(positions))
            places = view.project(positions)
        rows = (seen if len(seen) else np.arange(len(names))).tolist()
        chosen = rows[:1]
        while len(chosen) < min(MOST_NAMED, len(rows)):
            apart = cdist(places[rows], places[chosen]).min(axis=1)
            chosen.append(rows[int(np.argmax(apart))])
        return frozenset(names[row] for row in chosen)

    def _front(self) -> Matrix:
        bones = {side: view.bone for side, view in self.views.items() if view.bone is not None}
        return fronts(bones, None)[Side.SOURCE]

    def _picture(
        self,
        side: Side,
        front: Matrix,
        places: Mapping[str, Position],
        state: LandmarkState,
        *also: Drawable,
    ) -> QImage:
        view, mesh = self.views[side], self.session.mesh(side)
        assert mesh is not None, "a reading is of two meshes"
        markers = tuple(
            Marker(name, place, state, labelled=name in self._named)
            for name, place in places.items()
        )
        scene = Scene(side, (Bone(mesh), Markers(markers, _RADIUS), *also))
        with _looking_from(view, front):
            return picture_of(view, scene, self.width, self.height)


@contextmanager
def _looking_from(view: Canvas, front: Matrix) -> Iterator[None]:
    """Look at the whole bone from a side; nothing is painted before the camera is back."""
    before = Pose.of(view.camera)
    view.look_at_all(front)
    try:
        yield
    finally:
        view.set_pose(before)
