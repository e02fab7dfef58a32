"""A triangle surface as a warp meets it: where it is closest, where it faces, where it ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.jacobian import jacobians
from pinwarp.core.mesh import Mesh
from pinwarp.core.normals import vertex_normals
from pinwarp.core.spline import Spline
from pinwarp.core.surface_distance import SurfaceIndex

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]

# A place lies on an edge where the corner across has less than this share of it.
ON_EDGE = 1e-6


@dataclass(frozen=True, eq=False)
class Places:
    """Places on a surface.

    Attributes
    ----------
    positions : (m, 3) float64
        In the frame and unit of the mesh.
    normals : (m, 3)
        Unit vectors, between those of the triangle's corners; 0 where these are.
    on_rim : (m,) bool
        Whether the surface ends there: beyond may be more bone that was never scanned.
    """

    positions: Matrix
    normals: Matrix
    on_rim: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.positions)


class Surface:
    """A mesh with what it takes to meet it: a search tree, normals and rims. Immutable.

    Parameters
    ----------
    mesh
        Any triangles: corners at one position count as one vertex, edges may be shared by three.
    index
        The index of its triangles where it is built already.

    Examples
    --------
    >>> met = Surface(Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]])).closest([[0.2, 0.2, 3]])
    >>> met.positions.tolist(), met.normals.tolist(), met.on_rim.tolist()
    ([[0.2, 0.2, 0.0]], [[0.0, 0.0, 1.0]], [False])
    """

    def __init__(self, mesh: Mesh, index: SurfaceIndex | None = None) -> None:
        self.mesh = mesh
        if index is not None:
            self.index = index
        # Files that list corners triangle by triangle have no edge in common otherwise.
        self.welded = welded_faces(mesh)
        self._normals = vertex_normals(Mesh(mesh.vertices, self.welded))
        self._rims, self._rim_vertices = _rims(self.welded, len(mesh.vertices))
        self.has_rim = bool(self._rims.any())

    @cached_property
    def index(self) -> SurfaceIndex:
        """The index of the triangles, built once somebody searches."""
        return SurfaceIndex(self.mesh)

    def closest(self, points: ArrayLike) -> Places:
        """Return the places of the surface closest to (m, 3) points.

        Raises
        ------
        LandmarkError
            When a point is not finite or the shape is another.
        """
        positions, triangles = self.index.closest(points, often=True)
        return self.at(triangles, positions)

    def at(self, triangles: Rows, positions: Matrix) -> Places:
        """Return places of the surface that lie in known triangles."""
        corners = self.welded[triangles]
        shares = _shares(positions, self.mesh.vertices[self.mesh.faces[triangles]])
        normals = unit_vectors(np.einsum("mk,mkc->mc", shares, self._normals[corners]))
        on_rim: NDArray[np.bool_] = np.zeros(len(positions), np.bool_)
        if self.has_rim:
            on_rim |= (self._rims[triangles] & (shares < ON_EDGE)).any(axis=1)
            on_rim |= (self._rim_vertices[corners] & (shares > 1 - ON_EDGE)).any(axis=1)
        return Places(positions, normals, on_rim)


def welded_faces(mesh: Mesh) -> NDArray[np.int32]:
    """Return the triangles with one vertex for all that lie at exactly one position.

    Examples
    --------
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]]
    >>> welded_faces(Mesh(corners, [[0, 1, 2], [3, 4, 5]])).tolist()
    [[0, 1, 2], [2, 1, 5]]
    """
    order = np.lexsort(mesh.vertices.T)
    ordered = mesh.vertices[order]
    begins = np.ones(len(order), np.bool_)
    begins[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    group = np.cumsum(begins) - 1
    # Each group goes by its lowest row; lexsort keeps equal ones in order.
    first = np.empty(len(order), np.int32)
    first[order] = order[begins][group]
    return first[mesh.faces]


def _rims(faces: NDArray[np.int32], count: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return (t, 3) whether the edge across each corner is of one triangle alone, and its ends."""
    edges = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]].astype(np.int64), axis=2)
    keys = edges[:, :, 0] * count + edges[:, :, 1]
    _, inverse, times = np.unique(keys.ravel(), return_inverse=True, return_counts=True)
    rims = (times[inverse] == 1).reshape(keys.shape)
    # The edge of a triangle that has collapsed is nobody's rim.
    rims &= edges[:, :, 0] != edges[:, :, 1]
    ends = np.zeros(count, np.bool_)
    ends[edges[rims]] = True
    return rims, ends


def rim_length(mesh: Mesh) -> float:
    """Return the length of the edges that belong to one triangle alone, in mesh units.

    Examples
    --------
    >>> rim_length(Mesh([[0, 0, 0], [3, 0, 0], [0, 4, 0]], [[0, 1, 2]]))
    12.0
    """
    faces = welded_faces(mesh)
    rims, _ = _rims(faces, len(mesh.vertices))
    first, last = (mesh.vertices[faces[:, order]][rims] for order in ([1, 2, 0], [2, 0, 1]))
    return float(np.linalg.norm(first - last, axis=1).sum())


def _shares(positions: Matrix, corners: Matrix) -> Matrix:
    """Return (m, 3) how much of each corner is in positions of triangles, all 0 or more."""
    u, v, d = (x - corners[:, 0] for x in (corners[:, 1], corners[:, 2], positions))
    uu, uv, vv = (np.sum(a * b, axis=1) for a, b in ((u, u), (u, v), (v, v)))
    du, dv = np.sum(d * u, axis=1), np.sum(d * v, axis=1)
    area = uu * vv - uv * uv
    has_area = area > 0
    s, t = np.zeros_like(area), np.zeros_like(area)
    np.divide(vv * du - uv * dv, area, out=s, where=has_area)
    np.divide(uu * dv - uv * du, area, out=t, where=has_area)
    shares = np.clip(np.column_stack([1 - s - t, s, t]), 0.0, 1.0)
    return np.asarray(shares / shares.sum(axis=1, keepdims=True))


def unit_vectors(vectors: Matrix) -> Matrix:
    """Return (m, 3) vectors at length 1; those of no length stay 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    scaled = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return np.asarray(scaled)


def carried_normals(spline: Spline, points: Matrix, normals: Matrix) -> Matrix:
    """Return where the surface faces at some points once it is warped.

    The cofactor matrix of the derivative takes normals along, up to their length. A warp that
    mirrors turns them inside: they are turned out again by the sign of its affine part.

    Parameters
    ----------
    spline
        The warp.
    points, normals
        (m, 3) places of the source and unit normals there.

    Returns
    -------
    (m, 3) float64
        Unit vectors.
    """
    J = jacobians(spline, points)
    a, b, c = J[:, 0], J[:, 1], J[:, 2]
    rows = [np.cross(b, c), np.cross(c, a), np.cross(a, b)]
    carried = np.column_stack([np.sum(row * normals, axis=1) for row in rows])
    return np.asarray(handedness(spline) * unit_vectors(carried))


def handedness(spline: Spline) -> int:
    """Return -1 for a warp that mirrors, else 1."""
    return -1 if np.linalg.det(spline.affine[1:]) < 0 else 1
