"""How strongly bones differ from an affine map of one another: what scales a warp's uncertainty.

Pairs tell it by how badly they foretell one another, few of them badly. What bones of that size are
known for is the belief beforehand, and the pairs change it: on a logarithmic scale, since an
amplitude is as likely to be half as twice of what was believed. Both estimates of ``log sigma^2``
are weighted by their precision (Gelman et al., Bayesian Data Analysis, 2013, section 2.5), which is
half their degrees of freedom: 2 for the belief, 3 for each way that the pairs have to bend.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from scipy.special import digamma, fdtri

from pinwarp.core.basis import Basis
from pinwarp.core.factor import SourceFactor

Matrix = NDArray[np.float64]

# By how much of a bone's size a coordinate strays between its two ends, over that size, and how
# many figures that belief counts for.
PRIOR_SHARE, PRIOR_FIGURES = 0.055, 2.0

# The share of a normal distribution in space within twice its standard deviation.
WITHIN_TWO = 0.7385358700508888


def believed(factor: SourceFactor, destination: Matrix, size: float) -> float:
    """Return what is known of bones, as the variance per length that a field of the basis r has.

    A coordinate strays by :data:`PRIOR_SHARE` of the size between two places that far apart, by
    the square root of that at shorter distances: ``2 v d`` is its variance over a distance d.

    Parameters
    ----------
    factor
        The source landmarks.
    destination
        (n, 3) destination landmarks; they tell how lengths grow.
    size
        The extent of the source bone, a length in its unit.

    Returns
    -------
    float
        In the square of the destination's unit over the source's.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> value = believed(factorise(corners), 2 * corners, 10.0)
    >>> round(float(np.sqrt(2 * value * 10)), 6)  # 5.5 % of a bone that is 20 on the destination
    1.1
    """
    spread = float(np.sqrt(np.mean(np.sum((destination - destination.mean(axis=0)) ** 2, axis=1))))
    # One place says nothing of how lengths grow.
    grown = spread / factor.scale if factor.rank else 1.0
    return (PRIOR_SHARE * grown) ** 2 * size / 2


def amplitude(
    factor: SourceFactor, displacement: Matrix, certainty: Matrix, variance: float
) -> float:
    """Return ``sigma`` of the warp's prediction.

    The pairs' own figure is the mean over pairs and axes of the squared standardised leave-one-out
    errors, ``(G y)_i^2 / G_ii`` with ``G = Q2 Z (Lambda + s)^-1 Z^T Q2^T``, and what it would be in
    a field of the believed variance is the belief. What is estimated from few figures is wider by
    as much as a t distribution is than a normal one, so that as many true places lie within twice
    of it.

    Parameters
    ----------
    factor
        The source landmarks.
    displacement
        (n, 3) what the warp is to explain.
    certainty
        (modes,) weight of each mode, from :meth:`~pinwarp.core.factor.SourceFactor.certainty`.
    variance
        What is believed, from :func:`believed`.

    Returns
    -------
    float
        In the destination's unit, relative to the stiffest mode.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> rng = np.random.default_rng(0)
    >>> factor, bent = factorise(rng.normal(size=(5, 3))), rng.normal(size=(5, 3))
    >>> certainty = factor.certainty(np.zeros(1))[0][:, 0]
    >>> wild, tame = (amplitude(factor, bent, certainty, v) for v in (1.0, 1e-3))
    >>> bool(tame < wild)
    True
    """
    figures = 3 * int(factor.usable_modes.sum())
    if not figures:
        return spread_of(PRIOR_FIGURES) * float(np.sqrt(variance * factor.stiffest_mode))
    modes = factor.modes_at_landmarks
    pulls = modes @ (certainty[:, None] * (modes.T @ displacement))
    diagonal = (modes * modes) @ certainty
    judged = diagonal > np.finfo(np.float64).eps * float(diagonal.max())
    told = float(np.mean(pulls[judged] ** 2 / diagonal[judged, None]))
    expected = variance * float(np.mean(_pulled(factor, certainty)[judged] / diagonal[judged]))
    # The logarithm of a mean of squares is less than that of what they come from.
    missing = float(digamma(figures / 2) - np.log(figures / 2))
    count = PRIOR_FIGURES + figures
    level = PRIOR_FIGURES * np.log(expected) + figures * (np.log(told) - missing)
    return spread_of(count) * float(np.exp(level / count / 2))


def spread_of(figures: float) -> float:
    """Return by how much wider a t distribution in space is than a normal one.

    So that both have the same share within twice the deviation.

    Parameters
    ----------
    figures
        Degrees of freedom, more than 0.

    Examples
    --------
    >>> [round(spread_of(figures), 2) for figures in (2, 5, 8, 26, 1000)]
    [1.49, 1.17, 1.1, 1.03, 1.0]
    """
    return float(np.sqrt(3 * fdtri(3, figures, WITHIN_TWO)) / 2)


def _pulled(factor: SourceFactor, certainty: Matrix) -> Matrix:
    """Return the variance of each landmark's pull in a field of variance 1 per length."""
    modes = factor.modes_at_landmarks * certainty
    if factor.basis is Basis.R:
        # There a mode's eigenvalue is its variance.
        return np.asarray(modes**2 @ np.maximum(factor.modes[0], 0.0))
    bent = factor.modes_at_landmarks.T @ -cdist(factor.source, factor.source)
    covariance = bent @ factor.modes_at_landmarks
    return np.asarray(np.einsum("ik,kl,il->i", modes, covariance, modes, optimize=True))
