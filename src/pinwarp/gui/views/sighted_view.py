"""A view that knows where things are on its screen, wherever its camera stands."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np
from numpy.typing import NDArray
from qtpy.QtCore import QPointF
from qtpy.QtWidgets import QWidget

from pinwarp.gui.scene.camera_pose import Pose
from pinwarp.gui.scene.sight import Sight
from pinwarp.gui.views.fast_view import FastView

# On the screen, where what is not seen is: far off, and yet no number that Qt cannot draw.
NOWHERE = 1e6


class SightedView(FastView):
    """A camera, and how the screen and the space before it correspond.

    Attributes
    ----------
    is_placing_camera : bool
        Whether the camera is being put somewhere by no hand.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.is_placing_camera = False
        self._seen: tuple[Hashable, Sight | None] = (None, None)
        mend = self.renderer.AddObserver("ResetCameraClippingRangeEvent", self._mend_depth)
        self._observers.append((self.renderer, mend))

    def set_pose(self, pose: Pose) -> None:
        """Put the camera somewhere; :attr:`is_placing_camera` tells that no hand moves it."""
        camera, self.is_placing_camera = self.camera, True
        camera.SetFocalPoint(pose.focal_point)
        camera.SetPosition(pose.position)
        camera.SetViewUp(pose.up)
        camera.SetParallelScale(pose.parallel_scale)
        self.is_placing_camera = False
        self.renderer.ResetCameraClippingRange()
        self.update()

    def _mend_depth(self, *_event: object) -> None:
        """Keep a depth to draw in, also where all bones are behind the camera."""
        camera = self.camera
        near, far = camera.GetClippingRange()
        if camera.GetParallelProjection() and -np.inf < near < far < np.inf:
            return
        if not (0 < near < far < np.inf and far < 1e7 * near):
            distance = camera.GetDistance()
            camera.SetClippingRange(0.01 * distance, 100 * distance)

    @property
    def sight(self) -> Sight | None:
        """What the camera sees; None for one that looks nowhere."""
        # Asked many times between two moves of the camera. Time stamps are no other camera's.
        key = (self.camera.GetMTime(), self.width(), self.height())
        if key != self._seen[0]:
            aspect = max(1, self.width()) / max(1, self.height())
            self._seen = (key, Sight.of(self.camera, aspect))
        return self._seen[1]

    @property
    def unit_per_pixel(self) -> float:
        """The length that a logical pixel shows where the camera looks, in mesh units."""
        sight = self.sight
        shown = sight.units_per_height(self.camera.GetFocalPoint()) if sight is not None else 0.0
        return 2 * shown / max(1, self.height())

    def project(self, points: NDArray) -> NDArray:
        """Return where (n, 3) positions are on the screen: (n, 2) logical pixels."""
        sight = self.sight
        if sight is None:
            return np.full((len(points), 2), -NOWHERE)
        places = (sight.places(points) * [1, -1] + 1) / 2 * [self.width(), self.height()]
        return np.clip(np.nan_to_num(places, nan=-NOWHERE), -NOWHERE, NOWHERE)

    def _ray(self, at: QPointF) -> tuple[NDArray, NDArray] | None:
        """Return where the line of sight through a place begins, and its direction."""
        sight = self.sight
        if sight is None:
            return None
        return sight.ray(
            2 * at.x() / max(1, self.width()) - 1, 1 - 2 * at.y() / max(1, self.height())
        )

    def in_view_plane(self, at: QPointF, through: NDArray) -> NDArray:
        """Return the position under a place on the screen, as deep in the view as another one."""
        ray, sight = self._ray(at), self.sight
        if ray is None or sight is None:
            return through
        start, direction = ray
        depth = (through - start) @ sight.along / (direction @ sight.along)
        return start + direction * float(depth)

    def view_axes(self) -> tuple[NDArray, NDArray]:
        """Return the unit vectors that point right and up on the screen."""
        sight = self.sight
        frame = sight.frame if sight is not None else np.eye(3)
        return frame[:, 0], frame[:, 1]

    def pixels_per_unit(self, position: NDArray) -> float:
        """Return how many logical pixels a mesh unit takes at a position; 0 where it is unseen."""
        sight = self.sight
        return 0.0 if sight is None else self.height() / 2 / sight.units_per_height(position)
