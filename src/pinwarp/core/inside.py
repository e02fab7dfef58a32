"""Whether places are inside of a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.mesh import Mesh

# So many triangles times places at once: a few megabytes.
_AT_ONCE = 200_000


def is_inside(mesh: Mesh, places: ArrayLike) -> NDArray[np.bool_]:
    """Tell places inside of a surface from those outside, also where it has small holes.

    By the winding number: the sum of the solid angles of all triangles (van Oosterom and
    Strackee, IEEE Trans. Biomed. Eng. 30 (1983); Jacobson et al., ACM TOG 32 (2013)).

    Parameters
    ----------
    mesh
        Its triangles may be turned either way, but all alike.
    places
        (m, 3) in its frame and unit.

    Returns
    -------
    (m,) bool

    Examples
    --------
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> tetrahedron = Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> is_inside(tetrahedron, [[0.1, 0.1, 0.1], [1, 1, 1]]).tolist()
    [True, False]
    """
    places = np.asarray(places, dtype=np.float64).reshape(-1, 3)
    corners = mesh.vertices[mesh.faces]
    winding = np.zeros(len(places))
    step = max(1, _AT_ONCE // max(len(places), 1))
    for first in range(0, len(corners), step):
        a, b, c = np.moveaxis(corners[first : first + step][None] - places[:, None, None], 2, 0)
        la, lb, lc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
        volume = np.einsum("...i,...i", a, np.cross(b, c))
        dots = [np.einsum("...i,...i", x, y) for x, y in ((a, b), (b, c), (c, a))]
        below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
        winding += np.arctan2(volume, below).sum(axis=1)
    return np.asarray(np.abs(winding / (2 * np.pi)) > 0.5)
