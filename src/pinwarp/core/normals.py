"""The directions that a surface faces, for shading in other programs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh


def vertex_normals(mesh: Mesh) -> NDArray[np.float64]:
    """Return the direction that the surface faces at each vertex.

    Parameters
    ----------
    mesh
        Triangles whose corners run anticlockwise seen from outside.

    Returns
    -------
    (m, 3) float64
        Unit vectors, the mean of the triangles around weighted by their areas; 0 where there is
        no triangle with an area.

    Examples
    --------
    >>> vertex_normals(Mesh([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 1, 2]])).tolist()
    [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]
    """
    # The unit drops out, and products of the largest or smallest coordinates stay in range.
    a, b, c = (mesh.vertices[mesh.faces[:, i]] / (mesh.diagonal or 1.0) for i in range(3))
    across = np.cross(b - a, c - a)
    rows = mesh.faces.T.ravel()
    sums = np.column_stack(
        [np.bincount(rows, np.tile(across[:, i], 3), len(mesh.vertices)) for i in range(3)]
    )
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.asarray(np.divide(sums, lengths, out=np.zeros_like(sums), where=lengths > 0))
