"""A surface made plain for a search: few enough triangles, its outside outside, its parts counted.

What is found on it answers to the surface it was made from up to the size of a triangle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pinwarp.core.mesh import Mesh
from pinwarp.core.readiness import enclosed_volume
from pinwarp.core.sampling import even_places, triangle_areas
from pinwarp.core.surface import rim_length, welded_faces

Matrix = NDArray[np.float64]

# More triangles than these are thinned out.
MOST_TRIANGLES = 150_000
# A closed grid of squares has about so many triangles for each cell that it is cut into.
TRIANGLES_OF_CELL = 3.0
# A part with a smaller share of the area than this is a splinter.
LARGE_PART = 0.1
# Places by which the size is measured.
PLACES = 3000


@dataclass(frozen=True, eq=False)
class PlainSurface:
    """A surface as a search takes it.

    Attributes
    ----------
    mesh
        The triangles, facing outwards.
    size : float
        The RMS distance of the surface from its middle, in the mesh's unit.
    parts : int
        How many large parts that do not hang together.
    rim : float
        The length of its rims over the square root of its area: 0 where it is closed.
    """

    mesh: Mesh
    size: float
    parts: int
    rim: float

    @classmethod
    def of(cls, mesh: Mesh) -> PlainSurface:
        """Return the plain surface of a mesh.

        Raises
        ------
        MeshError
            When the triangles have no area.

        Examples
        --------
        >>> corners = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]
        >>> inside_out = Mesh(corners, [[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]])
        >>> plain = PlainSurface.of(inside_out)
        >>> plain.mesh.faces[0].tolist(), plain.parts, plain.rim
        ([2, 1, 0], 1, 0.0)
        """
        size = rms_radius(even_places(mesh, PLACES)[0])
        plain = thinned(mesh, MOST_TRIANGLES)
        if enclosed_volume(plain) < 0:
            plain = Mesh(plain.vertices, plain.faces[:, ::-1])
        areas = triangle_areas(plain)
        rim = rim_length(plain) / float(np.sqrt(areas.sum()))
        return cls(plain, size, _large_parts(plain, areas), rim)


def rms_radius(positions: Matrix) -> float:
    """Return how far (m, 3) places lie from their middle, as a root mean square.

    Examples
    --------
    >>> rms_radius(np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]))
    1.0
    """
    return float(np.sqrt(np.mean(np.sum((positions - positions.mean(axis=0)) ** 2, axis=1))))


def thinned(mesh: Mesh, most: int) -> Mesh:
    """Return a mesh of about so many triangles at most: vertices in one cell become their mean.

    Rossignac and Borrel, Modeling in Computer Graphics (1993). A mesh of fewer is returned itself.

    Examples
    --------
    >>> row = np.arange(101.0)
    >>> corners = np.array([[x, y, 0.0] for x in row for y in row])
    >>> faces = [[k, k + 101, k + 1] for k in range(10_000) if k % 101 < 100]
    >>> sum(triangle_areas(thinned(Mesh(corners, faces), 1000)).tolist()) > 3000
    True
    """
    if len(mesh.faces) <= most:
        return mesh
    cell = float(np.sqrt(TRIANGLES_OF_CELL * triangle_areas(mesh).sum() / most))
    low, high = mesh.bounds
    along = np.floor((mesh.vertices - low) / cell).astype(np.int64)
    _, sides, _ = (np.floor((high - low) / cell).astype(np.int64) + 1).tolist()
    across = int((high - low)[2] // cell) + 1
    keys = (along[:, 0] * sides + along[:, 1]) * across + along[:, 2]
    _, group, counts = np.unique(keys, return_inverse=True, return_counts=True)
    sums = [np.bincount(group, mesh.vertices[:, k], len(counts)) for k in range(3)]
    faces = group[mesh.faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    return Mesh(np.column_stack(sums) / counts[:, None], faces)


def _large_parts(mesh: Mesh, areas: Matrix) -> int:
    """Return how many parts have more than a splinter's share of the area."""
    faces, count = welded_faces(mesh), len(mesh.vertices)
    begins, ends = np.concatenate([faces[:, 0], faces[:, 0]]), np.concatenate(faces[:, 1:].T)
    graph = coo_array((np.ones(len(begins), np.int8), (begins, ends)), shape=(count, count))
    part = connected_components(graph, directed=False)[1][faces[:, 0]]
    return int(np.sum(np.bincount(part, areas) > LARGE_PART * areas.sum()))
