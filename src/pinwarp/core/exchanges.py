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
        The log likelihood after the exchange, and who is exchanged, in the order of the rows.

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
    levels = slice(0, None, STRIDE)
    y, misfit = seen.destination[rows], seen.misfit[levels]
    across = seen.pulls[levels, rows] @ y.T
    across -= np.diagonal(across, axis1=1, axis2=2)[:, :, None]
    after = seen.block(levels, rows.tolist())
    diagonal = np.diagonal(after, axis1=1, axis2=2).copy()
    after *= -2
    after += diagonal[:, :, None]
    after += diagonal[:, None]
    after *= cdist(y, y) ** 2
    after += 2 * (across + across.swapaxes(1, 2))
    after += misfit[:, None, None]
    # Nobody is exchanged with himself.
    after[:, range(len(rows)), range(len(rows))] = np.inf
    flat = after.reshape(len(after), -1)
    left = np.maximum(flat.min(axis=1), LEAST * misfit)
    likely = seen.likelihood(left, seen.log_det[levels])
    best = int(likely.argmax())
    i, j = sorted(divmod(int(flat[best].argmin()), len(rows)))
    return float(likely[best]), int(rows[i]), int(rows[j])
