"""Where a camera stands, and how one bone's camera corresponds to the other's: no window here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.alignment import Similarity, fit_similarity
from pinwarp.core.landmarks import Position

Matrix = NDArray[np.float64]

# Share of the view that a fitted bone fills: the title and the scale bar want some room.
FILLED = 0.86
# So many times as long as wide, a bone stands upright whatever its frame says.
LONG = 2.0
# Positions less spread than this, compared with their longest direction, fix no turn about it.
LEAST_SPREAD = 0.04
# Squares of what is beyond, or nearer than its inverse, leave the range of numbers.
FARAWAY = 1e100


class StandardView(StrEnum):
    """The six sides; the front is the side that Fit shows."""

    FRONT = "front"
    BACK = "back"
    LEFT = "left"
    RIGHT = "right"
    TOP = "top"
    BOTTOM = "bottom"


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a camera is, what it looks at, and what is up.

    Attributes
    ----------
    position, focal_point, up : (3,) float64
    parallel_scale : float
        Half the height of the view in a parallel projection.
    """

    position: Matrix
    focal_point: Matrix
    up: Matrix
    parallel_scale: float = 1.0

    @classmethod
    def of(cls, camera: Any) -> Pose:
        """Read the pose of a VTK camera."""
        return cls(
            np.array(camera.GetPosition()),
            np.array(camera.GetFocalPoint()),
            np.array(camera.GetViewUp()),
            float(camera.GetParallelScale()),
        )

    @classmethod
    def looking(
        cls, frame: Matrix, focal_point: ArrayLike, distance: float, parallel_scale: float = 1.0
    ) -> Pose:
        """Make a pose from a frame: columns right, up, and back towards the eye."""
        focal = np.asarray(focal_point, dtype=np.float64)
        return cls(focal + distance * frame[:, 2], focal, frame[:, 1].copy(), parallel_scale)

    @property
    def distance(self) -> float:
        """How far the camera is from what it looks at."""
        return float(np.linalg.norm(self.position - self.focal_point))

    @property
    def is_proper(self) -> bool:
        """Whether it has a direction and an up across it: not so halfway through a change."""
        places = np.abs([self.position, self.focal_point])
        # Written so that what is no number is not proper either.
        if not (places.max() < FARAWAY and 0 < np.abs(self.up).max() < np.inf):
            return False
        if not np.abs(self.position - self.focal_point).max() > 1 / FARAWAY:
            return False
        up, back = _direction(self.up), _direction(self.position - self.focal_point)
        return bool(np.linalg.norm(np.cross(up, back)) > 1e-9)

    @property
    def frame(self) -> Matrix:
        """The (3, 3) rotation with columns right, up, and back towards the eye."""
        back = _direction(self.position - self.focal_point)
        right = _direction(np.cross(_direction(self.up), back))
        return np.column_stack([right, np.cross(back, right), back])

    def is_at(self, other: Pose) -> bool:
        """Whether it is the very same pose."""
        return self.parallel_scale == other.parallel_scale and all(
            np.array_equal(a, b)
            for a, b in (
                (self.position, other.position),
                (self.focal_point, other.focal_point),
                (self.up, other.up),
            )
        )

    def mapped(self, relation: Similarity) -> Pose:
        """Return the pose that sees the mapped bone as this one sees the bone."""
        return Pose(
            relation.apply(self.position),
            relation.apply(self.focal_point),
            relation.rotation @ self.up,
            relation.scale * self.parallel_scale,
        )

    def turned(self, frame: Matrix) -> Pose:
        """Return the pose that looks at the same place from as far, from another side."""
        return Pose.looking(frame, self.focal_point, self.distance, self.parallel_scale)

    def focused(self, focal_point: ArrayLike, distance: float) -> Pose:
        """Return the pose that looks at another place from another distance, from this side."""
        nearer = replace(self, parallel_scale=self.parallel_scale * distance / self.distance)
        return Pose.looking(nearer.frame, focal_point, distance, nearer.parallel_scale)


def _direction(vector: Matrix) -> Matrix:
    """Return a vector at length 1, however long or short it is."""
    # The largest number first: squares of what is huge or tiny leave the range of numbers.
    scaled = vector / np.abs(vector).max()
    return np.asarray(scaled / np.linalg.norm(scaled))


def relation_of(source: Pose, destination: Pose) -> Similarity:
    """Return the map that takes one pose to the other.

    Kept while the cameras move it turns, shifts and zooms both by the same amount on the screen,
    whatever their directions were.
    """
    rotation = destination.frame @ source.frame.T
    scale = destination.distance / source.distance
    shift = destination.focal_point - scale * rotation @ source.focal_point
    return Similarity(rotation, scale, shift)


def inverse(relation: Similarity) -> Similarity:
    """Return the map back.

    Examples
    --------
    >>> there = Similarity(np.eye(3), 2.0, np.array([1.0, 0.0, 0.0]))
    >>> inverse(there).apply(there.apply([3.0, 4.0, 5.0])).tolist()
    [3.0, 4.0, 5.0]
    """
    back = relation.rotation.T / relation.scale
    return Similarity(relation.rotation.T, 1 / relation.scale, -back @ relation.translation)


def pairing_fit(source: Sequence[Position], destination: Sequence[Position]) -> Similarity | None:
    """Return the similarity between two bones as their pairs tell it.

    None with fewer than three pairs, and where they lie so nearly on a line that the turn about
    it would be chance.
    """
    if len(source) < 3:
        return None
    for side in (source, destination):
        positions = np.array(side)
        spread = np.linalg.svd(positions - positions.mean(axis=0), compute_uv=False)
        if spread[1] <= LEAST_SPREAD * spread[0]:
            return None
    return fit_similarity(source, destination)


def best_frame(size: ArrayLike) -> Matrix:
    """Return the frame that shows most of a bone: longest axis upright, widest across.

    No anatomical frame has x upwards: only what is long stands on it.

    Examples
    --------
    >>> best_frame([10, 400, 60])[:, 1].tolist()
    [0.0, 1.0, 0.0]
    >>> pelvis, femur = [280, 160, 220], [400, 60, 70]
    >>> best_frame(pelvis)[:, 1].tolist(), best_frame(femur)[:, 1].tolist()
    ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    """
    extent = np.asarray(size, dtype=np.float64)
    up = int(np.argmax(extent))
    if up == 0 and extent[0] < LONG * extent[1:].max():
        up = 1 + int(np.argmax(extent[1:]))
    back = min((axis for axis in range(3) if axis != up), key=lambda axis: float(extent[axis]))
    axes = np.eye(3)
    return np.column_stack([np.cross(axes[up], axes[back]), axes[up], axes[back]])


def standard_frame(front: Matrix, view: StandardView) -> Matrix:
    """Return the frame of one of the six sides, seen from the front's frame."""
    right, up, back = front.T
    towards, upright = {
        StandardView.FRONT: (back, up),
        StandardView.BACK: (-back, up),
        StandardView.LEFT: (-right, up),
        StandardView.RIGHT: (right, up),
        # From above, the front is at the lower edge; from below, at the upper.
        StandardView.TOP: (up, -back),
        StandardView.BOTTOM: (-up, back),
    }[view]
    return np.column_stack([np.cross(upright, towards), upright, towards])


def fitted(points: NDArray, frame: Matrix, view_angle: float, aspect: float) -> Pose:
    """Return the pose that shows all points, as large as they fit.

    Parameters
    ----------
    points
        (n, 3) positions.
    frame
        From which side.
    view_angle
        Of the whole height, in degrees.
    aspect
        Width by height of the view.
    """
    seen = np.asarray(points, dtype=np.float64) @ frame
    low, high = seen.min(axis=0), seen.max(axis=0)
    centre = (low + high) / 2
    across = np.abs(seen - centre)
    tangent = FILLED * float(np.tan(np.radians(view_angle) / 2))
    # Nearer points look larger: each asks for its own distance.
    needed = np.maximum(across[:, 0] / aspect, across[:, 1]) / tangent + (seen - centre)[:, 2]
    half_height = float(np.max(np.maximum(across[:, 0] / aspect, across[:, 1]))) / FILLED
    smallest = 1e-6 * float(np.linalg.norm(high - low)) or 1.0
    distance = max(float(needed.max()), smallest)
    return Pose.looking(frame, frame @ centre, distance, max(half_height, smallest))
