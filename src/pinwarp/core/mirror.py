"""Mirroring a bone: a left one becomes a right one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.mesh import Mesh

AXES = "xyz"


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
