"""The preview engine: each way the hand can move has its own shortcut to the warped vertices.

Everything here is in single precision about the centre of the mesh, for the screen; what is
exported is evaluated anew by :meth:`~pinwarp.core.spline.Spline.evaluate`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core import kernel
from pinwarp.core.basis import Basis
from pinwarp.core.errors import RangeError
from pinwarp.core.factor import SourceFactor
from pinwarp.core.positions import quiet
from pinwarp.core.spline import (
    Spline,
    back_to_landmarks,
    solve,
    solve_values,
)

Matrix = NDArray[np.float64]
Single = NDArray[np.float32]

# What single precision can hold, with some room for what a view makes of it ...
LARGEST_SINGLE = 1e37
SMALLEST_SINGLE = 1e-30
# ... and how far numbers may be from 1 that are squared in it.
AT_EASE = 1e17
# Modes are left out of a sweep below this share of the bounding box of the landmarks.
SWEEP_TOLERANCE = 1e-5
SWEEP_SAMPLES = 120


@dataclass(frozen=True, eq=False)
class PreviewPoints:
    """Vertices made ready for previews.

    Attributes
    ----------
    centre : (3,) float64
    local : (m, 3) float32
        The vertices about the centre.
    reach : float
        Their largest coordinate.
    """

    centre: Matrix
    local: Single
    reach: float

    @classmethod
    def of(cls, vertices: ArrayLike) -> PreviewPoints:
        """Centre the vertices and round them; RangeError where that leaves nothing to draw."""
        array = np.asarray(vertices, dtype=np.float64)
        centre = 0.5 * array.min(axis=0) + 0.5 * array.max(axis=0)
        reach = check_drawable(array - centre)
        local = np.empty(array.shape, np.float32)
        np.subtract(array, centre, out=local, casting="same_kind")
        return cls(centre, local, reach)


def check_drawable(vertices: Matrix) -> float:
    """Return the largest coordinate; RangeError where single precision, which is drawn, has none.

    Examples
    --------
    >>> check_drawable(np.array([[0.0, -3.0, 2.0]]))
    3.0
    """
    reach = float(max(-vertices.min(), vertices.max()))
    if reach > LARGEST_SINGLE or 0 < reach < SMALLEST_SINGLE:
        raise RangeError(f"A mesh of the size {reach:.3g} cannot be drawn: check its unit.")
    return reach


@quiet
def suits_single(spline: Spline, points: PreviewPoints) -> bool:
    """Whether single precision holds the squares of distances, and what the warp makes of them."""
    affine = kernel.about(spline.affine, points.centre)
    apart = points.reach + float(np.abs(spline.source - points.centre).max(initial=0.0))
    bent = float(np.abs(spline.weights).sum()) * 2 * apart
    warped = float(np.abs(affine[0]).max() + 3 * np.abs(affine[1:]).max() * points.reach) + bent
    return all(x == 0 or 1 / AT_EASE <= x <= AT_EASE for x in (apart, warped))


@quiet
def preview(spline: Spline, points: PreviewPoints) -> Single:
    """Return the warped points, evaluated directly; RangeError where they cannot be drawn."""
    source, affine = spline.source - points.centre, kernel.about(spline.affine, points.centre)
    # Squares times logarithms cancel too many digits for single precision.
    if spline.basis is Basis.R and suits_single(spline, points):
        return kernel.evaluate_preview(source, spline.weights, affine, points.local)
    local = points.local.astype(np.float64)
    return drawable(kernel.evaluate(source, spline.weights, affine, local, spline.basis))


def drawable(warped: Matrix) -> Single:
    """Return warped (m, 3) points in single precision; RangeError where it cannot hold them."""
    largest = float(np.abs(warped).max(initial=0.0))
    if not largest <= LARGEST_SINGLE or 0 < largest < SMALLEST_SINGLE:
        raise RangeError(
            f"The warp leaves the range of numbers that can be drawn: at {largest:.3g}. "
            "Check the unit, and the landmarks for one that is far from all others."
        )
    return np.asarray(warped, dtype=np.float32)


class PenaltySweep:
    """The warped points at any penalty of the regularising convention, by a reduced basis.

    The warp is ``affine fit + sum_i G_i(s) field_i`` with ``G_i = lambda_i / (lambda_i + s)``.
    As functions of s the ``G_i`` are smooth and alike: an SVD over a grid of penalties leaves
    about 15 combinations of the n - 4 fields, whatever n is.

    Parameters
    ----------
    factor
        The source landmarks.
    destination
        (n, 3) destination landmarks.
    points
        What is warped.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> rng = np.random.default_rng(0)
    >>> factor, destination = factorise(rng.normal(size=(9, 3))), rng.normal(size=(9, 3))
    >>> points = PreviewPoints.of(rng.normal(size=(100, 3)))
    >>> sweep = PenaltySweep(factor, destination, points)
    >>> exact = preview(solve(factor, destination, 0.3), points)
    >>> bool(np.abs(sweep.at(0.3) - exact).max() < 1e-4)
    True
    """

    def __init__(self, factor: SourceFactor, destination: ArrayLike, points: PreviewPoints) -> None:
        self._points = points
        affine_fit = solve(factor, destination, np.inf)
        self._affine = kernel.about(affine_fit.affine, points.centre)
        values, vectors = factor.modes
        self._eigenvalues = values[factor.usable_modes]
        vectors = vectors[:, factor.usable_modes]
        target = np.asarray(destination, dtype=np.float64)
        # The affine fit's residual has the same bending part as the destination itself.
        residual = (target - affine_fit.evaluate(factor.source)) / factor.scale
        parts = vectors.T @ factor.rotate(residual)[factor.rank + 1 :]
        sizes = np.linalg.norm(parts, axis=1) * factor.scale
        combinations = self._reduce(sizes, float(np.linalg.norm(np.ptp(target, axis=0))))
        self._shares = combinations * sizes
        # What combination k makes of each mode, at penalty 0.
        per_size = np.divide(1.0, sizes, out=np.zeros_like(sizes), where=sizes > 0)
        at_zero = parts * (factor.strength / self._eigenvalues)[:, None]
        combined = np.einsum("km,mc->mkc", combinations * per_size, at_zero)
        gamma = vectors @ combined.reshape(len(sizes), 3 * len(combinations))
        weights, affine = back_to_landmarks(factor, gamma)
        self._fields = kernel.evaluate_fields(
            factor.source - points.centre,
            weights,
            kernel.about(affine, points.centre - factor.centre),
            points.local,
            factor.basis,
        )

    def _reduce(self, sizes: Matrix, extent: float) -> Matrix:
        """Return the combinations (r, modes) that the penalty can make, by SVD over a grid."""
        values = self._eigenvalues
        if not len(values):
            return np.zeros((0, 0))
        low, high = np.log10(values[0]) - 3, np.log10(values[-1]) + 3
        grid = np.concatenate([[0.0], np.logspace(low, high, SWEEP_SAMPLES)])
        shrinking = values / (values + grid[:, None])
        _, strengths, combinations = np.linalg.svd(shrinking * sizes, full_matrices=False)
        return np.asarray(combinations[strengths > SWEEP_TOLERANCE * extent])

    @property
    def rank(self) -> int:
        """How many combinations are kept."""
        return len(self._shares)

    def at(self, penalty: float) -> Single:
        """Return the warped points at a penalty (mesh units; infinity is the affine fit)."""
        shares = self._shares @ (self._eigenvalues / (self._eigenvalues + penalty))
        return kernel.combine_fields(self._fields, shares, self._affine, self._points.local)


class Influence:
    """The warped points while one destination landmark moves: they follow it linearly.

    Parameters
    ----------
    factor
        The source landmarks, which must span space (rank 3).
    spline
        The warp at the beginning.
    row
        Which pair moves.
    position
        Where its destination is at the beginning.
    points
        What is warped.
    """

    def __init__(
        self,
        factor: SourceFactor,
        spline: Spline,
        row: int,
        position: ArrayLike,
        points: PreviewPoints,
    ) -> None:
        unit = np.zeros((len(factor.source), 1))
        unit[row] = 1.0
        weights, affine, _ = solve_values(factor, unit, spline.penalty, spline.convention)
        self._column = kernel.evaluate_scalar(
            factor.source - points.centre,
            weights[:, 0],
            kernel.about(affine, points.centre - factor.centre)[:, 0],
            points.local,
            factor.basis,
        )
        self._begin = np.asarray(position, dtype=np.float64)
        self._start = preview(spline, points)

    def at(self, position: ArrayLike) -> Single:
        """Return the warped points with the destination landmark at another place."""
        shift = np.asarray(position, dtype=np.float64) - self._begin
        return kernel.add_influence(self._start, self._column, shift, np.empty_like(self._start))


def can_follow(factor: SourceFactor) -> bool:
    """Whether destinations act linearly on the warp: not where a similarity fills in."""
    return factor.rank == 3
