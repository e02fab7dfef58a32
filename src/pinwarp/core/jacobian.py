"""How the warp stretches and turns a small piece of the source: its derivative.

``J = A + sum_i w_i (v - u_i)^T / |v - u_i|``, the derivative of the equation in
:mod:`pinwarp.core.spline`, with ``A`` the affine part's matrix. A landmark is the tip of a cone:
the spline has no derivative there, and what is returned is the mean over all directions. With the
basis ``r^2 log r`` a term is ``w_i (v - u_i)^T (2 log |v - u_i| + 1)``, and there are no cones.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core import kernel
from pinwarp.core.checkpoint import Checkpoint, go_on, parts
from pinwarp.core.errors import RangeError
from pinwarp.core.positions import quiet
from pinwarp.core.spline import Spline

Matrix = NDArray[np.float64]

# The third power of more, or of its reciprocal, is no number.
LARGEST_STRETCH = 1e100
# Terms between two checkpoints: less than a tenth of a second.
TERMS = 4_000_000


@quiet
def jacobians(spline: Spline, points: ArrayLike, checkpoint: Checkpoint = go_on) -> Matrix:
    """Return the derivative of the warp.

    Parameters
    ----------
    spline
        The solved warp.
    points
        (m, 3) places in the source's frame and unit.
    checkpoint
        Passed every few million terms: what it raises ends the work.

    Returns
    -------
    (m, 3, 3) float64
        ``J[:, c, j]``: how fast coordinate c of the destination grows with coordinate j of the
        source (destination units per source unit).

    Raises
    ------
    RangeError
        When it makes lengths so much longer or shorter that its determinant is no number.

    Examples
    --------
    >>> from pinwarp.core.spline import factorise, solve
    >>> source = np.vstack([np.zeros(3), np.eye(3)])
    >>> J = jacobians(solve(factorise(source), 2 * source), [[0.2, 0.3, 0.4]])
    >>> np.allclose(J, 2 * np.eye(3))
    True
    """
    points = kernel.as_points(points)
    found = np.empty((len(points), 3, 3))
    for part in parts(len(points), max(1, TERMS // max(1, len(spline.source))), checkpoint):
        found[part] = kernel.evaluate_jacobian(
            spline.source, spline.weights, spline.affine, points[part], spline.basis
        )
    largest = float(np.abs(found).max(initial=0.0))
    if not largest <= LARGEST_STRETCH or 0 < largest < 1 / LARGEST_STRETCH:
        raise RangeError(
            "The warp leaves the range of numbers: it makes lengths "
            f"{largest:.3g} times as long. Check the units of both sides."
        )
    return found


def determinants(jacobian: Matrix) -> Matrix:
    """Return how much volume grows: 1 keeps it, 0 or less is a fold.

    Parameters
    ----------
    jacobian
        (m, 3, 3), from :func:`jacobians`.

    Returns
    -------
    (m,) float64
        Dimensionless where source and destination share a unit. A warp that mirrors is
        negative everywhere.

    Examples
    --------
    >>> determinants(np.diag([2.0, 1.0, 1.0])[None]).tolist()
    [2.0]
    """
    a, b, c = jacobian[:, 0], jacobian[:, 1], jacobian[:, 2]
    # Written out: numpy's det factorises every matrix by itself, several times slower.
    return np.asarray(
        a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1])
        - a[:, 1] * (b[:, 0] * c[:, 2] - b[:, 2] * c[:, 0])
        + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    )


def stretches(jacobian: Matrix) -> tuple[Matrix, Matrix]:
    """Return the largest and the smallest stretch of any direction: singular values of J.

    Parameters
    ----------
    jacobian
        (m, 3, 3), from :func:`jacobians`.

    Returns
    -------
    largest, smallest : (m,) float64
        Destination length per source length, never negative.

    Examples
    --------
    >>> [part.tolist() for part in stretches(np.diag([3.0, -0.5, 1.0])[None])]
    [[3.0], [0.5]]
    """
    values = np.linalg.svd(jacobian, compute_uv=False)
    return np.asarray(values[:, 0]), np.asarray(values[:, 2])
