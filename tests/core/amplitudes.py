"""How strongly a field varies by its pairs and by what is known of bones, to the letter."""

from __future__ import annotations

import numpy as np
from scipy import stats
from scipy.spatial.distance import cdist
from scipy.special import digamma


def sigma_of(
    G: np.ndarray,
    source: np.ndarray,
    destination: np.ndarray,
    axes: int = 3,
    size: float | None = None,
) -> float:
    """The scale of a prediction, of the matrix that takes what is observed to the weights."""
    if size is None:
        size = float(np.linalg.norm(np.ptp(source, axis=0)))
    spreads = [np.sqrt(np.var(places, axis=0).sum()) for places in (source, destination)]
    variance = (0.055 * spreads[1] / spreads[0]) ** 2 * size / 2
    told = np.mean((G @ destination) ** 2 / np.diag(G)[:, None])
    known = variance * np.mean(np.diag(G @ -cdist(source, source) @ G) / np.diag(G))
    figures = 3 * (len(source) - axes - 1)
    told /= np.exp(digamma(figures / 2)) / (figures / 2)
    both = np.exp(np.average(np.log([known, told]), weights=[2, figures]))
    # As wide as it takes to hold as much within 2 as a normal distribution.
    wider = stats.f(3, figures + 2).ppf(stats.chi2(3).cdf(4)) * 3 / 4
    return float(np.sqrt(both * wider))
