"""What a warp does to something of finite size: the affine map that fits it best there.

Never the derivative: a thin-plate spline in three dimensions has the tip of a cone at every
landmark, and what stands on one would be turned at random.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.lengths import rms

Matrix = NDArray[np.float64]
Warp = Callable[[Matrix], Matrix]


@dataclass(frozen=True, eq=False)
class LocalAffine:
    """The least-squares affine map of a warp over some places.

    Attributes
    ----------
    linear : (3, 3) float64
        Its columns are where the axes go.
    centre : (3,) float64
        Where the middle of the places goes.
    rotation : (3, 3) float64
        The proper rotation nearest to ``linear``: the local turn.
    misfit : float
        How far the warp is from it, root mean square over the places.
    """

    linear: Matrix
    centre: Matrix
    rotation: Matrix
    misfit: float


def local_affine(warp: Warp, middle: Matrix, offsets: Matrix) -> LocalAffine:
    """Fit an affine map to a warp around a place.

    Parameters
    ----------
    warp
        Takes (m, 3) places.
    middle
        (3,) the place.
    offsets
        (m, 3) places of the object as seen from there, not all in a plane.

    Examples
    --------
    >>> fit = local_affine(lambda x: 2 * x, np.ones(3), directions(8))
    >>> (fit.linear.round(6) + 0.0).tolist()
    [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]
    >>> fit.centre.round(6).tolist()
    [2.0, 2.0, 2.0]
    """
    carried = warp(middle + offsets)
    columns = np.column_stack([offsets, np.ones(len(offsets))])
    fit, *_ = np.linalg.lstsq(columns, carried, rcond=None)
    linear = np.asarray(fit[:3].T, dtype=np.float64)
    left, _, right = np.linalg.svd(linear)
    proper = np.diag([1.0, 1.0, float(np.sign(np.linalg.det(left @ right)))])
    misfit = rms(np.linalg.norm(carried - columns @ fit, axis=1))
    return LocalAffine(linear, fit[3], np.asarray(left @ proper @ right), misfit)


def directions(half: int = 64) -> Matrix:
    """Return unit vectors spread evenly over the sphere, each with its opposite, (2 half, 3).

    Examples
    --------
    >>> directions(10).shape, bool(abs(directions(10).sum()) < 1e-9)
    ((20, 3), True)
    """
    number = np.arange(half) + 0.5
    # A spiral by the golden angle over the upper half (Saff and Kuijlaars 1997).
    height = 1 - number / half
    angle = np.pi * (3 - np.sqrt(5)) * number
    level = np.sqrt(1 - height**2)
    upper = np.column_stack([level * np.cos(angle), level * np.sin(angle), height])
    return np.concatenate([upper, -upper])
