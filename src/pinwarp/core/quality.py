"""How well a warp is determined by its landmarks: closed forms from the one factorisation.

With ``G = Q2 Z (Lambda + s)^-1 Z^T Q2^T`` (the top left block of the inverted bordered matrix)
and destinations ``y``, the residual of pair i is ``s (G y)_i`` and its leave-one-out error
``(G y)_i / G_ii`` (Wahba, Spline Models for Observational Data, 1990, section 4.2); ``1 / G_ii``
is, up to sigma, the variance of the prediction that the other pairs make there, so
``(G y)_i / sqrt(G_ii)`` is that error standardised. All is of the regularising convention,
and ``N`` of the factor's basis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist

from pinwarp.core.factor import RANK_TOLERANCE, SourceFactor
from pinwarp.core.lengths import rms
from pinwarp.core.positions import quiet
from pinwarp.core.spline import Spline, check_penalty, displacements

Matrix = NDArray[np.float64]

# Penalties of a curve between its ends, and how far beyond the modes they reach.
SAMPLES = 60
MARGIN = 10.0
# A minimum that is not lower than both ends by this share is none.
WORTH_SUGGESTING = 1e-3
# Errors below this share of the destination's extent are rounding.
ROUNDING = 1e-11


@dataclass(frozen=True, eq=False)
class LeaveOneOut:
    """What becomes of each pair when it is left out of the solve.

    Where the pair alone fixes a direction of the affine part the others say nothing about it:
    its figures are NaN. The similarity that stands in for directions without landmarks is kept.

    Attributes
    ----------
    errors : (n, 3) float64
        Destination minus the warp that the other pairs make, in destination mesh units.
    distances : (n,)
        Their lengths.
    standardised : (n,)
        The lengths divided by how far they may be expected to be, in units of the median pair: 1
        is ordinary, 3 is suspicious. All 0 where an affine map explains every pair.
    expected : (n,)
        How far the length may be expected to be, in units of the median pair: large where a
        landmark is isolated.
    rms : float
        Root mean square of the distances.
    """

    errors: Matrix
    distances: Matrix
    standardised: Matrix
    expected: Matrix
    rms: float


@quiet
def leave_one_out(
    factor: SourceFactor, destination: ArrayLike, penalty: float = 0.0
) -> LeaveOneOut:
    """Return every pair's leave-one-out error without solving anew.

    Parameters
    ----------
    factor
        The source landmarks, from :func:`~pinwarp.core.factor.factorise`.
    destination
        (n, 3) destination landmarks.
    penalty
        The warping penalty of the regularising convention, a length in mesh units.

    Returns
    -------
    LeaveOneOut

    Examples
    --------
    >>> from pinwarp.core.spline import factorise, solve
    >>> rng = np.random.default_rng(0)
    >>> source, destination = rng.normal(size=(8, 3)), rng.normal(size=(8, 3))
    >>> without_first = solve(factorise(source[1:]), destination[1:], 0.2)
    >>> error = destination[0] - without_first.evaluate(source[:1])[0]
    >>> np.allclose(leave_one_out(factorise(source), destination, 0.2).errors[0], error)
    True
    """
    displacement, _, _ = displacements(factor, destination)
    pulls, diagonal, _ = _pulls(factor, displacement, np.array([check_penalty(penalty)]))
    diagonal = diagonal[:, 0]
    errors = pulls[:, :, 0] / diagonal[:, None]
    distances = np.linalg.norm(errors, axis=1)
    expected = 1 / np.sqrt(diagonal)
    judged = np.isfinite(diagonal)
    if not judged.any():
        return LeaveOneOut(errors, distances, distances, expected, float("nan"))
    overall = rms(distances[judged])
    expected = expected / np.median(expected[judged])
    standardised = distances / expected
    if overall <= ROUNDING * float(np.abs(np.asarray(destination)).max()):
        standardised = np.where(judged, 0.0, np.nan)
    else:
        # Nearly all pairs may be met to the last digit, as in made-up data: no division by 0.
        usual = float(np.median(standardised[judged]))
        standardised = standardised / max(usual, ROUNDING * overall)
    return LeaveOneOut(errors, distances, standardised, expected, overall)


def _pulls(
    factor: SourceFactor, displacement: Matrix, penalties: Matrix
) -> tuple[Matrix, Matrix, Matrix]:
    """Return ``G y`` (n, 3, k), the diagonal of G (n, k) and the RMS residual (k,).

    G is taken times ``stiffest mode + s``: only ratios matter, and these have a limit at infinity.
    """
    modes = factor.modes_at_landmarks
    certainty, noise = factor.certainty(penalties)
    parts = modes.T @ displacement
    left = noise * certainty
    # What the solve drops is where duplicates differ: left out, one is met by the other alone.
    dropped = certainty == 0
    if dropped.any():
        left[dropped] = 1.0
        # These modes live on the duplicates: anything elsewhere is rounding, and would be blown up.
        modes = np.where(dropped.any(axis=1) & (np.abs(modes) < 1e-6), 0.0, modes)
        certainty[dropped] = factor.stiffest_mode / factor.smallest_mode
    residual = np.sqrt((left * left).T @ np.sum(parts * parts, axis=1) / len(displacement))
    squares = modes * modes
    diagonal = squares @ certainty
    spread = parts[:, :, None] * certainty[:, None, :]
    count = len(penalties)
    pulls = (modes @ spread.reshape(len(parts), 3 * count)).reshape(-1, 3, count)
    # A pair that nothing but itself determines cannot be judged.
    diagonal[squares.sum(axis=1) <= RANK_TOLERANCE**2] = np.nan
    return pulls, diagonal, residual


@dataclass(frozen=True, eq=False)
class PenaltyCurve:
    """The figures of a warp over the warping penalty, one row for each penalty.

    Between two penalties they are taken to run straight over the flexibility.

    Attributes
    ----------
    penalties : (k,) float64
        Ascending, in mesh units.
    leave_one_out, residual : (k,)
        Root mean squares over the pairs, in destination mesh units; the former NaN where no pair
        can be left out.
    flexibility : (k,)
        From 1 (interpolation) to 0 (the affine fit); NaN where there are no modes.
    suggested : float or None
        The penalty with the least leave-one-out error; None where that is at an end of the
        curve, so that the data ask for no penalty or for all of it.
    as_good : (float, float) or None
        Between which penalties around the suggested one the error is no larger than by chance:
        the pairs' squared errors exceed those at the suggested one by no more, on average, than
        the standard error of that difference. None where none is suggested.
    is_affine : bool
        Whether an affine map meets every pair: the penalty then changes nothing.
    """

    penalties: Matrix
    leave_one_out: Matrix
    residual: Matrix
    flexibility: Matrix
    suggested: float | None
    as_good: tuple[float, float] | None
    is_affine: bool

    def at(self, flexibility: float) -> tuple[float, float]:
        """Return the leave-one-out error and the residual at a flexibility.

        Parameters
        ----------
        flexibility
            From 0 to 1; beyond the ends of the curve its ends are returned.

        Returns
        -------
        leave_one_out, residual
            Root mean squares in destination mesh units.

        Examples
        --------
        >>> from pinwarp.core.factor import factorise
        >>> rng = np.random.default_rng(0)
        >>> source, destination = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
        >>> curve = penalty_curve(factorise(source), destination)
        >>> curve.at(0.0) == (curve.leave_one_out[-1], curve.residual[-1])
        True
        """
        share, shares = 1.0 - flexibility, 1.0 - self.flexibility
        return (
            float(np.interp(share, shares, self.leave_one_out)),
            float(np.interp(share, shares, self.residual)),
        )


@quiet
def penalty_curve(
    factor: SourceFactor, destination: ArrayLike, penalties: ArrayLike | None = None
) -> PenaltyCurve:
    """Return the leave-one-out error, residual and flexibility over the penalty.

    Parameters
    ----------
    factor
        The source landmarks.
    destination
        (n, 3) destination landmarks.
    penalties
        (k,) penalties in mesh units; without them 0, then 60 from a tenth of the softest mode to
        ten times the stiffest, evenly on a logarithmic scale, and infinity.

    Returns
    -------
    PenaltyCurve

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> rng = np.random.default_rng(0)
    >>> source = rng.normal(size=(30, 3))
    >>> noisy = source + 0.2 * np.sin(source) + 0.05 * rng.normal(size=(30, 3))
    >>> curve = penalty_curve(factorise(source), noisy)
    >>> len(curve.penalties), curve.suggested is not None
    (62, True)
    """
    displacement, _, _ = displacements(factor, destination)
    poles = factor.poles
    if penalties is not None:
        grid = np.sort([check_penalty(penalty) for penalty in np.ravel(penalties)])
    elif len(poles):
        low, high = np.log(poles[0] / MARGIN), np.log(poles[-1] * MARGIN)
        grid = np.concatenate([[0.0], np.exp(np.linspace(low, high, SAMPLES)), [np.inf]])
    else:
        grid = np.zeros(1)
    pulls, diagonal, residual = _pulls(factor, displacement, grid)
    squares = np.einsum("nck,nck->nk", pulls, pulls)
    judged = np.isfinite(diagonal[:, 0])
    errors = np.full(len(grid), np.nan)
    left_out = squares[judged] / diagonal[judged] ** 2
    if judged.any():
        errors = np.sqrt(np.mean(left_out, axis=0))
    rounding = ROUNDING * float(np.abs(np.asarray(destination)).max())
    is_affine = bool(judged.any() and errors.max() <= rounding)
    if is_affine:
        # What is left is rounding, and no figure.
        errors, residual = np.zeros_like(errors), np.zeros_like(residual)
    suggested = None if is_affine else _suggested(grid, errors)
    return PenaltyCurve(
        penalties=grid,
        leave_one_out=errors,
        residual=residual,
        flexibility=np.array([factor.flexibility(penalty) for penalty in grid.tolist()]),
        suggested=suggested,
        as_good=None if suggested is None else _as_good(grid, left_out),
        is_affine=is_affine,
    )


def _suggested(penalties: Matrix, errors: Matrix) -> float | None:
    if not np.isfinite(errors).all() or len(errors) < 3:
        return None
    best = int(errors.argmin())
    worthwhile = errors[best] < (1 - WORTH_SUGGESTING) * min(errors[0], errors[-1])
    return float(penalties[best]) if worthwhile else None


def _as_good(penalties: Matrix, squares: Matrix) -> tuple[float, float]:
    """Return the range around the least mean of (n, k) squares that chance cannot tell from it."""
    best = int(np.mean(squares, axis=0).argmin())
    more = squares - squares[:, [best]]
    # The same pairs at both penalties: what they have in common does not count as chance.
    chance = np.std(more, axis=0, ddof=1) / np.sqrt(len(squares))
    worse = np.flatnonzero(np.mean(more, axis=0) > chance)
    low = worse[worse < best].max(initial=-1) + 1
    high = worse[worse > best].min(initial=len(penalties)) - 1
    return float(penalties[low]), float(penalties[high])


@quiet
def bending_energy(spline: Spline) -> Matrix:
    """Return how much each coordinate of the warp bends, up to the factor 8 pi.

    ``-w^T K w`` with ``K_ij = |u_i - u_j|``, never negative (Bookstein 1989, in 3D). With the
    basis ``r^2 log r`` it is ``w^T K w``, which in space is no integral of squared second
    derivatives but of their fractional kin of order 5/2: not to be compared with the other's.

    Parameters
    ----------
    spline
        The solved warp.

    Returns
    -------
    (3,) float64
        For x, y and z of the destination, in destination units squared per source unit, or with
        the basis ``r^2 log r`` per source unit squared.

    Examples
    --------
    >>> from pinwarp.core.spline import factorise, solve
    >>> source = np.random.default_rng(0).normal(size=(9, 3))
    >>> bending_energy(solve(factorise(source), 2 * source + 1)).round(9).tolist()
    [0.0, 0.0, 0.0]
    """
    if not len(spline.source):
        return np.zeros(3)
    bent = spline.basis.of(cdist(spline.source, spline.source)) @ spline.weights
    energy = spline.basis.sign * np.sum(spline.weights * bent, axis=0)
    return np.asarray(np.maximum(energy, 0.0))
