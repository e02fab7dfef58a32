"""Pairs that the others miss by more than most, though nothing is wrong with them."""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

from pinwarp.core.factor import SourceFactor
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.positions import quiet
from pinwarp.core.quality import LeaveOneOut

# A pair whose error may be expected to be so many times the median pair's is isolated.
ISOLATED = 1.5


@quiet
def isolated(factor: SourceFactor, left_out: LeaveOneOut) -> tuple[Finding, ...]:
    """Find pairs that the others miss by more than most, because they are far from the others.

    Parameters
    ----------
    factor
        The source landmarks.
    left_out
        The pairs' leave-one-out errors at no penalty.

    Returns
    -------
    tuple of Finding
        ISOLATED, the one with the largest error first: nothing is wrong with it.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> from pinwarp.core.quality import leave_one_out
    >>> source = np.random.default_rng(0).normal(size=(12, 3))
    >>> source[5] = [6, 0, 0]
    >>> factor = factorise(source)
    >>> [one.rows for one in isolated(factor, leave_one_out(factor, source**2))]
    [(5,)]
    """
    alone = (left_out.expected > ISOLATED) & (left_out.distances > left_out.rms)
    apart = cdist(factor.source[alone], factor.source)
    apart[np.arange(len(apart)), np.flatnonzero(alone)] = np.inf
    found = [
        Finding(FindingKind.ISOLATED, (int(row),), float(nearest), (float(missed),))
        for row, nearest, missed in zip(
            np.flatnonzero(alone), apart.min(axis=1), left_out.distances[alone], strict=True
        )
    ]
    return tuple(sorted(found, key=lambda one: -one.others[0]))
