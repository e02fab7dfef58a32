"""Triangles split where a curve runs over them, and which of them hang together.

Only what is near the curve is split: a large triangle may then lie beside several small ones,
along one edge of its own that is two, four, ... of theirs. Edges are remembered with their
halves, so that the surface hangs together as before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from pinwarp.core.mesh import Mesh
from pinwarp.core.surface import welded_faces

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]
Mask = NDArray[np.bool_]

# Nothing is split any further once there are so many triangles.
MOST_TRIANGLES = 400_000


@dataclass(frozen=True, eq=False)
class Pieces:
    """A surface in triangles of different sizes; made by :func:`pieces_along`.

    Attributes
    ----------
    mesh
        The triangles; corners at one position are one vertex.
    parents : (t,) int64
        Which triangle of the mesh before each is a piece of.
    across : (t, 3)
        The edge across each corner.
    halves : (e, 2)
        The two edges that an edge was split into, or -1.
    """

    mesh: Mesh
    parents: Rows
    across: Rows
    halves: Rows

    def parts(self, without: Mask) -> Rows:
        """Return (t,) which connected part each triangle is in, once some are taken out.

        Any number of triangles may share an edge.
        """
        rows, count = np.flatnonzero(~without), len(self.across)
        # Triangles and edges are both nodes.
        links = [np.column_stack([np.repeat(rows, 3), count + self.across[rows].ravel()])]
        reached = np.zeros(len(self.halves), np.bool_)
        edges = self.across[rows].ravel()
        while len(edges):
            reached[edges] = True
            edges = np.flatnonzero(reached & (self.halves[:, 0] >= 0))
            reached[:] = False
            below = self.halves[edges].ravel()
            links.append(count + np.column_stack([np.repeat(edges, 2), below]))
            edges = below
        begins, ends = np.vstack(links).T
        size = count + len(self.halves)
        graph = coo_array((np.ones(len(begins), np.int8), (begins, ends)), shape=(size, size))
        return np.asarray(connected_components(graph, directed=False)[1][:count])


def pieces_along(mesh: Mesh, along: Matrix, edge: float) -> Pieces:
    """Split the triangles near places of a curve until no edge there is longer than asked for.

    Parameters
    ----------
    mesh
        The surface.
    along
        (k, 3) places of the curve, much closer to one another than ``edge``.
    edge
        The longest edge that may stay, in mesh units.

    Returns
    -------
    Pieces

    Examples
    --------
    Of two triangles the one beside the place is split into four, again and again:

    >>> square = Mesh([[0, 0, 0], [9, 0, 0], [9, 9, 0], [0, 9, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> pieces = pieces_along(square, np.array([[9.0, 0, 0]]), 1.0)
    >>> len(pieces.mesh.faces) < 60
    True
    >>> pieces.parts(np.zeros(len(pieces.mesh.faces), bool)).max()
    np.int32(0)
    """
    tree = KDTree(along)
    faces = welded_faces(mesh).astype(np.int64)
    work = _Work(mesh.vertices, faces)
    while len(work.faces) < MOST_TRIANGLES:
        corners = work.vertices[work.faces]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        large = np.flatnonzero(longest > edge)
        if not len(large):
            break
        # No place of a triangle is further from its middle than this.
        gaps = np.asarray(tree.query(corners[large].mean(axis=1))[0])
        near = large[gaps < longest[large]]
        if not len(near) or len(work.faces) + 3 * len(near) > MOST_TRIANGLES:
            break
        work.split(near)
    return Pieces(Mesh(work.vertices, work.faces), work.parents, work.across, work.halves)


class _Work:
    """The triangles on their way: each split takes some out and puts four in for each."""

    def __init__(self, vertices: Matrix, faces: Rows) -> None:
        self.vertices, self.faces = vertices, faces
        self.parents = np.arange(len(faces))
        ends = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]], axis=2).reshape(-1, 2)
        keys, inverse = np.unique(ends[:, 0] * len(vertices) + ends[:, 1], return_inverse=True)
        self.across = inverse.reshape(-1, 3)
        self._ends = np.column_stack([keys // len(vertices), keys % len(vertices)])
        self._middles = np.full(len(keys), -1)
        self.halves = np.full((len(keys), 2), -1)

    def split(self, rows: Rows) -> None:
        """Split some triangles into four each."""
        across = self.across[rows]
        self._halve(np.unique(across))
        a, b, c = self.faces[rows].T
        p, q, r = self._middles[across].T
        # Each new edge inside lies across the same corner, once it is named after the middle.
        ap, aq, ar = self._added(q, r), self._added(r, p), self._added(p, q)
        half = self._half
        ea, eb, ec = across.T
        pieces = [
            ((a, r, q), (ap, half(eb, a), half(ec, a))),
            ((r, b, p), (half(ea, b), aq, half(ec, b))),
            ((q, p, c), (half(ea, c), half(eb, c), ar)),
            ((p, q, r), (ap, aq, ar)),
        ]
        kept = np.ones(len(self.faces), np.bool_)
        kept[rows] = False
        faces, edges = ([np.column_stack(piece[which]) for piece in pieces] for which in range(2))
        self.faces = np.vstack([self.faces[kept], *faces])
        self.across = np.vstack([self.across[kept], *edges])
        self.parents = np.concatenate([self.parents[kept], np.tile(self.parents[rows], 4)])

    def _halve(self, edges: Rows) -> None:
        """Give edges a middle and two halves, unless a neighbour's split did before."""
        whole = edges[self._middles[edges] < 0]
        first, last = self._ends[whole].T
        middles = len(self.vertices) + np.arange(len(whole))
        places = 0.5 * (self.vertices[first] + self.vertices[last])
        self.vertices = np.vstack([self.vertices, places])
        self._middles[whole] = middles
        begun = self._added(first, middles), self._added(middles, last)
        self.halves[whole] = np.column_stack(begun)

    def _added(self, first: Rows, last: Rows) -> Rows:
        """Add edges and return their rows."""
        rows = len(self._ends) + np.arange(len(first))
        self._ends = np.vstack([self._ends, np.column_stack([first, last])])
        self._middles = np.concatenate([self._middles, np.full(len(first), -1)])
        self.halves = np.vstack([self.halves, np.full((len(first), 2), -1)])
        return rows

    def _half(self, edges: Rows, corners: Rows) -> Rows:
        """Return the half of each edge that ends at a corner."""
        is_first = self._ends[edges, 0] == corners
        return np.asarray(np.where(is_first, self.halves[edges, 0], self.halves[edges, 1]))
