"""How far places lie from a triangle surface, exactly, and how far two surfaces lie apart."""

from __future__ import annotations

import functools
import math
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import KDTree

from pinwarp.core import kernel
from pinwarp.core.checkpoint import Checkpoint, go_on
from pinwarp.core.errors import RangeError
from pinwarp.core.mesh import Mesh

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]

# The most triangles in a leaf of the tree: fewer cost memory, more cost time.
LEAF = 4
# Below so many places numpy is done before numba would have been loaded.
WORTH_COMPILING = 2000
# So many triangles take it as long as one place more.
TRIANGLES_A_PLACE = 50
# Below so many places (a few milliseconds) a second thread is not worth starting.
WORTH_THREADS = 4000
# After so many places a search can be stopped: less than a tenth of a second where they are close.
PART = 2_500
# Meshes of another size, or smaller than its reciprocal, are refused.
LARGEST_SIZE = 1e60
# A triangle flatter than this is taken for its edges: its normal would be mostly rounding.
FLAT = 1e-8


class SurfaceIndex:
    """The triangles of a mesh in a tree of boxes, to find the closest to any place.

    Immutable: any thread may ask. To build it takes 0.3 s for 180,000 triangles.

    Parameters
    ----------
    mesh
        Vertices without a triangle are no part of the surface; triangles without area count as
        the edge or the place that they are.
    like
        The index of the same triangles over other vertices: what was close together there is
        mostly so here, and not to sort anew takes a third of the time.
    checkpoint
        Passed at every level of the tree: what it raises ends the work.

    Examples
    --------
    >>> index = SurfaceIndex(Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]]))
    >>> index.distances([[0.2, 0.2, 3.0], [4.0, 0.0, 4.0]]).tolist()
    [3.0, 5.0]
    """

    def __init__(
        self, mesh: Mesh, like: SurfaceIndex | None = None, checkpoint: Checkpoint = go_on
    ) -> None:
        # The fourth powers of lengths are compared.
        if mesh.diagonal > LARGEST_SIZE or 0 < mesh.diagonal < 1 / LARGEST_SIZE:
            raise RangeError(
                f"A mesh of the size {mesh.diagonal:.3g} leaves the range of numbers that "
                "distances can be measured in: check its unit."
            )
        self.mesh = mesh
        corners = mesh.vertices[mesh.faces]
        levels = max(0, math.ceil(math.log2(len(corners) / LEAF)))
        same = like is not None and np.array_equal(like.mesh.faces, mesh.faces)
        self._order: Rows = (
            like._order
            if like is not None and same
            else _order(_lowest(corners) + _highest(corners), levels, checkpoint)
        )
        checkpoint(1.0)
        self._boxes = _boxes(corners[self._order], levels)
        self._triangles = _prepared(corners[self._order])

    def distances(self, places: ArrayLike, checkpoint: Checkpoint = go_on) -> Matrix:
        """Return the distance of every place from the surface.

        Parameters
        ----------
        places
            (m, 3) in the frame and unit of the mesh; fastest where neighbours follow one another.
        checkpoint
            Passed every few thousand places, in the thread that asks: what it raises ends the
            search.

        Returns
        -------
        (m,) float64
            In mesh units, never negative.

        Raises
        ------
        LandmarkError
            When a place is not finite (the message names its row) or the shape is another.
        """
        places = kernel.as_points(places)
        return np.sqrt(self._search(places, self._worth(len(places)), checkpoint)[1])

    def closest(self, places: ArrayLike, *, often: bool = False) -> tuple[Matrix, Rows]:
        """Return the closest position on the surface, and the triangle that it lies in.

        Parameters
        ----------
        places
            As for :meth:`distances`.
        often
            Whether this is one of many such questions, so that compiled code is worth loading
            for a small mesh too.

        Returns
        -------
        positions : (m, 3) float64
            In the frame and unit of the mesh.
        triangles : (m,) int64
            Rows of ``mesh.faces``; any of them where several are equally close.
        """
        places = kernel.as_points(places)
        loops = _compiled() if often else self._worth(len(places))
        rows, _ = self._search(places, loops)
        if loops is None:
            return places - _apart(self._triangles[rows], places), self._order[rows]
        positions = np.empty_like(places)
        # What is read-only would be compiled for once more.
        places = np.require(places, requirements="W")
        loops.closest_positions(self._triangles, rows, places, positions)
        return positions, self._order[rows]

    def _worth(self, count: int) -> ModuleType | None:
        """Return the compiled loops where so many places are worth them."""
        work = count + len(self._order) // TRIANGLES_A_PLACE
        return _compiled() if work >= WORTH_COMPILING else None

    def _search(
        self, places: Matrix, loops: ModuleType | None, checkpoint: Checkpoint = go_on
    ) -> tuple[Rows, Matrix]:
        """Return the row in the tree of every place's closest triangle, and squared distances."""
        if loops is None:
            return self._search_with_numpy(places, checkpoint)
        # A mesh's vertices are read-only.
        places = np.require(places, requirements="W")
        rows, squares = np.empty(len(places), np.int64), np.empty(len(places))
        threads = loops.THREADS if len(places) >= WORTH_THREADS else 1
        # Several parts a thread: far places take longer than close ones.
        count = max(4 * threads if threads > 1 else 1, -(-len(places) // PART))
        edges = np.linspace(0, len(places), count + 1).astype(int).tolist()

        def search(first: int, last: int) -> None:
            part = slice(first, last)
            loops.closest_triangles(
                self._boxes, self._triangles, places[part], rows[part], squares[part]
            )

        if threads == 1:
            for number, (first, last) in enumerate(pairwise(edges)):
                checkpoint(number / count)
                search(first, last)
            return rows, squares
        with ThreadPoolExecutor(threads) as pool:
            searched = [pool.submit(search, first, last) for first, last in pairwise(edges)]
            try:
                for number, part in enumerate(searched):
                    checkpoint(number / count)
                    part.result()
            finally:
                for part in searched:
                    part.cancel()
        return rows, squares

    def _search_with_numpy(self, places: Matrix, checkpoint: Checkpoint) -> tuple[Rows, Matrix]:
        """Search for all places at once: each box is asked who may find something closer in it."""
        _, found = KDTree(self._triangles[:, :3]).query(places)
        rows = np.asarray(found, dtype=np.int64)
        squares = _square(_apart(self._triangles[rows], places))
        leaves = (len(self._boxes) + 1) // 2
        leaf = len(self._order) // leaves
        waiting = [(0, np.arange(len(places)))]
        while waiting:
            checkpoint(0.0)
            node, who = waiting.pop()
            outside = np.maximum(self._boxes[node, :3] - places[who], 0.0)
            outside += np.maximum(places[who] - self._boxes[node, 3:], 0.0)
            who = who[_square(outside) < squares[who]]
            if not len(who):
                continue
            if node < leaves - 1:
                waiting += [(2 * node + 2, who), (2 * node + 1, who)]
                continue
            inside = np.arange((node - leaves + 1) * leaf, (node - leaves + 2) * leaf)
            triangles = self._triangles[np.tile(inside, len(who))]
            reached = _square(_apart(triangles, np.repeat(places[who], leaf, axis=0)))
            reached = reached.reshape(-1, leaf)
            best = reached.min(axis=1)
            closer = best < squares[who]
            squares[who[closer]] = best[closer]
            rows[who[closer]] = inside[reached.argmin(axis=1)[closer]]
        return rows, squares


def _compiled() -> ModuleType | None:
    # The kernel knows whether numba works here, and where it may keep what it compiled.
    if kernel.compiled() is None:
        return None
    from pinwarp.core import compiled_distance

    return compiled_distance


def warm_up() -> None:
    """Load the compiled search, so that the first real one does not wait."""
    loops = _compiled()
    if loops is not None:
        index = SurfaceIndex(Mesh(np.eye(3), [[0, 1, 2]]))
        rows, squares = np.empty(1, np.int64), np.empty(1)
        places = np.zeros((1, 3))
        loops.closest_triangles(index._boxes, index._triangles, places, rows, squares)
        loops.closest_positions(index._triangles, rows, places, np.empty_like(places))


def _order(centres: Matrix, levels: int, checkpoint: Checkpoint) -> Rows:
    """Return rows of triangles such that each half, quarter, ... of them lies close together."""
    leaves = 2**levels
    count = leaves * -(-len(centres) // leaves)
    # All leaves hold as many: some triangles are taken twice.
    order = np.arange(count) * len(centres) // count
    # Axis by axis: numpy is several times faster along memory than across threes.
    axes = np.ascontiguousarray(centres.T)
    for level in range(levels):
        checkpoint(level / levels)
        parts = order.reshape(2**level, -1)
        extents = [np.ptp(axis[parts], axis=1) for axis in axes]
        longest = np.argmax(extents, axis=0)
        along = axes[longest[:, None], parts]
        halves = np.argpartition(along, parts.shape[1] // 2, axis=1)
        order = np.take_along_axis(parts, halves, axis=1)
    return np.asarray(order.ravel(), dtype=np.int64)


def _lowest(several: Matrix) -> Matrix:
    """Return the minimum over axis 1 of (m, k, 3): one row of k after the other, as k is small."""
    return functools.reduce(np.minimum, several.transpose(1, 0, 2))


def _highest(several: Matrix) -> Matrix:
    """Return the maximum over axis 1 of (m, k, 3)."""
    return functools.reduce(np.maximum, several.transpose(1, 0, 2))


def _boxes(corners: Matrix, levels: int) -> Matrix:
    """Return the boxes of a complete binary tree, the root first, the leaves last."""
    first = 2**levels - 1
    boxes = np.empty((2 * first + 1, 6))
    leaves = corners.reshape(first + 1, -1, 3)
    boxes[first:] = np.hstack([_lowest(leaves), _highest(leaves)])
    while first:
        halves = boxes[first : 2 * first + 1].reshape(-1, 2, 6)
        above = first // 2
        boxes[above:first, :3] = _lowest(halves[:, :, :3])
        boxes[above:first, 3:] = _highest(halves[:, :, 3:])
        first = above
    return boxes


def _prepared(corners: Matrix) -> Matrix:
    """Return (t, 12): a corner, the two edges from it, and the normal over its square."""
    corner = corners[:, 0]
    u, v = corners[:, 1] - corner, corners[:, 2] - corner
    normal = np.cross(u, v)
    square = _square(normal)
    longest = np.maximum(_square(u), np.maximum(_square(v), _square(v - u)))
    has_area = square > (FLAT * longest) ** 2
    over = np.full_like(normal, np.nan)
    np.divide(normal, square[:, None], out=over, where=has_area[:, None])
    return np.hstack([corner, u, v, over])


def _apart(triangles: Matrix, places: Matrix) -> Matrix:
    """Return the vectors from the closest positions of prepared triangles to places."""
    corner, u, v, normal = np.split(triangles, 4, axis=1)
    d = places - corner
    s = np.sum(np.cross(d, v) * normal, axis=1, keepdims=True)
    t = np.sum(np.cross(u, d) * normal, axis=1, keepdims=True)
    # False for a triangle without area, whose normal is NaN.
    within = ((s >= 0) & (t >= 0) & (s + t <= 1))[:, 0]
    best = np.where(within[:, None], d - s * u - t * v, np.inf)
    for to_place, edge in ((d, u), (d, v), (d - u, v - u)):
        length = _square(edge)
        share = np.zeros(len(places))
        np.divide(np.sum(to_place * edge, axis=1), length, out=share, where=length > 0)
        apart = to_place - np.clip(share, 0.0, 1.0)[:, None] * edge
        closer = ~within & (_square(apart) < _square(best))
        best[closer] = apart[closer]
    return best


def _square(vectors: Matrix) -> Matrix:
    return np.asarray(np.sum(vectors * vectors, axis=1))
