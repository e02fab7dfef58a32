"""The mesh: vertices and triangles as read-only arrays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.positions import LARGEST_COORDINATE, all_usable, as_numbers, first_row


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle surface. Two meshes are equal only when they are the same object.

    Parameters
    ----------
    vertices
        (m, 3) float64, in the mesh's own frame and unit; made read-only.
    faces
        (t, 3) int32, indices into ``vertices``; made read-only.

    Raises
    ------
    MeshError
        When the arrays have other shapes, are empty, hold numbers that are not finite or beyond
        1e150, or a face names a vertex that does not exist.

    Examples
    --------
    >>> triangle = Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> round(triangle.diagonal, 6)
    2.236068
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None:
        try:
            points = as_numbers(vertices, "vertex")
            triangles = as_numbers(faces, "face") if not _are_integers(faces) else np.array(faces)
        except LandmarkError as error:
            raise MeshError(str(error)) from error
        if points.ndim != 2 or points.shape[1] != 3:
            raise MeshError(f"Vertices have the shape {points.shape} instead of (m, 3).")
        if triangles.ndim != 2 or triangles.shape[1] != 3:
            raise MeshError(f"Faces have the shape {triangles.shape} instead of (t, 3).")
        if len(points) == 0 or len(triangles) == 0:
            raise MeshError("The mesh holds no triangles.")
        if not all_usable(points):
            row = first_row(~(np.abs(points) <= LARGEST_COORDINATE))
            what = "too large" if np.isfinite(points[row]).all() else "not finite"
            raise MeshError(f"Vertex {row} has a coordinate that is {what}: {points[row]}.")
        # NaN compares as false.
        if not (triangles.min() >= 0 and triangles.max() < len(points)):
            raise MeshError("A face names a vertex that does not exist.")
        rounded = triangles.astype(np.int32, order="C")
        if triangles.dtype.kind == "f" and (rounded != triangles).any():
            raise MeshError("A face names a vertex by a number that is not whole.")
        triangles = rounded
        points.setflags(write=False)
        triangles.setflags(write=False)
        object.__setattr__(self, "vertices", points)
        object.__setattr__(self, "faces", triangles)

    def with_vertices(self, vertices: ArrayLike) -> Mesh:
        """Return the same triangles over other vertices."""
        return Mesh(vertices, self.faces)

    @cached_property
    def on_surface(self) -> NDArray[np.bool_]:
        """Which vertices belong to a triangle; made read-only."""
        used = np.zeros(len(self.vertices), dtype=np.bool_)
        used[self.faces] = True
        used.setflags(write=False)
        return used

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The (2, 3) lowest and highest corner of the bounding box."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def diagonal(self) -> float:
        """The length of the bounding box's diagonal, in the mesh's unit."""
        low, high = self.bounds
        return float(np.linalg.norm(high - low))


def _are_integers(values: ArrayLike) -> bool:
    return type(values) is np.ndarray and values.dtype.kind in "iu"
