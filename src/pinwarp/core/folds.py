"""Where a warp turns the surface inside out, and which landmarks make it do so.

What a landmark does to the volume at a place is told without approximation. The derivative of
the warp is ``J = A + sum_i C_i``, ``C_i = w_i (v - u_i)^T / |v - u_i|`` (see
:mod:`pinwarp.core.jacobian`). On the way from the affine part to J, all landmarks in step, the
determinant changes by the sum of ``<M, C_i>`` with M the mean along that way of the cofactor
matrix, its gradient: each landmark's share of the loss (Aumann and Shapley, Values of Non-Atomic
Games, 1974). The cofactors are quadratic along the way: three places give M exactly. The terms of
the basis r are local, those of ``r^2 log r`` of neighbours take away what one another add: there
the shares are those in the spline of the basis r that takes the landmarks to the same places.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial.distance import cdist

from pinwarp.core.basis import Basis
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.jacobian import jacobians
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import Spline, factorise, solve

Matrix = NDArray[np.float64]
Rows = NDArray[np.int64]

# Landmarks are named until they explain so much of what is lost, but never more than so many.
MOST = 0.8
AT_MOST = 3
# A patch is judged by so many of its vertices, evenly picked.
JUDGED = 400


@dataclass(frozen=True, eq=False)
class FoldPatch:
    """A piece of the surface that is turned inside out.

    Attributes
    ----------
    vertices : (k,) int64
        Rows of the mesh's vertices, connected by its edges.
    landmarks : tuple of int
        The landmarks responsible, by their row in the solve, the largest contribution first.
    """

    vertices: Rows
    landmarks: tuple[int, ...]

    @property
    def finding(self) -> Finding:
        """The same as a fact that can be put in words."""
        return Finding(FindingKind.FOLD, self.landmarks, float(len(self.vertices)))


@dataclass(frozen=True, eq=False)
class Folds:
    """The folds of a warp on a mesh.

    Attributes
    ----------
    is_folded : (m,) bool
        Whether the surface is turned inside out at a vertex.
    patches : tuple of FoldPatch
        The largest first.
    mirrors : bool
        Whether the warp as a whole mirrors: then what it does not mirror is folded.
    """

    is_folded: NDArray[np.bool_]
    patches: tuple[FoldPatch, ...]
    mirrors: bool

    @property
    def count(self) -> int:
        """The number of folded vertices."""
        return int(np.count_nonzero(self.is_folded))


def folds_of(
    determinant: ArrayLike, mesh: Mesh, spline: Spline, landmarks: int | None = None
) -> Folds:
    """Find the folds of a warp on a mesh.

    Parameters
    ----------
    determinant
        (m,) of the warp's derivative at the mesh's vertices, from
        :func:`~pinwarp.core.jacobian.determinants`.
    mesh
        The source, before it is warped. Vertices without a triangle have no surface to fold.
    spline
        The warp.
    landmarks
        How many of its places are landmarks, its first ones; without it all. What a refinement
        fitted to the surface cannot be moved, and is not held responsible.

    Returns
    -------
    Folds
        A fold is where the determinant is 0 or less, or 0 or more if the affine part mirrors.

    Raises
    ------
    ValueError
        When there is not one determinant for each vertex.

    Examples
    --------
    >>> from pinwarp.core.jacobian import determinants
    >>> from pinwarp.core.spline import factorise, solve
    >>> source = np.vstack([np.eye(3), -np.eye(3), [[0.1, 0, 0], [-0.1, 0, 0]]])
    >>> warp = solve(factorise(source), source[[0, 1, 2, 3, 4, 5, 7, 6]])
    >>> mesh = Mesh([[0, 0, 0], [0, 0.01, 0], [0, 0, 4]], [[0, 1, 2]])
    >>> (patch,) = folds_of(determinants(jacobians(warp, mesh.vertices)), mesh, warp).patches
    >>> patch.vertices.tolist(), sorted(patch.landmarks)
    ([0, 1], [6, 7])
    """
    values = np.asarray(determinant, dtype=np.float64)
    if values.shape != (len(mesh.vertices),):
        raise ValueError(f"{values.shape} determinants for {len(mesh.vertices)} vertices.")
    mirrors = bool(np.linalg.det(spline.affine[1:]) < 0)
    is_folded = ((values >= 0) if mirrors else (values <= 0)) & mesh.on_surface
    judge = spline
    if spline.basis is not Basis.R and is_folded.any() and len(spline.source):
        judge = solve(factorise(spline.source), spline.evaluate(spline.source))
    patches = tuple(
        FoldPatch(
            vertices, _responsible(judge, mesh.vertices[_judged(vertices)], mirrors, landmarks)
        )
        for vertices in _connected(is_folded, mesh)
    )
    return Folds(is_folded, patches, mirrors)


def _connected(is_folded: NDArray[np.bool_], mesh: Mesh) -> list[Rows]:
    """Return the folded vertices in patches, the largest first."""
    rows = np.flatnonzero(is_folded)
    if not len(rows):
        return []
    edges = np.vstack([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    # Among the folded vertices alone: a fold is small, the mesh need not be.
    first, second = np.searchsorted(rows, edges[is_folded[edges].all(axis=1)]).T
    joined = np.ones(len(first), np.int8)
    graph = coo_array((joined, (first, second)), shape=(len(rows), len(rows)))
    _, labels = connected_components(graph, directed=False)
    order = np.argsort(labels, kind="stable")
    patches = np.split(rows[order], np.flatnonzero(np.diff(labels[order])) + 1)
    return sorted(patches, key=len, reverse=True)


def _judged(vertices: Rows) -> Rows:
    return vertices[:: -(-len(vertices) // JUDGED)]


def _responsible(
    spline: Spline, places: Matrix, mirrors: bool, landmarks: int | None
) -> tuple[int, ...]:
    """Return the landmarks that take most of the volume at some places, the worst first."""
    losses = (_losses(spline, places) * (-1 if mirrors else 1))[:landmarks]
    order = np.argsort(-losses, kind="stable")[:AT_MOST]
    taken = np.maximum(losses, 0.0)
    # One more than are needed to reach it; none where the affine part alone flattens everything.
    needed = 1 + int(np.count_nonzero(np.cumsum(taken[order]) < MOST * taken.sum()))
    return tuple(int(row) for row in order[:needed] if losses[row] > 0)


def _losses(spline: Spline, places: Matrix) -> Matrix:
    """Return (n,) how much of the determinant each landmark takes, summed over some places."""
    affine = spline.affine[1:].T
    bent = jacobians(spline, places) - affine
    mean = sum(
        share * _cofactors(affine + way * bent)
        for way, share in ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6))
    )
    distances = cdist(places, spline.source)
    near = np.divide(1.0, distances, out=np.zeros_like(distances), where=distances > 0)
    # <M, w d^T / r> = w . (M d) / r with d = v - u, summed over the places v.
    pulls = np.einsum("vcj,vj,vi->ic", mean, places, near)
    pulls -= np.einsum("vcj,vi,ij->ic", mean, near, spline.source, optimize=True)
    return -np.asarray(np.sum(spline.weights * pulls, axis=1))


def _cofactors(J: Matrix) -> Matrix:
    """Return the gradients of the determinants of (m, 3, 3) matrices."""
    a, b, c = J[:, 0], J[:, 1], J[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
