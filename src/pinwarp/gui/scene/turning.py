"""From which side a place is seen, when the bone hides it from where the camera is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from pinwarp.gui.scene.camera_pose import Matrix, Pose

# So many directions are tried, evenly spread: 8 degrees apart.
_DIRECTIONS = 600
# A place is looked at from no further than this off the middle of where it is seen from: beyond,
# it would lie at the bone's edge in the picture. The cosine of 60 degrees.
_LEAST_COSINE = 0.5
# Nearer to the line of sight than this (a sine), what was up tells no new up.
_LEAST_UPRIGHT = 0.3


def turned_to_see(
    pose: Pose,
    place: Matrix,
    axis: Matrix,
    is_hidden: Callable[[Matrix, Matrix], NDArray[np.bool_]],
    *,
    in_reach: bool,
) -> Pose:
    """Return a pose that sees a place, turned from another one by little.

    The less it turns the better, and the less the bone is foreshortened: rather around its long
    axis than over its end.

    Parameters
    ----------
    pose
        A proper one.
    place
        (3,) where to look.
    axis
        (3,) unit vector along the bone.
    is_hidden
        Called with (n, 3) eyes and (n, 3) places: which of these their eyes do not see.
    in_reach
        Whether the place stays in the picture while the camera turns about what it looks at;
        else it gets into the middle.

    Returns
    -------
    Pose
        From the same side as before where the place is seen from nowhere.

    Examples
    --------
    >>> before = Pose(np.array([0.0, 0.0, 9.0]), np.zeros(3), np.array([0.0, 1.0, 0.0]))
    >>> behind = lambda eyes, places: (eyes * places).sum(axis=1) < 1
    >>> place, along = np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])
    >>> after = turned_to_see(before, place, along, behind, in_reach=True)
    >>> bool(after.position[2] < -4), bool(abs(after.position[1]) < 1), round(after.distance, 6)
    (True, True, 9.0)
    """
    focus = pose.focal_point if in_reach else place
    towards = _even_directions()
    eyes = focus + pose.distance * towards
    seen = ~is_hidden(eyes, np.broadcast_to(place, eyes.shape))
    if not seen.any():
        return pose.focused(focus, pose.distance)
    middle = towards[seen].mean(axis=0)
    middle = middle / max(float(np.linalg.norm(middle)), 1e-12)
    faces = seen & (towards @ middle >= _LEAST_COSINE)
    if not faces.any():
        faces = seen
    turn = np.arccos(np.clip(towards @ pose.frame[:, 2], -1.0, 1.0))
    foreshortened = np.abs(np.arcsin(np.clip(towards @ axis, -1.0, 1.0)))
    back = towards[np.argmin(np.where(faces, turn + foreshortened, np.inf))]
    # Upright as before, unless it lay down.
    up = next(
        (
            one
            for one in (np.copysign(1.0, axis @ pose.frame[:, 1]) * axis, *pose.frame.T[[1, 0]])
            if np.linalg.norm(np.cross(one, back)) > _LEAST_UPRIGHT
        ),
        pose.frame[:, 1],
    )
    return replace(pose, position=focus + pose.distance * back, focal_point=focus, up=up)


@cache
def _even_directions() -> Matrix:
    """Return (n, 3) unit vectors, evenly spread (a spiral by the golden angle)."""
    number = np.arange(_DIRECTIONS) + 0.5
    height = 1 - 2 * number / _DIRECTIONS
    angle = np.pi * (1 + 5**0.5) * number
    radius = np.sqrt(1 - height**2)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
