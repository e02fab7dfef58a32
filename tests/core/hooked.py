"""A small bone of our own, neither its own mirror image nor alike at both ends, and a warp."""

from __future__ import annotations

import numpy as np
from tests.core import bones

from pinwarp.core.mesh import Mesh


def hooked(around=16, along=24) -> Mesh:
    """A bent club with a spur that points out of the bend, about 200 mm long."""
    tube = bones.bone(around, along)
    return tube.with_vertices(_placed(tube.vertices))


def places(count=24) -> np.ndarray:
    """Places on it."""
    return _placed(bones.landmarks(count))


def _placed(points: np.ndarray) -> np.ndarray:
    x, y, z = points.T
    thick = 1.6 + 0.8 * np.tanh(z / 40)
    spur = 45 * np.exp(-(((z - 45) / 22) ** 2)) * np.clip(y / 12, 0, None)
    bend = 0.004 * (z - 20) ** 2
    return np.column_stack([x * thick + bend, y * thick + spur, z + 0.3 * spur])


def truth(points: np.ndarray) -> np.ndarray:
    """Where a place of it goes on the subject: stretched and bent, nowhere folded."""
    x, y, z = np.asarray(points).T
    bend = [5 * np.sin(z / 40), 3 * np.sin(x / 30), 4 * np.sin(y / 30)]
    return points * [1.06, 0.96, 1.08] + np.column_stack(bend)


def subject(mesh: Mesh, turn=None, unit=1.0, *, mirrored=False) -> Mesh:
    """The subject's bone, turned, in another unit, and as the other hand."""
    faces = mesh.faces[:, ::-1] if mirrored else mesh.faces
    return Mesh(carried(mesh.vertices, turn, unit, mirrored=mirrored), faces)


def carried(points: np.ndarray, turn=None, unit=1.0, *, mirrored=False) -> np.ndarray:
    """Where places go on such a subject."""
    hand = np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0])
    turn = np.eye(3) if turn is None else turn
    return unit * (truth(points) @ (turn @ hand).T + [40.0, -70.0, 110.0])
