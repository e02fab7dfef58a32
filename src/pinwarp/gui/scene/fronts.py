"""From which side bones are seen at first: upright, the head up, and both the same way up."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.camera_pose import Matrix, best_frame

# The slices across a bone, and so many triangles tell how wide they are.
_SLICES = 20
_TRIANGLES = 2000
# A triangle is as many places as fit when its edges are divided so often.
_DIVIDED = 8
# Two bones look no more alike one way up than the other, when it is by less than this.
_ALIKE = 1.05


def fronts(bones: Mapping[Side, Any], rotation: Matrix | None) -> dict[Side, Matrix]:
    """Return the frame from which each bone is seen at first.

    In the frames of models y is up, in those of scanners z, and so is the head; x never is. A
    bone that lies along x is shown the same way up as the other one: as the pairs turn it, else
    as its ends look alike.

    Parameters
    ----------
    bones
        PyVista's meshes, those that there are.
    rotation
        How the pairs turn source to destination, as far as they tell it.

    Returns
    -------
    dict
        A (3, 3) rotation with columns right, up, and back towards the eye for each.
    """
    found = {side: best_frame(bone.bounds_size) for side, bone in bones.items() if bone is not None}
    unsure = [side for side, frame in found.items() if frame[0, 1]]
    if len(found) < 2 or not unsure:
        return found
    # Where neither tells it, both are as the source is.
    turned = Side.DESTINATION if Side.DESTINATION in unsure else Side.SOURCE
    if rotation is not None:
        ups = [found[side][:, 1] for side in Side]
        is_opposed = bool((rotation @ ups[0]) @ ups[1] < 0)
    else:
        is_opposed = are_opposed(*(_profile(bones[side], found[side][:, 1]) for side in Side))
    if is_opposed:
        # About the line of sight.
        found[turned] = found[turned] * [-1.0, -1.0, 1.0]
    return found


def are_opposed(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether two bones look more alike when one of them is turned upside down.

    Parameters
    ----------
    one, other
        (2, slices) what there is to be seen of each, from its lower end to its upper.

    Examples
    --------
    >>> club = np.array([[1.0, 1.0, 3.0], [0.0, 0.0, 0.0]])
    >>> are_opposed(club, 1.1 * club), are_opposed(club, club[:, ::-1])
    (False, True)
    >>> are_opposed(club, np.ones((2, 3)))
    False
    """
    apart = float(np.linalg.norm(one - other))
    return apart > _ALIKE * float(np.linalg.norm(one - other[:, ::-1]))


def _profile(bone: Any, up: Matrix) -> NDArray[np.float64]:
    """Return how wide the slices of a bone are, and how far off its shaft, as shares of its length.

    Whatever the bone's frame is, and however fine its triangles are.
    """
    places, weights = _spread(bone)
    heights = places @ up
    length = float(np.ptp(heights)) or 1.0
    slices = np.clip((_SLICES * (heights - heights.min()) / length).astype(int), 0, _SLICES - 1)
    total = np.bincount(slices, weights, _SLICES) + 1e-300

    def mean(values: NDArray) -> NDArray[np.float64]:
        return np.asarray(np.bincount(slices, weights * values, _SLICES) / total)

    centres = np.column_stack([mean(column) for column in places.T])
    wide = np.sqrt(mean(((places - centres[slices]) ** 2).sum(axis=1)))
    # The line through the slices in the middle is the shaft.
    line = np.column_stack([np.ones(_SLICES), np.arange(_SLICES)])
    middle = slice(_SLICES // 4, -(_SLICES // 4))
    shaft = line @ np.linalg.lstsq(line[middle], centres[middle])[0]
    off = centres - shaft
    off = off - np.outer(off @ up, up)
    return np.array([wide, np.linalg.norm(off, axis=1)]) / length


def _spread(bone: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return places all over a bone, and the area that each stands for."""
    points = np.asarray(bone.points, dtype=np.float64)
    faces = np.asarray(bone.faces).reshape(-1, 4)[:, 1:]
    if not len(faces):
        # Landmarks alone.
        return points, np.ones(len(points))
    corners = points[faces[:: max(1, len(faces) // _TRIANGLES)]]
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    steps = [(i, j) for i in range(_DIVIDED) for j in range(_DIVIDED - i)]
    two = (np.array(steps) + 1 / 3) / _DIVIDED
    shares = np.column_stack([two, 1 - two.sum(axis=1)])
    return (shares @ corners).reshape(-1, 3), np.repeat(areas, len(shares))
