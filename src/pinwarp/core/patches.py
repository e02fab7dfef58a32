"""Patches: semilandmarks spread over a surface, or over what a closed curve on it encloses."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.curves import CurvePath
from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.mesh import Mesh
from pinwarp.core.pieces import pieces_along
from pinwarp.core.positions import as_positions
from pinwarp.core.sampling import spread_places
from pinwarp.core.sliding import Semilandmarks
from pinwarp.core.surface import Surface
from pinwarp.core.surface_distance import SurfaceIndex

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Triangles are split until the curve is so many of their edges long.
EDGES = 80
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
    mesh, parents, region = surface.mesh, None, None
    if around is not None:
        if not around.is_closed:
            raise LandmarkError("Only a closed curve has an inside: close it on its first point.")
        if inside is None:
            raise LandmarkError("Which side of the curve is meant? Click a place there.")
        mesh, parents, region = region_inside(surface, around, inside)
    positions, triangles = spread_places(mesh, count, away_from, region, seed)
    own = triangles if parents is None else parents[triangles]
    normals = surface.at(own, positions).normals
    return Semilandmarks(positions, normals)


def region_inside(
    surface: Surface, around: CurvePath, inside: ArrayLike
) -> tuple[Mesh, Rows, Mask]:
    """Return the triangles on one side of a closed curve on a mesh.

    Parameters
    ----------
    surface
        Any triangles.
    around
        A closed curve on it.
    inside
        (3,) a place on the side that is meant.

    Returns
    -------
    mesh
        The same surface in triangles that are small beside the curve where it runs.
    parents : (t,) int64
        The triangle of the surface's mesh that each of them is a piece of.
    region : (t,) bool
        Which are inside; those that the curve runs over are not.

    Raises
    ------
    LandmarkError
        When the place lies on the curve.
    MeshError
        When the curve encloses nothing.
    """
    place = as_positions(np.asarray(inside, dtype=np.float64).reshape(1, -1), "place")
    along = around.points(max(EDGES * PER_EDGE, 2 * len(around.places)))
    pieces = pieces_along(surface.mesh, along, around.length / EDGES)
    fine = pieces.mesh
    is_whole = len(fine.faces) == len(surface.mesh.faces)
    index = surface.index if is_whole else SurfaceIndex(fine)
    is_wall = np.zeros(len(fine.faces), np.bool_)
    is_wall[index.closest(along)[1]] = True
    clicked = int(index.closest(place)[1][0])
    if is_wall[clicked]:
        raise LandmarkError("That place lies on the curve: click further inside.")
    from_all = pieces.parts(np.zeros_like(is_wall))
    parts = pieces.parts(is_wall)
    region = ~is_wall & (parts == parts[clicked])
    # Where nothing but the curve itself is missing, it cut nothing off.
    if (region == ((from_all == from_all[clicked]) & ~is_wall)).all():
        raise MeshError(
            "The curve encloses no part of the surface: draw it around one, or leave it open."
        )
    return fine, pieces.parents, region
