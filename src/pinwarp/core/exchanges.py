"""Two pairs whose destinations are exchanged: all of them tried at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from pinwarp.core.evidence import Evidence

# Every so many of the noise levels are tried: the best exchange hardly depends on them.
STRIDE = 2
# An exchange leaves no less of the misfit than this: the rest is rounding.
LEAST = 1e-9


def best_exchange(seen: Evidence, rows: NDArray[np.intp]) -> tuple[float, int, int]:
    """Return the best exchange of two destinations.

    ``Q' = Q + 2 (y_j - y_i) . (U_i - U_j) + (G_ii + G_jj - 2 G_ij) |y_j - y_i|^2``.

    Parameters
    ----------
    seen
        The pairs.
    rows
        Those that may be exchanged, two or more.

    Returns
    -------
    likely, i, j
        The log likelihood after the exchange, and who is exchanged.

    Examples
    --------
    >>> from pinwarp.core.evidence import evidence
    >>> from pinwarp.core.factor import factorise
    >>> from pinwarp.core.pair_field import PairField
    >>> source = np.random.default_rng(0).normal(size=(12, 3))
    >>> swapped = source[[0, 1, 2, 7, 4, 5, 6, 3, 8, 9, 10, 11]]
    >>> seen = evidence(PairField.of(factorise(source)), swapped + 0.1 * np.sin(source))
    >>> sorted(best_exchange(seen, np.arange(12))[1:])
    [3, 7]
    """
    y = seen.destination[rows]
    apart = cdist(y, y) ** 2
    return max(_best_at(seen, rows, apart, k) for k in range(0, len(seen.misfit), STRIDE))


def _best_at(
    seen: Evidence, rows: NDArray[np.intp], apart: NDArray[np.float64], level: int
) -> tuple[float, int, int]:
    y, pulls = seen.destination[rows], seen.pulls[rows, :, level]
    G = seen.block(level, rows.tolist())
    across = pulls @ y.T
    own, diagonal = np.diag(across), np.diag(G)
    after = seen.misfit[level] + 2 * (across + across.T - own[:, None] - own)
    after += (diagonal[:, None] + diagonal - 2 * G) * apart
    np.fill_diagonal(after, np.inf)
    i, j = (int(row) for row in np.unravel_index(after.argmin(), after.shape))
    misfit = max(float(after[i, j]), LEAST * float(seen.misfit[level]))
    likely = float(seen.likelihood(misfit, float(seen.log_det[level])))
    return likely, int(rows[i]), int(rows[j])
