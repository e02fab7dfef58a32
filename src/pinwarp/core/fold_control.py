"""Where a warp that is being fitted would fold or crush the source, asked at every step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinwarp.core import kernel
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.spline import Spline

Matrix = NDArray[np.float64]

# No vertex may lose more volume than to this share of the median, or this share of its own.
LEAST_VOLUME = 0.1
OWN_VOLUME = 0.5
# Single precision may be wrong by less than this share of the median.
DOUBT = 0.01


class FoldControl:
    """Says where a warp takes more volume than the landmarks' own warp may excuse.

    Parameters
    ----------
    first
        The landmarks' own warp.
    judged
        (m, 3) places of the source, at each of which it is asked.

    Examples
    --------
    >>> from pinwarp.core.spline import factorise, solve
    >>> source = np.vstack([np.zeros(3), np.eye(3)])
    >>> first, flat = (solve(factorise(source), source * [1, 1, z]) for z in (1.0, 0.01))
    >>> control = FoldControl(first, np.array([[0.2, 0.2, 0.2]]))
    >>> len(control.bad(first)), len(control.bad(flat))
    (0, 1)
    """

    def __init__(self, first: Spline, judged: Matrix) -> None:
        self._judged = judged
        volumes = determinants(jacobians(first, judged))
        # Handed alike: mirrored sets were refused. What the landmarks fold is theirs to mend.
        median = abs(float(np.median(volumes)))
        least = np.minimum(LEAST_VOLUME * median, OWN_VOLUME * volumes)
        self._least = np.where(volumes <= 0, -np.inf, least)
        self._doubtful = self._least + DOUBT * median

    def bad(self, spline: Spline) -> Matrix:
        """Return the (b, 3) places of the source that lose too much."""
        rough = kernel.evaluate_jacobian_preview(
            spline.source, spline.weights, spline.affine, self._judged, spline.basis
        )
        rough_volumes = determinants(rough.astype(np.float64))
        # Only where five digits may not tell, it takes all.
        rows = np.flatnonzero(~(rough_volumes >= self._doubtful))
        volumes = determinants(jacobians(spline, self._judged[rows]))
        return self._judged[rows[volumes < self._least[rows]]]
