"""Evaluate a thin-plate spline at many points: compiled where that pays, plain numpy elsewhere."""

from __future__ import annotations

import functools
import threading
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist

from pinwarp.core.errors import LandmarkError

Matrix = NDArray[np.float64]

# Below this many distances numpy is done before numba would have been loaded.
WORTH_COMPILING = 300_000
# Distances held at once by the numpy path: 32 MB.
CHUNK = 4_000_000
LARGEST_COORDINATE = 1e150

# Not every threading layer of numba survives two callers at once; each call uses all cores anyway.
_one_at_a_time = threading.Lock()


@functools.cache
def compiled() -> ModuleType | None:
    """Return the compiled loops, or None where numba cannot compile."""
    try:
        from pinwarp.core import compiled as loops
    except Exception:  # numba fails in many ways: no LLVM for the platform, no cache folder, ...
        return None
    return loops


def warm_up() -> None:
    """Load the compiled loops and run each once, so that the first real call does not wait."""
    source = np.zeros((1, 3))
    affine = np.zeros((4, 3))
    points = np.zeros((2, 3))
    _evaluate(source, source, affine, points, compile_always=True)
    evaluate_preview(source, source, affine, points.astype(np.float32), compile_always=True)


def evaluate(source: Matrix, weights: Matrix, affine: Matrix, points: ArrayLike) -> Matrix:
    """Return ``f(points)`` in double precision.

    Parameters
    ----------
    source, weights
        (n, 3) source landmarks in mesh units, and their weights for ``U = +r``.
    affine
        (4, 3) rows ``a1 ... a4``.
    points
        (m, 3) points in the source's frame and unit.

    Returns
    -------
    (m, 3) float64
        In the destination's frame and unit.

    Raises
    ------
    LandmarkError
        When a point is not finite (the message names its row) or the shape is another.

    Examples
    --------
    >>> import numpy as np
    >>> shift = np.vstack([[1, 0, 0], np.eye(3)])
    >>> evaluate(np.zeros((1, 3)), np.zeros((1, 3)), shift, [[0, 0, 0]]).tolist()
    [[1.0, 0.0, 0.0]]
    """
    points = np.ascontiguousarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise LandmarkError(f"The points have the shape {points.shape} instead of (m, 3).")
    usable = np.abs(points) <= LARGEST_COORDINATE
    if not usable.all():
        row = int(np.flatnonzero(~usable.all(axis=1))[0])
        raise LandmarkError(f"The point in row {row} is not usable: {points[row].tolist()}.")
    return _evaluate(source, weights, affine, points)


def _evaluate(
    source: Matrix,
    weights: Matrix,
    affine: Matrix,
    points: Matrix,
    *,
    compile_always: bool = False,
) -> Matrix:
    centre = source.mean(axis=0) if len(source) else np.zeros(3)
    about_centre = affine.copy()
    about_centre[0] += centre @ affine[1:]
    local, moved = points - centre, source - centre
    large = len(points) * len(source) >= WORTH_COMPILING
    loops = compiled() if large or compile_always else None
    if loops is not None:
        out = np.empty_like(local)
        with _one_at_a_time:
            loops.evaluate_double(moved, np.ascontiguousarray(weights), about_centre, local, out)
        return out
    return evaluate_with_numpy(moved, weights, about_centre, local)


def evaluate_with_numpy(source: Matrix, weights: Matrix, affine: Matrix, points: Matrix) -> Matrix:
    """Return ``f(points)`` without compiled code, in chunks of bounded memory."""
    out = affine[0] + points @ affine[1:]
    step = max(1, CHUNK // max(1, len(source)))
    for first in range(0, len(points) if len(source) else 0, step):
        part = slice(first, first + step)
        out[part] += cdist(points[part], source) @ weights
    return np.asarray(out)


def evaluate_preview(
    source: Matrix,
    weights: Matrix,
    affine: Matrix,
    points: NDArray[np.float32],
    out: NDArray[np.float32] | None = None,
    *,
    compile_always: bool = False,
) -> NDArray[np.float32]:
    """Return ``f(points)`` with single-precision distances, for the screen.

    Points, source and affine part must be given about a common centre near the landmarks: far
    from the origin single precision has no digits left. The error is about 5e-6 of the bounding
    box at 1000 landmarks.
    """
    if out is None:
        out = np.empty(points.shape, np.float32)
    large = len(points) * len(source) >= WORTH_COMPILING
    loops = compiled() if large or compile_always else None
    if loops is None:
        out[:] = evaluate_with_numpy(source, weights, affine, points.astype(np.float64))
        return out
    with _one_at_a_time:
        loops.evaluate_single(
            source.astype(np.float32), weights.astype(np.float32), affine, points, out
        )
    return out
