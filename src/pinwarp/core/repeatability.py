"""How precisely landmarks were digitised, from the same set digitised two or more times.

The repeats stand in one frame, so nothing is aligned: with ``x_ik`` the place of landmark i in
repeat k of ``n_i``, and ``m_i`` their mean, its spread is
``sqrt(sum_k |x_ik - m_i|^2 / (n_i - 1))``, a length. Pooled over the landmarks the variance of one
coordinate is ``sum_ik |x_ik - m_i|^2 / (3 sum_i (n_i - 1))``: the within-landmark mean square of a
one-way analysis of variance (for one coordinate: Bland and Altman 1996, BMJ 313:744).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import chdtri

from pinwarp.core.errors import LandmarkError
from pinwarp.core.lengths import rounding_among

Matrix = NDArray[np.float64]

CONFIDENCE = 0.95
# By chance one set of landmarks in a hundred has one that stands out.
BY_CHANCE = 0.01


@dataclass(frozen=True, eq=False)
class Repeatability:
    """The precision of n landmarks; lengths in the unit of the repeats.

    Attributes
    ----------
    counts : (n,) int
        In how many repeats each was placed.
    means : (n, 3)
        Where they lie on average; NaN where a landmark was never placed.
    spreads : (n,)
        Root mean square distance from the mean, with n - 1; NaN below two repeats.
    shares : (n, 3)
        The share of each axis in the square of a spread; NaN where that is 0 or not known.
    freedom : int
        Degrees of freedom of the variance: 3 for every repeat of a landmark beyond its first.
    variance : float
        Of one coordinate, pooled.
    axis_variances : (3,)
        The same of each axis.
    outstanding : (n,) bool
        Whose spread is larger than chance makes of the median one: one set in a hundred has one.
    variance_without : float
        The pooled variance without these; NaN where none is left.
    """

    counts: NDArray[np.intp]
    means: Matrix
    spreads: Matrix
    shares: Matrix
    freedom: int
    variance: float
    axis_variances: Matrix
    outstanding: NDArray[np.bool_]
    variance_without: float

    @property
    def spread(self) -> float:
        """The pooled spread: of a landmark in space, as those of single ones."""
        return float(np.sqrt(3 * self.variance))

    @property
    def variance_interval(self) -> tuple[float, float]:
        """Where the variance lies with 95 % confidence, were the errors normal and alike.

        ``freedom * variance / chi2``, of the quantiles of the chi-squared distribution.
        """
        tail = (1 - CONFIDENCE) / 2
        total = self.freedom * self.variance
        return (
            total / float(chdtri(self.freedom, tail)),
            total / float(chdtri(self.freedom, 1 - tail)),
        )

    @property
    def interval(self) -> tuple[float, float]:
        """The same for the pooled spread."""
        low, high = self.variance_interval
        return math.sqrt(3 * low), math.sqrt(3 * high)


def repeatability(places: ArrayLike) -> Repeatability:
    """Return how precisely landmarks were digitised.

    Parameters
    ----------
    places
        (k, n, 3) places of n landmarks in k repeats, in one frame and unit; NaN where one is
        missing.

    Raises
    ------
    LandmarkError
        When no landmark was placed twice, or the shape is another.

    Examples
    --------
    >>> found = repeatability([[[0, 0, 0], [9, 0, 0]], [[2, 0, 0], [9, 4, 0]]])
    >>> found.spreads.round(3).tolist(), found.freedom, found.variance
    ([1.414, 2.828], 6, 1.6666666666666667)
    """
    places = np.asarray(places, dtype=np.float64)
    if places.ndim != 3 or places.shape[2] != 3:
        raise LandmarkError(f"Repeats have the shape (k, n, 3), not {places.shape}.")
    there = np.isfinite(places).all(axis=2)
    counts = there.sum(axis=0)
    twice = counts > 1
    if not twice.any():
        raise LandmarkError("No landmark was placed in two repeats: there is nothing to compare.")
    filled = np.where(there[..., None], places, 0.0)
    means = filled.sum(axis=0) / np.where(counts, counts, np.nan)[:, None]
    off = np.where(there[..., None], places - means, 0.0)
    off[np.abs(off) <= rounding_among(filled)] = 0.0
    squares = np.sum(off * off, axis=0)
    squares[~twice] = np.nan
    free = np.where(twice, counts - 1, 0)
    totals = squares.sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        spreads = np.sqrt(totals / np.where(twice, free, np.nan))
        shares = squares / np.where(totals > 0, totals, np.nan)[:, None]
    freedom = 3 * int(free.sum())
    axis_variances = 3 * np.nansum(squares, axis=0) / freedom
    outstanding = _outstanding(totals, 3 * free)
    kept = twice & ~outstanding
    without = np.sum(totals[kept]) / (3 * free[kept].sum()) if kept.any() else np.nan
    return Repeatability(
        counts=counts,
        means=means,
        spreads=spreads,
        shares=shares,
        freedom=freedom,
        variance=float(axis_variances.mean()),
        axis_variances=axis_variances,
        outstanding=outstanding,
        variance_without=float(without),
    )


def _outstanding(totals: Matrix, freedom: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return whose sum of squares is too large for the variance that the median one shows."""
    known = freedom > 0
    result = np.zeros(len(totals), dtype=bool)
    # The median, for a mean would be made of those that are sought.
    usual = float(np.median(totals[known] / chdtri(freedom[known], 0.5)))
    if usual > 0:
        # Of n landmarks (Sidak): each may stand out less often than one set of them does.
        tail = 1 - (1 - BY_CHANCE) ** (1 / known.sum())
        result[known] = totals[known] > usual * chdtri(freedom[known], tail)
    return result
