"""Curves on a surface: the way between two places, a path through several, points along it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.positions import as_positions
from pinwarp.core.surface import Surface, unit_vectors

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]

# Places of a way between two clicks, and how often it is drawn tight.
FINENESS = 32
SHORTENINGS = 60
EVEN_AGAIN = 10
# Places of a curve that are closer than this share of the mesh's size are one.
ONE_PLACE = 1e-9
# So many ways are remembered (a megabyte).
REMEMBERED = 1000
# Dijkstra looks no further than so many times the straight line, before it looks everywhere.
DETOURS = (1.5, 4.0)
# Points along a path keep this share of their mean spacing apart.
LEAST_SPACING = 0.1


@dataclass(frozen=True, eq=False)
class CurvePath:
    """A path of many short straight pieces.

    Attributes
    ----------
    places : (p, 3) float64
        In mesh units, p >= 2; no two neighbours the same.
    is_closed
        Whether it goes on from the last to the first.
    """

    places: Matrix
    is_closed: bool = False

    @property
    def length(self) -> float:
        """How long it is."""
        return float(self._along()[1][-1])

    def points(self, count: int) -> Matrix:
        """Return (count, 3) places at equal distances along the path.

        The first is the path's, and of an open one the last.

        Examples
        --------
        >>> CurvePath(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])).points(3).tolist()
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
        """
        length = self.length
        steps = count if self.is_closed else max(1, count - 1)
        return self._at(np.asarray(np.arange(count) * (length / steps)))

    def closest(self, points: Matrix) -> tuple[Matrix, Matrix]:
        """Return the places closest to (k, 3) points and the (k, 3) unit tangents there.

        On an open path nobody overtakes: the places come in the order of the points, a little
        apart from one another.
        """
        corners, ends = self._along()
        begins, ways = corners[:-1], np.diff(corners, axis=0)
        lengths = np.diff(ends)
        # Per point and piece of the path: how far along the piece the closest place is.
        towards = points[:, None] - begins
        shares = np.clip(np.einsum("kpc,pc->kp", towards, ways) / lengths**2, 0.0, 1.0)
        gaps = np.sum((towards - shares[:, :, None] * ways) ** 2, axis=2)
        piece = gaps.argmin(axis=1)
        along = ends[piece] + shares[np.arange(len(points)), piece] * lengths[piece]
        if not self.is_closed:
            along = _in_order(along, float(ends[-1]))
        span = 1e-3 * float(ends[-1])
        return self._at(along), unit_vectors(self._at(along + span) - self._at(along - span))

    def along_with(self, points: Matrix) -> CurvePath:
        """Return the path in the direction in which (k, 3) points come along it.

        Examples
        --------
        >>> path = CurvePath(np.array([[0.0, 0, 0], [4, 0, 0]]))
        >>> path.along_with(np.array([[3.0, 1, 0], [1, 1, 0]])).places[0].tolist()
        [4.0, 0.0, 0.0]
        """
        if self.is_closed:
            return self
        reverse = CurvePath(self.places[::-1])
        ways = [np.sum((path.closest(points)[0] - points) ** 2) for path in (self, reverse)]
        return reverse if ways[1] < ways[0] else self

    def _along(self) -> tuple[Matrix, Matrix]:
        """Return the corners, the first once more on a closed path, and how far along each is."""
        corners = np.vstack([self.places, self.places[:1]]) if self.is_closed else self.places
        steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        return corners, np.concatenate([[0.0], np.cumsum(steps)])

    def _at(self, along: Matrix) -> Matrix:
        corners, ends = self._along()
        if self.is_closed:
            along = np.mod(along, ends[-1])
        return np.column_stack([np.interp(along, ends, corners[:, axis]) for axis in range(3)])


def _in_order(along: Matrix, length: float) -> Matrix:
    """Return the positions along a path, moved on or back where one would overtake another."""
    least = LEAST_SPACING * length / (len(along) + 1)
    steps = least * np.arange(len(along))
    ahead = np.maximum.accumulate(along - steps) + steps
    # What was pushed over the end is pushed back from there.
    room = length - steps[::-1]
    return np.asarray(np.clip(np.minimum(ahead, room), 0.0, length))


def tangents_along(points: Matrix, is_closed: bool = False) -> Matrix:
    """Return the (k, 3) unit tangents of points in a row: towards both neighbours at once.

    Examples
    --------
    >>> tangents_along(np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0]])).tolist()
    [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    """
    if is_closed:
        return unit_vectors(np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0))
    around = np.vstack([points[:1], points, points[-1:]])
    return unit_vectors(around[2:] - around[:-2])


class PathFinder:
    """Finds short ways over a surface, and remembers them. Any thread may ask.

    A straight line between two places is laid on the surface; where it lies badly, the way over
    the edges is taken instead (Dijkstra 1959). Then it is drawn tight on the surface.

    Parameters
    ----------
    surface
        Any triangles; edges may be shared by three.

    Examples
    --------
    >>> from pinwarp.core.mesh import Mesh
    >>> square = Mesh([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> path = PathFinder(Surface(square)).through([[0, 1, 0], [4, 1, 0]])
    >>> round(path.length, 6)
    4.0
    """

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        faces, vertices = surface.welded, surface.mesh.vertices
        ends = faces.ravel(), faces[:, [1, 2, 0]].ravel()
        is_edge = ends[0] != ends[1]
        rows, columns = (np.concatenate(pair)[np.tile(is_edge, 2)] for pair in (ends, ends[::-1]))
        # Of an edge of several triangles one entry is left.
        edges = coo_array((np.ones(len(rows)), (rows, columns)), (len(vertices),) * 2).tocsr()
        begins = np.repeat(np.arange(len(vertices)), np.diff(edges.indptr))
        ways = vertices[edges.indices] - vertices[begins]
        lengths = np.linalg.norm(ways, axis=1)
        self._graph = csr_array((lengths, edges.indices, edges.indptr), edges.shape)
        _, self._parts = connected_components(self._graph, directed=False)
        # Whoever drags one handle of a curve asks for all other ways again and again.
        self._ways: dict[bytes, Matrix] = {}

    def between(self, begin: ArrayLike, end: ArrayLike) -> Matrix:
        """Return the places of a short way from one place of the surface to another.

        Returns
        -------
        (p, 3) float64
            The two places and what is between them.

        Raises
        ------
        MeshError
            When no way over the surface leads from one to the other.
        """
        a, b = as_positions(np.array([begin, end], dtype=np.float64), "place")
        key = np.concatenate([a, b]).tobytes()
        way = self._ways.get(key)
        if way is None:
            way = self._found(a, b)
            way.setflags(write=False)
            if len(self._ways) >= REMEMBERED:
                self._ways.clear()
            self._ways[key] = way
        return way

    def _found(self, a: Matrix, b: Matrix) -> Matrix:
        straight = float(np.linalg.norm(b - a))
        line = np.linspace(a, b, FINENESS)
        way = self._laid(line)
        steps = np.linalg.norm(np.diff(way, axis=0), axis=1)
        lifted = np.linalg.norm(way - line, axis=1)
        i, j = self._corner(a), self._corner(b)
        if self._parts[i] != self._parts[j]:
            raise MeshError(
                "The places lie on two parts of the mesh that no surface joins: "
                "end the curve on one part, and draw another on the other."
            )
        # Torn, or far off: the line went through the bone and came out somewhere else.
        if steps.max() > 4 * straight / FINENESS or lifted.max() > 0.5 * straight:
            chain = _distinct(np.vstack([a, self._over_edges(i, j, straight), b]))
            way = self._laid(CurvePath(chain).points(FINENESS))
        way[[0, -1]] = a, b
        for turn in range(SHORTENINGS):
            way[1:-1] = self._laid(0.5 * (way[:-2] + way[2:]))
            if turn % EVEN_AGAIN == EVEN_AGAIN - 1 and straight > 0:
                way[1:-1] = self._laid(CurvePath(_distinct(way)).points(FINENESS)[1:-1])
        return way

    def through(self, places: ArrayLike, is_closed: bool = False) -> CurvePath:
        """Return the path over the surface through some places, in their order.

        Raises
        ------
        LandmarkError
            When there are too few places for a path.
        MeshError
            When they lie on parts of the mesh that no surface joins.
        """
        stops = as_positions(places, "place of the curve")
        # What lies off the surface would lead there and back.
        stops = _distinct(self._laid(stops), ONE_PLACE * self.surface.mesh.diagonal)
        least = 3 if is_closed else 2
        if len(stops) < least:
            kind = "closed curve" if is_closed else "curve"
            raise LandmarkError(f"A {kind} needs at least {least} places apart from one another.")
        stops = np.vstack([stops, stops[:1]]) if is_closed else stops
        ways = [self.between(a, b)[:-1] for a, b in itertools.pairwise(stops)]
        path = np.vstack(ways if is_closed else [*ways, stops[-1:]])
        return CurvePath(_distinct(path), is_closed)

    def _laid(self, points: Matrix) -> Matrix:
        return self.surface.index.closest(points, often=True)[0]

    def _corner(self, place: Matrix) -> int:
        """Return the closest corner of the triangle that is closest to a place."""
        _, triangles = self.surface.index.closest(place[None], often=True)
        corners = self.surface.welded[triangles[0]]
        gaps = np.linalg.norm(self.surface.mesh.vertices[corners] - place, axis=1)
        return int(corners[gaps.argmin()])

    def _over_edges(self, i: int, j: int, straight: float) -> Matrix:
        """Return the vertices on the shortest way over edges between two of one part."""
        for limit in (*(share * straight for share in DETOURS), np.inf):
            # The graph holds both directions.
            reached, before = dijkstra(
                self._graph,
                indices=np.asarray(i),
                return_predecessors=True,
                limit=limit,
            )
            if np.isfinite(reached[j]):
                break
        chain = [j]
        while chain[-1] != i:
            chain.append(int(before[chain[-1]]))
        return np.asarray(self.surface.mesh.vertices[chain[::-1]])


def _distinct(places: Matrix, tolerance: float = 0.0) -> Matrix:
    """Return places without those that repeat the one before."""
    moved = np.ones(len(places), np.bool_)
    moved[1:] = (np.abs(np.diff(places, axis=0)) > tolerance).any(axis=1)
    return places[moved]
