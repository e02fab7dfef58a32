"""Small work done often: one solve of few pairs, one point. Compiled once that pays.

A script that warps point after point, as OPynSim's do, spends its time on numpy being called;
one that warps a single one would only wait for the compiled code to be loaded, half a second.
The two agree to rounding, not to the last bit.
"""

from __future__ import annotations

import itertools
import logging
import math
from types import ModuleType
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from pinwarp.core import kernel
from pinwarp.core.factor import PLANAR_TOLERANCE
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.positions import as_positions
from pinwarp.core.spline import PenaltyConvention, Spline

Matrix = NDArray[np.float64]

# So many calls wait for no compiled code; who calls more often calls much more often.
PATIENCE = 100
# With more pairs the time goes into numbers, and numpy and LAPACK are as fast.
MOST_PAIRS = 400
# With fewer nothing bends.
LEAST_PAIRS = 5

_DOUBLE = np.dtype(np.float64)
_calls = itertools.count(1)
# The compiled passes once they are loaded, or None where they cannot be.
_loaded: list[ModuleType | None] = []


def loops() -> ModuleType | None:
    """Return the compiled passes, or None where they are not worth loading yet."""
    if _loaded:
        return _loaded[0]
    if next(_calls) > PATIENCE:
        warm_up()
        return _loaded[0]
    return None


def warm_up() -> None:
    """Load the compiled passes, so that no later call waits for them."""
    if not _loaded:
        _loaded.append(_load())


def _load() -> ModuleType | None:
    if kernel.compiled() is None:
        return None
    try:
        from pinwarp.core import compiled_small

        # Both are compiled here, or read from the cache, and not at a moment of their own.
        corners = np.vstack([np.zeros(3), np.eye(3), np.ones(3)])
        compiled_small.solve(corners, corners, 0.0)
        compiled_small.warp_point(np.zeros((3, 6)), np.zeros(3))
    except Exception as error:  # numba fails in many ways, as in kernel
        logging.getLogger(__name__).warning("small work without compiled code: %s", error)
        return None
    return compiled_small


def solve_ordinary(
    source: Any, destination: Any, penalty: float, convention: PenaltyConvention
) -> Spline | None:
    """Solve pairs about which there is nothing to say, but that they may be nearly planar.

    With the basis r.

    Parameters
    ----------
    source, destination
        What was given as (n, 3) positions.
    penalty, convention
        Checked already.

    Returns
    -------
    Spline or None
        None where it is for the long way (:func:`~pinwarp.core.factor.factorise` and
        :func:`~pinwarp.core.spline.solve`) to warn, to refuse, or to be faster.

    Raises
    ------
    LandmarkError
        When the positions are no table of numbers.

    Examples
    --------
    >>> warm_up()
    >>> source = np.random.default_rng(0).normal(size=(9, 3))
    >>> regularising = PenaltyConvention.REGULARISING
    >>> spline = solve_ordinary(source, 2 * source, 0.0, regularising)
    >>> np.allclose(spline.evaluate(source), 2 * source)
    True
    >>> solve_ordinary(source, 2 * source[:5], 0.0, regularising) is None
    True
    """
    if not _is_plain(source):
        source = as_positions(source, "source landmark")
    if not _is_plain(destination):
        destination = as_positions(destination, "destination landmark")
    if source.shape != destination.shape:
        return None
    if not LEAST_PAIRS <= len(source) <= MOST_PAIRS or penalty == np.inf:
        return None
    if penalty and convention is not PenaltyConvention.REGULARISING:
        return None
    compiled = loops()
    if compiled is None:
        return None
    flatness, weights, affine = compiled.solve(source, destination, penalty)
    if flatness < 0:
        return None
    findings: tuple[Finding, ...] = ()
    if flatness < PLANAR_TOLERANCE:
        findings = (Finding(FindingKind.NEARLY_PLANAR, (), flatness),)
    return Spline(source.copy(), weights, affine, penalty, convention, findings)


def _is_plain(positions: Any) -> bool:
    return (
        type(positions) is np.ndarray
        and positions.dtype == _DOUBLE
        and positions.ndim == 2
        and positions.shape[1] == 3
        and positions.flags.c_contiguous
    )


def table_of(spline: Spline) -> Matrix:
    """Return all that :func:`warp_point` needs of a spline in one array, about its centre."""
    source = spline.source
    centre = source.mean(axis=0) if len(source) else np.zeros(3)
    affine = kernel.about(spline.affine, centre)
    head = np.zeros((3, 6))
    head[0, :3], head[0, 3:], head[1, :3], head[1, 3:], head[2, :3] = centre, *affine
    return np.vstack([head, np.hstack([source - centre, spline.weights])])


def warp_point(table: Matrix, point: Matrix) -> Matrix | None:
    """Return a warped point; None where it is for the long way to refuse or to warp it.

    Parameters
    ----------
    table
        From :func:`table_of`.
    point
        (3,) float64.
    """
    compiled = loops()
    if compiled is None:
        return None
    warped: Matrix = compiled.warp_point(table, point)
    return None if math.isnan(warped.item(0)) else warped


def is_point(point: object) -> TypeGuard[Matrix]:
    """Whether something is a point as :func:`warp_point` takes it."""
    return type(point) is np.ndarray and point.dtype == _DOUBLE and point.shape == (3,)
