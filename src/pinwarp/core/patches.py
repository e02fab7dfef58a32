"""Patches: semilandmarks spread over a surface, or over what a closed curve on it encloses."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from pinwarp.core.curves import CurvePath
from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.mesh import Mesh
from pinwarp.core.positions import as_positions
from pinwarp.core.sampling import spread_places
from pinwarp.core.sliding import Semilandmarks
from pinwarp.core.surface import Surface, welded_faces
from pinwarp.core.surface_distance import SurfaceIndex

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Triangles are split until the curve is so many of their edges long, or there are so many.
EDGES = 80
MOST_TRIANGLES = 400_000
# Places of the curve on each such edge, so that it slips past no triangle's middle.
PER_EDGE = 8


def patch(
    surface: Surface,
    count: int,
    *,
    around: CurvePath | None = None,
    inside: ArrayLike | None = None,
    away_from: ArrayLike = (),
    seed: int = 0,
) -> Semilandmarks:
    """Return points spread over the source, to slide on the destination.

    Parameters
    ----------
    surface
        The source's.
    count
        How many; fewer are the first of more.
    around
        A closed curve on it; without one the whole surface is meant.
    inside
        (3,) a place on the side of the curve that is meant.
    away_from
        (n, 3) landmarks and points of curves to keep away from.
    seed
        Another seed spreads them another way.

    Returns
    -------
    Semilandmarks

    Raises
    ------
    LandmarkError
        When the curve is not closed, or the place lies on it.
    MeshError
        When the curve encloses nothing.

    Examples
    --------
    >>> square = Mesh([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> patch(Surface(square), 2, away_from=[[0, 0, 0], [4, 4, 0]]).source.round().tolist()
    [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]
    """
    mesh, region = surface.mesh, None
    if around is not None:
        if not around.is_closed:
            raise LandmarkError("Only a closed curve has an inside: close it on its first point.")
        if inside is None:
            raise LandmarkError("Which side of the curve is meant? Click a place there.")
        mesh, region = region_inside(surface.mesh, around, inside)
    positions, triangles = spread_places(mesh, count, away_from, region, seed)
    # The pieces of a triangle follow one another in rounds.
    normals = surface.at(triangles % len(surface.mesh.faces), positions).normals
    return Semilandmarks(positions, normals)


def region_inside(mesh: Mesh, around: CurvePath, inside: ArrayLike) -> tuple[Mesh, Mask]:
    """Return the triangles on one side of a closed curve on a mesh.

    Parameters
    ----------
    mesh
        The surface.
    around
        A closed curve on it.
    inside
        (3,) a place on the side that is meant.

    Returns
    -------
    mesh
        The same surface in triangles that are small beside the curve; triangle i lies in triangle
        ``i % len(mesh.faces)`` of the one given.
    region : (t,) bool
        Its triangles inside; those that the curve runs over are not.

    Raises
    ------
    LandmarkError
        When the place lies on the curve.
    MeshError
        When the curve encloses nothing.
    """
    place = as_positions(np.asarray(inside, dtype=np.float64).reshape(1, -1), "place")
    edge = around.length / EDGES
    fine = mesh
    while _longest_edge(fine) > edge and 4 * len(fine.faces) <= MOST_TRIANGLES:
        fine = split(fine)
    index = SurfaceIndex(fine)
    along = around.points(max(EDGES * PER_EDGE, 2 * len(around.places)))
    is_wall = np.zeros(len(fine.faces), np.bool_)
    is_wall[index.closest(along)[1]] = True
    clicked = int(index.closest(place)[1][0])
    if is_wall[clicked]:
        raise LandmarkError("That place lies on the curve: click further inside.")
    from_all = _parts(fine, np.zeros_like(is_wall))
    parts = _parts(fine, is_wall)
    region = ~is_wall & (parts == parts[clicked])
    # Where nothing but the curve itself is missing, it cut nothing off.
    if (region == ((from_all == from_all[clicked]) & ~is_wall)).all():
        raise MeshError(
            "The curve encloses no part of the surface: draw it around one, or leave it open."
        )
    return fine, region


def split(mesh: Mesh) -> Mesh:
    """Return the same surface with each triangle in four.

    The first pieces of all triangles come first, then the second ones, and so on.

    Examples
    --------
    >>> len(split(Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]])).faces)
    4
    """
    faces, count = mesh.faces.astype(np.int64), len(mesh.vertices)
    edges, inverse = _edges(faces, count)
    middle = inverse + count
    middles = 0.5 * (mesh.vertices[edges[:, 0]] + mesh.vertices[edges[:, 1]])
    # Middle k is across corner k.
    (a, b, c), (p, q, r) = faces.T, middle.T
    pieces = [(a, r, q), (r, b, p), (q, p, c), (p, q, r)]
    return Mesh(
        np.vstack([mesh.vertices, middles]),
        np.vstack([np.column_stack(corners) for corners in pieces]),
    )


def _edges(faces: Rows, count: int) -> tuple[Rows, Rows]:
    """Return the (e, 2) edges, and (t, 3) which one lies across each corner."""
    ends = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]], axis=2)
    keys, inverse = np.unique((ends[:, :, 0] * count + ends[:, :, 1]).ravel(), return_inverse=True)
    return np.column_stack([keys // count, keys % count]), inverse.reshape(-1, 3)


def _longest_edge(mesh: Mesh) -> float:
    corners = mesh.vertices[mesh.faces]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())


def _parts(mesh: Mesh, without: Mask) -> Rows:
    """Return (t,) which connected part each triangle is in, once some are taken out."""
    faces = welded_faces(mesh).astype(np.int64)
    edges, inverse = _edges(faces, len(mesh.vertices))
    rows = np.flatnonzero(~without)
    # Triangles and edges are both nodes: any number of triangles may share an edge.
    links = (np.repeat(rows, 3), len(faces) + inverse[rows].ravel())
    size = len(faces) + len(edges)
    graph = coo_array((np.ones(3 * len(rows), np.int8), links), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1][: len(faces)])
