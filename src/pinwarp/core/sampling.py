"""Places spread over a surface, the same ones every time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree

from pinwarp.core.errors import MeshError
from pinwarp.core.mesh import Mesh

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]

# So many places are chosen from; for each that is chosen there are at least so many.
CANDIDATES = 12_000
CHOICE = 12
# Seeds are so many places of the sequence apart.
SEED_STEP = 7919
# The plastic number's powers: the most even sequence of pairs (Roberts 2018).
_STEP = np.array([0.7548776662466927, 0.5698402909980532])


def triangle_areas(mesh: Mesh) -> Matrix:
    """Return the (t,) areas of a mesh's triangles, in its unit squared.

    Examples
    --------
    >>> triangle_areas(Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]])).tolist()
    [1.0]
    """
    # Axis by axis: numpy is several times faster along memory than across threes.
    a, b, c = (np.ascontiguousarray(mesh.vertices.T)[:, mesh.faces[:, i]] for i in range(3))
    (ux, uy, uz), (vx, vy, vz) = b - a, c - a
    squares = (uy * vz - uz * vy) ** 2 + (uz * vx - ux * vz) ** 2 + (ux * vy - uy * vx) ** 2
    return np.asarray(0.5 * np.sqrt(squares))


def even_places(
    mesh: Mesh, count: int, region: NDArray[np.bool_] | None = None, seed: int = 0
) -> tuple[Matrix, Rows]:
    """Return places on a surface, as many on every piece as its area asks for.

    Parameters
    ----------
    mesh
        The surface.
    count
        How many.
    region
        (t,) the triangles to take; without it all.
    seed
        Which of many ways.

    Returns
    -------
    positions : (count, 3) float64
    triangles : (count,) int64
        The triangle of each.

    Raises
    ------
    MeshError
        When the triangles have no area.
    """
    areas = triangle_areas(mesh)
    if region is not None:
        areas = np.where(region, areas, 0.0)
    ends = np.cumsum(areas)
    if not ends[-1] > 0:
        raise MeshError("There is no surface to place points on: its triangles have no area.")
    number = np.arange(count)
    triangles = np.searchsorted(ends, (number + 0.5) / count * ends[-1], side="right")
    triangles = np.minimum(triangles, len(areas) - 1)
    s, t = np.mod(0.5 + _STEP[:, None] * (number + 1 + seed * SEED_STEP), 1.0)
    # The far half of the parallelogram is folded back into the triangle.
    over = s + t > 1
    s, t = np.where(over, 1 - s, s), np.where(over, 1 - t, t)
    a, b, c = (mesh.vertices[mesh.faces[triangles, i]] for i in range(3))
    return a + s[:, None] * (b - a) + t[:, None] * (c - a), triangles.astype(np.int64)


def spread_places(
    mesh: Mesh,
    count: int,
    away_from: ArrayLike = (),
    region: NDArray[np.bool_] | None = None,
    seed: int = 0,
) -> tuple[Matrix, Rows]:
    """Return places spread as far from one another, and from landmarks, as goes one by one.

    Fewer are the first of more: whoever changes the number keeps the places. Farthest-point
    choice (Eldar et al., IEEE Transactions on Image Processing 6 (1997)).

    Parameters
    ----------
    mesh
        The surface.
    count
        How many.
    away_from
        (n, 3) places that are taken already.
    region
        (t,) the triangles to take; without it all.
    seed
        Another seed gives other places.

    Returns
    -------
    positions : (count, 3) float64
    triangles : (count,) int64
        The triangle of each.

    Raises
    ------
    MeshError
        When the triangles have no area.

    Examples
    --------
    >>> square = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> positions, _ = spread_places(square, 4, away_from=[[0.5, 0.5, 0.0]])
    >>> sorted(np.rint(positions)[:, :2].tolist())
    [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]
    """
    taken = np.asarray(away_from, dtype=np.float64).reshape(-1, 3)
    before = np.zeros((0, 3)), np.zeros(0, np.int64)
    choice = CANDIDATES
    if CHOICE * count > CANDIDATES:
        # More than that are chosen from as many again, once the first half is there.
        choice = CANDIDATES * 2 ** math.ceil(math.log2(CHOICE * count / CANDIDATES))
        before = spread_places(mesh, choice // CHOICE // 2, taken, region, seed)
        taken = np.vstack([taken, before[0]])
    candidates, triangles = even_places(mesh, choice, region, seed)
    chosen = _farthest(candidates, taken, count - len(before[0]))
    return (
        np.vstack([before[0], candidates[chosen]]),
        np.concatenate([before[1], triangles[chosen]]),
    )


def _farthest(candidates: Matrix, taken: Matrix, count: int) -> Rows:
    """Return rows of candidates, each the farthest from what is taken and from those before."""
    squares: Matrix
    if len(taken):
        squares = np.asarray(KDTree(taken).query(candidates)[0]) ** 2
    else:
        squares = np.sum((candidates - candidates.mean(axis=0)) ** 2, axis=1)
    chosen = np.empty(count, np.int64)
    # Coordinate by coordinate: each pass then runs over memory in a row.
    x, y, z = np.ascontiguousarray(candidates.T)
    gap, term = np.empty_like(x), np.empty_like(x)
    for k in range(count):
        row = int(squares.argmax())
        chosen[k] = row
        np.subtract(x, x[row], out=gap)
        gap *= gap
        for along in (y, z):
            np.subtract(along, along[row], out=term)
            term *= term
            gap += term
        if k == 0 and not len(taken):
            squares[:] = gap
        else:
            np.minimum(squares, gap, out=squares)
    return chosen
