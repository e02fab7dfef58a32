"""Whether landmarks are enough to fit a surface by: what is missing, and what to do about it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.errors import LandmarkError, MeshError
from pinwarp.core.factor import factorise
from pinwarp.core.mesh import Mesh
from pinwarp.core.positions import as_positions
from pinwarp.core.spline import Spline, solve

Matrix = NDArray[np.float64]

# An affine map has twelve numbers: four landmarks fix it.
FEWEST = 4
# Surfaces face alike where their normals differ by less than 60 degrees.
ALIKE = 0.5
# Where more than this share faces the opposite way, a mesh is inside out; wrong pairs mix them.
MOST_OPPOSITE = 0.5


class InsideOutError(MeshError):
    """Two surfaces of which one faces inwards; turning its triangles round is the remedy."""


def starting_warp(source: ArrayLike, destination: ArrayLike, penalty: float = 0.0) -> Spline:
    """Return the warp of the landmarks, or say why nothing can be fitted by them.

    Parameters
    ----------
    source, destination
        (n, 3) landmarks, row by row the same places.
    penalty
        The warping penalty of the landmarks.

    Returns
    -------
    Spline

    Raises
    ------
    LandmarkError
        When they are fewer than four, lie in one plane, coincide, or mirror the source; the
        message says what to do.

    Examples
    --------
    >>> try:
    ...     starting_warp(np.eye(3), np.eye(3))
    ... except LandmarkError as error:
    ...     print(error)
    There are 3 pairs of landmarks, and a surface can be fitted from 4 on: place more.
    """
    places = as_positions(source, "source landmark")
    check_count(len(places))
    factor = factorise(places)
    if factor.duplicates:
        i, j, *_ = factor.duplicates[0]
        raise LandmarkError(
            f"The source landmarks in rows {i} and {j} lie at one place: remove one of them."
        )
    spline = solve(factor, destination, penalty)
    for name, rank in (
        ("source", factor.rank),
        ("destination", factorise(destination).rank),
    ):
        if rank < 3:
            shape = ("at one place", "on one line", "in one plane")[rank]
            raise LandmarkError(
                f"All {name} landmarks lie {shape}, which leaves the warp across it open: "
                "place at least one landmark away from there."
            )
    if np.linalg.det(solve(factor, destination, np.inf).affine[1:]) < 0:
        raise LandmarkError(
            "The landmarks mirror the source, as between a left and a right bone: mirror one of "
            "the meshes first, or look for pairs that are swapped."
        )
    return spline


def check_count(pairs: int) -> None:
    """Say how many landmarks are missing, if any.

    Raises
    ------
    LandmarkError
        When they are fewer than four.

    Examples
    --------
    >>> check_count(4)
    """
    if pairs < FEWEST:
        words = "is 1 pair" if pairs == 1 else f"are {pairs or 'no'} pairs"
        raise LandmarkError(
            f"There {words} of landmarks, and a surface can be fitted from {FEWEST} on: place more."
        )


def check_facing(cosines: Matrix, destination: Mesh, least: float) -> None:
    """Say why a fit cannot begin where two surfaces do not face alike.

    Parameters
    ----------
    cosines
        (m,) between the normals of the warped source and of the destination closest to it.
    destination
        To tell which of the two is inside out.
    least
        The share of places that must face alike.

    Raises
    ------
    InsideOutError
        When most face the opposite way.
    MeshError
        When too few face the same way.
    """
    if not len(cosines):
        raise MeshError(
            "The destination ends before all points of the warped source: check that the pairs "
            "and the meshes belong together."
        )
    alike, opposite = float(np.mean(cosines > ALIKE)), float(np.mean(cosines < -ALIKE))
    if opposite > MOST_OPPOSITE:
        which = "destination" if enclosed_volume(destination) < 0 else "source"
        raise InsideOutError(
            f"The surfaces face opposite ways: one mesh is inside out, most likely the {which}. "
            "Turn its triangles round."
        )
    if alike < least:
        raise MeshError(
            f"Only {alike:.0%} of the warped source faces as the destination does next to it, "
            f"{opposite:.0%} the opposite way: the landmarks do not lay one surface on the other "
            "yet, or a mesh is inside out in part. Look for wrong pairs, or place landmarks where "
            "the surfaces lie furthest apart."
        )


def enclosed_volume(mesh: Mesh) -> float:
    """Return the volume inside a mesh, below 0 where it is inside out.

    Of an open surface it is that between it and the middle of its vertices.

    Examples
    --------
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 6]]
    >>> round(enclosed_volume(Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])), 9)
    1.0
    """
    about = mesh.vertices - mesh.vertices[mesh.on_surface].mean(axis=0)
    a, b, c = (about[mesh.faces[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)
