"""Lengths: which of them are only rounding, and the one figure for many."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

# A length below this share of the largest coordinate is rounding, and is taken for 0.
ROUNDING = 1e-9


def rounding_among(*places: ArrayLike) -> float:
    """Return the length below which there is only rounding among coordinates of any shape.

    Examples
    --------
    >>> rounding_among([[0.0, -40.0, 3.0]], [1.0]) == 40 * ROUNDING
    True
    """
    return ROUNDING * max((float(np.abs(x).max(initial=0.0)) for x in places), default=0.0)


def rms(lengths: ArrayLike) -> float:
    """Return the root mean square of at least one length.

    Examples
    --------
    >>> rms([3.0, 4.0]) == 12.5**0.5
    True
    """
    values = np.asarray(lengths, dtype=np.float64)
    return float(np.sqrt(np.mean(values * values)))
