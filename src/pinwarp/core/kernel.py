"""Evaluate thin-plate splines at many points: compiled where that pays, plain numpy elsewhere."""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist

from pinwarp.core.basis import Basis
from pinwarp.core.blocks import BLOCK, LARGEST_FIELD
from pinwarp.core.cache_folder import private_cache
from pinwarp.core.positions import as_positions

Matrix = NDArray[np.float64]
Single = NDArray[np.float32]

# Below this many distances numpy is done before numba would have been loaded.
WORTH_COMPILING = 300_000
# Distances held at once by the numpy path: 32 MB.
CHUNK = 4_000_000
# Below this many sums (about a millisecond) a second thread costs more to wake than it saves.
WORTH_THREADS = 4_000_000

# Not every threading layer of numba survives two callers at once; each call uses all cores anyway.
_one_at_a_time = threading.Lock()


@contextlib.contextmanager
def _threads_for(sums: int) -> Iterator[None]:
    """Run compiled loops, one caller at a time, on as many threads as so many sums deserve."""
    import numba

    with _one_at_a_time:
        numba.set_num_threads(numba.config.NUMBA_NUM_THREADS if sums >= WORTH_THREADS else 1)
        yield


@functools.cache
def compiled() -> ModuleType | None:
    """Return the compiled loops, or None where numba cannot compile."""
    beside = _is_writable(Path(__file__).parent) and not getattr(sys, "frozen", False)
    if not beside and "NUMBA_CACHE_DIR" not in os.environ:
        # A package folder for reading only (a system-wide install), or a bundle, whose signature
        # speaks for every file in it: numba caches elsewhere.
        os.environ["NUMBA_CACHE_DIR"] = str(private_cache())
    try:
        from pinwarp.core import compiled as loops

        points = np.zeros((2, 3))
        loops.evaluate(points, points, np.zeros((4, 3)), points, np.empty_like(points), None)
    except Exception as error:  # numba fails in many ways: no LLVM for the platform, no cache, ...
        logging.getLogger(__name__).warning("warping without compiled code: %s", error)
        return None
    return loops


def _is_writable(folder: Path) -> bool:
    return os.access(folder, os.W_OK)


def warm_up() -> None:
    """Load the compiled loops and run each once, so that the first real call does not wait."""
    loops = compiled()
    if loops is None:
        return
    source, affine = np.zeros((1, 3), np.float32), np.zeros((4, 3))
    points = np.zeros((2, 3), np.float32)
    evaluate_preview(source, source, affine, points, loops=loops)
    fields = evaluate_fields(source, np.zeros((1, 3)), affine, points, loops=loops)
    combine_fields(fields, np.zeros(1), affine, points, loops=loops)
    influence = evaluate_scalar(source, np.zeros(1), np.zeros(4), points, loops=loops)
    evaluate_jacobian(np.zeros((1, 3)), np.zeros((1, 3)), affine, points, loops=loops)
    loops.pulls(np.zeros((1, 3)), np.zeros((1, 3)), np.empty((1, 1)))
    add_influence(points, influence, np.zeros(3), np.empty_like(points), loops=loops)


def _worth(count: int) -> ModuleType | None:
    return compiled() if count >= WORTH_COMPILING else None


def evaluate(
    source: Matrix, weights: Matrix, affine: Matrix, points: ArrayLike, basis: Basis = Basis.R
) -> Matrix:
    """Return ``f(points)`` in double precision.

    Parameters
    ----------
    source, weights
        (n, 3) source landmarks in mesh units, and their weights for ``U = +r`` or what else the
        basis is.
    affine
        (4, 3) rows ``a1 ... a4``.
    points
        (m, 3) points in the source's frame and unit.
    basis
        ``U``.

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
    points = as_points(points)
    centre = source.mean(axis=0) if len(source) else np.zeros(3)
    about_centre = about(affine, centre)
    local, moved = points - centre, source - centre
    loops = _worth(len(points) * len(source))
    if loops is None:
        return _evaluate_with_numpy(moved, weights, about_centre, local, basis)
    with _threads_for(len(points) * len(source)):
        # The points are our own copy: the result may take their place.
        whole = np.ascontiguousarray(weights)
        loops.evaluate(moved, whole, about_centre, local, local, _logarithmic(basis))
    return local


def evaluate_jacobian(
    source: Matrix,
    weights: Matrix,
    affine: Matrix,
    points: ArrayLike,
    basis: Basis = Basis.R,
    *,
    loops: ModuleType | None = None,
) -> Matrix:
    """Return ``J[m, c, j] = d f_c / d v_j`` in double precision.

    ``J = A + sum_i w_i (v - u_i)^T U'(r_i) / r_i``; at a landmark its own term is left out.

    Parameters
    ----------
    source, weights, affine, points, basis
        As for :func:`evaluate`.

    Returns
    -------
    (m, 3, 3) float64
        Destination units per source unit.
    """
    points = as_points(points)
    out = np.empty((len(points), 3, 3))
    loops = loops or _worth(3 * len(points) * len(source))
    if loops is not None:
        with _threads_for(3 * len(points) * len(source)):
            whole = np.ascontiguousarray(weights)
            loops.evaluate_jacobian(source, whole, affine, points, out, _logarithmic(basis))
        return out
    out[:] = affine[1:].T
    step = max(1, CHUNK // max(1, len(source)))
    for first in range(0, len(points) if len(source) else 0, step):
        part = slice(first, first + step)
        along = basis.slope(cdist(points[part], source))
        for j in range(3):
            slopes = (points[part, j, None] - source[:, j]) * along
            out[part, :, j] += slopes @ weights
    return out


def evaluate_jacobian_preview(
    source: Matrix, weights: Matrix, affine: Matrix, points: Matrix, basis: Basis = Basis.R
) -> NDArray[Any]:
    """Return what :func:`evaluate_jacobian` does to about five digits, in half the time."""
    loops = _worth(3 * len(points) * len(source))
    if loops is None or basis is not Basis.R:
        return evaluate_jacobian(source, weights, affine, points, basis)
    # Far from the origin single precision has no digits left, and squares of small ones vanish.
    centre = source.mean(axis=0)
    size = float(np.ptp(source, axis=0).max()) or 1.0
    places = ((values - centre) / size for values in (source, points))
    moved, local = map(_single, places)
    out = np.empty((len(points), 3, 3), np.float32)
    with _threads_for(3 * len(points) * len(source)):
        loops.evaluate_jacobian(moved, _single(weights), _single(affine), local, out, None)
    return out


def pulls(places: Matrix, directions: Matrix) -> Matrix:
    """Return (c, c) ``-|p_a - p_b| (d_a . d_b)`` of (c, 3) places and directions."""
    count = len(places)
    loops = _worth(count * count)
    if loops is None:
        found = cdist(places, places)
        found *= directions @ directions.T
        return np.negative(found, out=found)
    found = np.empty((count, count))
    with _threads_for(count * count):
        loops.pulls(places, directions, found)
    return found


def as_points(points: ArrayLike) -> Matrix:
    """Return the points as (m, 3) float64; LandmarkError where that cannot be."""
    return as_positions(points, "point", fresh=False)


def about(affine: Matrix, centre: Matrix) -> Matrix:
    """Return an affine part as it reads in coordinates about another centre."""
    moved = affine.copy()
    moved[0] += centre @ affine[1:]
    return moved


def _logarithmic(basis: Basis) -> bool | None:
    """Return the basis as the loops want it: each is compiled for None, and for True if asked."""
    return None if basis is Basis.R else True


def _evaluate_with_numpy(
    source: NDArray[Any],
    weights: NDArray[Any],
    affine: NDArray[Any],
    points: NDArray[Any],
    basis: Basis = Basis.R,
) -> Matrix:
    """Return ``affine . (1, v) + sum weights U`` for any number of columns, chunk by chunk."""
    out = affine[0] + points @ affine[1:]
    step = max(1, CHUNK // max(1, len(source)))
    for first in range(0, len(points) if len(source) else 0, step):
        part = slice(first, first + step)
        out[part] += basis.of(cdist(points[part], source)) @ weights
    return np.asarray(out)


# Previews. Points, source and affine part are about a common centre near the landmarks: far from
# the origin single precision has no digits left.


def evaluate_preview(
    source: NDArray[Any],
    weights: NDArray[Any],
    affine: Matrix,
    points: Single,
    out: Single | None = None,
    *,
    loops: ModuleType | None = None,
) -> Single:
    """Return ``f(points)`` with single-precision distances and double-precision totals.

    For the basis r alone: of ``r^2 log r`` too many digits cancel. The error is about 5e-6 of the
    bounding box at 1000 landmarks.
    """
    if out is None:
        out = np.empty(points.shape, np.float32)
    loops = loops or _worth(len(points) * len(source))
    if loops is None:
        out[:] = _evaluate_with_numpy(source, weights, affine, points)
        return out
    with _threads_for(len(points) * len(source)):
        loops.evaluate(_single(source), _single(weights), affine, points, out, None)
    return out


@dataclass(frozen=True, eq=False)
class Fields:
    """Scalar fields over points in 16 bits, scaled block by block.

    Attributes
    ----------
    values : (k, m) int16
    scales : (blocks, k) float32
    """

    values: NDArray[np.int16]
    scales: Single


def evaluate_fields(
    source: NDArray[Any],
    weights: NDArray[Any],
    affine: NDArray[Any],
    points: Single,
    basis: Basis = Basis.R,
    *,
    loops: ModuleType | None = None,
) -> Fields:
    """Return k scalar splines over the same landmarks: weights (n, k), affine (4, k).

    Single precision is for the basis r: of ``r^2 log r`` too many digits cancel.
    """
    count, wanted = len(points), weights.shape[1]
    blocks = -(-count // BLOCK)
    values = np.empty((wanted, count), np.int16)
    scales = np.empty((blocks, wanted), np.float32)
    loops = loops or _worth(count * len(source) * wanted // 3)
    if loops is not None and basis is Basis.R:
        with _threads_for(count * len(source)):
            loops.evaluate_fields(
                _single(source), _single(weights), _single(affine), points, values, scales
            )
        return Fields(values, scales)
    for block in range(blocks):
        part = slice(block * BLOCK, (block + 1) * BLOCK)
        exact = _evaluate_with_numpy(source, weights, affine, points[part], basis)
        scales[block] = np.maximum(np.abs(exact).max(axis=0), 1e-30) / LARGEST_FIELD
        values[:, part] = np.rint(exact / scales[block]).T
    return Fields(values, scales)


def combine_fields(
    fields: Fields,
    shares: Matrix,
    affine: Matrix,
    points: Single,
    *,
    loops: ModuleType | None = None,
) -> Single:
    """Return ``affine . (1, v) + sum_k shares[k] field_k``, fields in threes for x, y, z."""
    out = np.empty(points.shape, np.float32)
    loops = loops or _worth(fields.values.size)
    if loops is not None:
        with _threads_for(fields.values.size):
            loops.combine_fields(
                fields.values, fields.scales, _single(shares), _single(affine), points, out
            )
        return out
    for block in range(len(fields.scales)):
        part = slice(block * BLOCK, (block + 1) * BLOCK)
        exact = fields.values[:, part] * fields.scales[block][:, None]
        bent = np.einsum("k,kcm->mc", shares, exact.reshape(len(shares), 3, exact.shape[1]))
        out[part] = affine[0] + points[part] @ affine[1:] + bent
    return out


def evaluate_scalar(
    source: NDArray[Any],
    weights: NDArray[Any],
    affine: NDArray[Any],
    points: Single,
    basis: Basis = Basis.R,
    *,
    loops: ModuleType | None = None,
) -> Single:
    """Return one scalar spline (m,): weights (n,), affine (4,)."""
    if basis is not Basis.R:
        # The logarithm takes so long that the same three times over costs nothing.
        weights, affine = (np.repeat(part[:, None], 3, axis=1) for part in (weights, affine))
        return _single(evaluate(source, weights, affine, points, basis)[:, 0])
    out = np.empty(len(points), np.float32)
    loops = loops or _worth(len(points) * len(source))
    if loops is not None:
        with _threads_for(len(points) * len(source)):
            loops.evaluate_scalar(_single(source), _single(weights), _single(affine), points, out)
        return out
    out[:] = _evaluate_with_numpy(source, weights[:, None], affine[:, None], points)[:, 0]
    return out


def add_influence(
    start: Single,
    influence: Single,
    shift: NDArray[Any],
    out: Single,
    *,
    loops: ModuleType | None = None,
) -> Single:
    """Write ``start + influence (x) shift`` into out and return it."""
    loops = loops or _worth(start.size)
    if loops is not None:
        with _threads_for(start.size):
            loops.add_influence(start, influence, _single(shift), out)
        return out
    np.add(start, influence[:, None] * _single(shift), out=out)
    return out


def _single(values: NDArray[Any]) -> Single:
    return np.ascontiguousarray(values, dtype=np.float32)
