"""Mirroring a bone: a left one becomes a right one. Whether that has happened, and undoing it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.lengths import rms
from pinwarp.core.mesh import Mesh
from pinwarp.core.positions import as_positions, quiet

AXES = "xyz"
# What a reflection must leave of the misfit of the best rotation, by the length that this share
# of the pairs is below: the others may be wrong.
MIRRORED, MOST = 0.75, 0.7
# Where the best rotation misses them by no more than this share of their RMS radius, or with fewer
# pairs, there is no telling.
FLAT = 0.02
LEAST_PAIRS = 5
# Steps to the least sum of lengths; shorter ones than this share of the median weigh the same.
STEPS, SHORT = 15, 0.05


def mirrored_points(points: ArrayLike, mesh: Mesh, axis: str) -> NDArray[np.float64]:
    """Mirror (n, 3) points across the plane through the middle of a mesh's bounding box.

    Parameters
    ----------
    points
        In the frame of the mesh.
    mesh
        Whose middle the plane goes through: the bone stays where it is.
    axis
        ``"x"``, ``"y"`` or ``"z"``, the axis across the plane.

    Examples
    --------
    >>> triangle = Mesh([[0, 0, 0], [4, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> mirrored_points([[1, 1, 5]], triangle, "x").tolist()
    [[3.0, 1.0, 5.0]]
    """
    column = AXES.index(axis)
    moved = np.array(points, dtype=np.float64)
    moved[:, column] = float(mesh.bounds[:, column].sum()) - moved[:, column]
    return moved


def mirrored_mesh(mesh: Mesh, axes: str) -> Mesh:
    """Mirror a mesh across each of some axes; triangles turn round, so that outside stays outside.

    Examples
    --------
    >>> triangle = Mesh([[0, 0, 0], [4, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> mirrored_mesh(triangle, "x").faces.tolist()
    [[2, 1, 0]]
    """
    for axis in axes:
        mesh = Mesh(mirrored_points(mesh.vertices, mesh, axis), mesh.faces[:, ::-1])
    return mesh


def toggled(axes: str, axis: str) -> str:
    """Return the axes across which something is mirrored after one more mirroring.

    Examples
    --------
    >>> toggled("z", "x"), toggled("xz", "x")
    ('xz', 'z')
    """
    return "".join(a for a in AXES if (a in axes) != (a == axis))


def axis_to_mirror(source: ArrayLike, destination: ArrayLike) -> str:
    """Return the axis across which the source is to be mirrored to lie as the destination does.

    Mirroring across any axis makes a left bone a right one, and all fit equally well; they differ
    by half a turn. The one that leaves least to turn keeps the bone as it is seen.

    Parameters
    ----------
    source, destination
        (n, 3) positions, row by row the same landmarks.

    Examples
    --------
    >>> source = np.random.default_rng(0).normal(size=(8, 3))
    >>> axis_to_mirror(source, 1.1 * source * [1, -1, 1] + 7)
    'y'
    """
    u = np.asarray(source, dtype=np.float64)
    mirrors = 1 - 2 * np.eye(3)
    # The smaller the angle of a rotation, the larger its trace.
    kept = [float(np.trace(fit_similarity(u * m, destination).rotation)) for m in mirrors]
    return AXES[int(np.argmax(kept))]


@quiet
def reflection_misfit(source: ArrayLike, destination: ArrayLike) -> float:
    """Return what the best reflection leaves of the misfit of the best rotation.

    Both are similarity fits that some wrong pairs do not lead astray: they make the sum of the
    lengths small, not of their squares (iteratively reweighted least squares).

    Parameters
    ----------
    source, destination
        (n, 3) positions, row by row the same landmarks.

    Returns
    -------
    float
        Below 1 where the reflection fits better. With fewer than five pairs, where a rotation
        meets nearly all and for landmarks in one plane there is no telling: 1.

    Examples
    --------
    >>> source = np.random.default_rng(0).normal(size=(8, 3))
    >>> destination = source * [1, 1, -1] + 0.05 * source**2
    >>> reflection_misfit(source, destination) < 0.3 < reflection_misfit(source, 1.1 * source)
    True
    """
    u = as_positions(source, "source landmark")
    v = as_positions(destination, "destination landmark")
    if len(u) < LEAST_PAIRS:
        return 1.0
    turned, reflected = (_misfit(side, v) for side in (u, u * [-1, 1, 1]))
    # Met either way: most lie in a plane, on a line or at a single place.
    if turned <= FLAT * rms(np.linalg.norm(v - v.mean(axis=0), axis=1)):
        return 1.0
    return reflected / turned


def is_mirrored(source: ArrayLike, destination: ArrayLike) -> bool:
    """Whether a reflection fits the pairs far better than a rotation: left and right bones.

    Parameters
    ----------
    source, destination
        As for :func:`reflection_misfit`.

    Examples
    --------
    >>> source = np.random.default_rng(0).normal(size=(8, 3))
    >>> is_mirrored(source, 1.1 * source * [1, 1, -1]), is_mirrored(source, 1.1 * source)
    (True, False)
    """
    return reflection_misfit(source, destination) < MIRRORED


def _misfit(source: NDArray[np.float64], destination: NDArray[np.float64]) -> float:
    """Return the length that most pairs miss by no more than, after a robust similarity fit."""
    weights = np.ones(len(source))
    lengths = weights
    for _ in range(STEPS):
        fit = fit_similarity(source, destination, weights=weights)
        lengths = np.linalg.norm(fit.apply(source) - destination, axis=1)
        weights = 1 / np.maximum(lengths, SHORT * float(np.median(lengths)) + 1e-300)
        weights /= weights.max()
    return float(np.quantile(lengths, MOST))
