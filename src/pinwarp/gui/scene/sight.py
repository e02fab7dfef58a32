"""What a camera sees, told from its pose and lens alone: no window and no clipping range here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.gui.scene.camera_pose import FARAWAY, Matrix, Pose


@dataclass(frozen=True, eq=False)
class Sight:
    """A camera that has a direction and an up across it.

    Places in the view run from -1 to 1, rightwards and upwards.

    Attributes
    ----------
    eye : (3,) float64
    frame : (3, 3) float64
        Columns right, up, and back towards the eye.
    half_height : float
        Of what is seen: at distance 1 in a perspective, everywhere in a parallel projection.
    aspect : float
        Width by height of the view.
    is_parallel : bool
    """

    eye: Matrix
    frame: Matrix
    half_height: float
    aspect: float
    is_parallel: bool = False

    @classmethod
    def of(cls, camera: Any, aspect: float) -> Sight | None:
        """Read a VTK camera; None for one that looks nowhere.

        Parameters
        ----------
        camera
            Any VTK camera, whatever became of it.
        aspect
            Width by height of the view.
        """
        pose = Pose.of(camera)
        parallel = bool(camera.GetParallelProjection())
        tangent = float(np.tan(np.radians(camera.GetViewAngle()) / 2))
        half_height = pose.parallel_scale if parallel else tangent
        if not (pose.is_proper and 0 < half_height < FARAWAY):
            return None
        return cls(pose.position, pose.frame, half_height, aspect, parallel)

    @property
    def along(self) -> Matrix:
        """The (3,) unit vector from the eye into the picture."""
        return -self.frame[:, 2]

    def places(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return where (n, 3) positions are in the view: (n, 2), not a number behind the eye."""
        right, up, depth = self._seen(points)
        half = self._half_heights(depth)
        with np.errstate(over="ignore"):
            return np.column_stack([right / half / self.aspect, up / half])

    def units_per_height(self, point: Sequence[float] | Matrix) -> float:
        """Return the length that half the view's height shows at a position; inf behind the eye."""
        half = self._half_heights(self._seen(np.asarray(point)[None])[2])
        return float(np.nan_to_num(half, nan=np.inf)[0])

    def ray(self, x: float, y: float) -> tuple[Matrix, Matrix]:
        """Return where the line of sight through a place begins, and its unit direction."""
        across = self.frame[:, 0] * (x * self.aspect) + self.frame[:, 1] * y
        if self.is_parallel:
            return self.eye + across * self.half_height, self.along
        direction = self.along + across * self.half_height
        return self.eye, direction / np.linalg.norm(direction)

    def _seen(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return (3, n) how far right, up, and deep positions are from the eye."""
        apart = np.asarray(points, dtype=np.float64) - self.eye
        return (apart @ (self.frame * [1.0, 1.0, -1.0])).T

    def _half_heights(self, depth: NDArray[np.float64]) -> NDArray[np.float64]:
        if self.is_parallel:
            return np.full(depth.shape, self.half_height)
        # What lies behind the camera must not appear in front of it.
        return np.where(depth > 0, np.maximum(depth * self.half_height, 1e-300), np.nan)


def through_ball(
    start: Matrix, direction: Matrix, centre: Matrix, radius: float
) -> tuple[Matrix, Matrix] | None:
    """Return the part of a line of sight that can meet what a ball holds; None where none can.

    Parameters
    ----------
    start, direction
        Where the line begins, and its unit direction.
    centre, radius
        The ball.

    Examples
    --------
    >>> start, along = np.array([0.0, 0.0, -9.0]), np.array([0.0, 0.0, 1.0])
    >>> [end.tolist() for end in through_ball(start, along, np.zeros(3), 2.0)]
    [[0.0, 0.0, -2.0], [0.0, 0.0, 2.0]]
    >>> through_ball(start, -along, np.zeros(3), 2.0) is None
    True
    """
    middle = float((centre - start) @ direction)
    nearest = start + direction * middle
    if middle + radius <= 0 or not np.linalg.norm(nearest - centre) <= radius:
        return None
    return start + direction * max(0.0, middle - radius), nearest + direction * radius
