"""Which pairs are wrong, and in what way: facts to show beside the landmarks, never acted upon.

A wrong pair is told from one that is merely far from the others by its standardised
leave-one-out error (:mod:`pinwarp.core.quality`): the plain error is large for both. The limits
are measured on made-up bones of 6 to 40 pairs with 3 mm of noise: one pair in a hundred is
suspected wrongly, one set in a hundred has a swap that is none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.factor import RANK_TOLERANCE, SourceFactor
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.positions import as_positions, quiet
from pinwarp.core.quality import ROUNDING, LeaveOneOut, leave_one_out
from pinwarp.core.spline import Spline, check_penalty, displacements, solve

Matrix = NDArray[np.float64]

# Standardised leave-one-out errors from which a pair is suspected by itself ...
SUSPICIOUS = 2.5
# ... and together with a neighbour that lies elsewhere on the destination than on the source:
NOTICEABLE = 1.5
# their distance is so many times what the affine fit makes of it, or that fraction,
TORN = 2.5
# and the neighbour's figure at least this share of its own: else it alone is wrong.
COMPARABLE = 0.5
# A pair whose error may be expected to be so many times the median pair's is isolated.
ISOLATED = 1.5
# What an exchange must leave of the squared leave-one-out errors to be called a swap.
SHARPLY = 0.7
# What a reflection must leave of the misfit of the best rotation.
MIRRORED = 0.5


@quiet
def suspects(
    factor: SourceFactor,
    destination: ArrayLike,
    penalty: float = 0.0,
    *,
    left_out: LeaveOneOut | None = None,
    fit: Spline | None = None,
) -> tuple[Finding, ...]:
    """Judge every pair by what the others say about it.

    Parameters
    ----------
    factor
        The source landmarks, from :func:`~pinwarp.core.factor.factorise`.
    destination
        (n, 3) destination landmarks.
    penalty
        The warping penalty of the regularising convention, in mesh units.
    left_out
        The same pairs' leave-one-out errors at that penalty, where they are known already.
    fit
        Their affine fit, where it is.

    Returns
    -------
    tuple of Finding
        The most suspicious first, each landmark at most once: INCONSISTENT, two neighbours on
        one bone that are not so on the other; SUSPECT, one by itself; ISOLATED, missed by more
        than most but only because it is far from the others.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> source = np.random.default_rng(0).normal(size=(12, 3))
    >>> destination = source + 0.1 * np.sin(source)
    >>> destination[5] += [0, 1, 0]
    >>> first = suspects(factorise(source), destination)[0]
    >>> first.kind.value, first.rows
    ('suspect', (5,))
    """
    result = left_out or leave_one_out(factor, destination, penalty)
    target = np.asarray(destination, dtype=np.float64)
    linear = (fit or solve(factor, target, np.inf)).affine[1:]
    apart, ends = cdist(factor.source, factor.source), cdist(target, target)
    # The affine fit knows how the bones differ along each axis, the median cannot be led astray.
    fitted = cdist(factor.source @ linear, factor.source @ linear)
    usual = float(np.median(ends[apart > 0] / apart[apart > 0])) if apart.any() else 1.0
    torn = np.minimum(_torn(fitted, ends), _torn(usual * apart, ends))
    np.fill_diagonal(apart, np.inf)
    np.fill_diagonal(ends, np.inf)
    figures = np.nan_to_num(result.standardised)
    found: list[Finding] = []
    named: set[int] = set()
    for i in np.argsort(-figures).tolist():
        if i in named or not np.isfinite(result.distances[i]):
            continue
        neighbours = [int(apart[i].argmin()), int(ends[i].argmin())]
        j = max(neighbours, key=lambda row: float(torn[i, row]))
        if (
            torn[i, j] > TORN
            and figures[i] > NOTICEABLE
            and figures[j] > COMPARABLE * figures[i]
            and j not in named
        ):
            near, far = float(apart[i, j]), float(ends[i, j])
            found.append(Finding(FindingKind.INCONSISTENT, (i, j), near, (far,)))
            named.update((i, j))
            continue
        missed = float(result.distances[i])
        if figures[i] > SUSPICIOUS:
            found.append(Finding(FindingKind.SUSPECT, (i,), float(figures[i]), (missed,)))
        elif result.expected[i] > ISOLATED and missed > result.rms:
            found.append(Finding(FindingKind.ISOLATED, (i,), float(apart[i].min()), (missed,)))
        named.add(i)
    return tuple(found)


def _torn(fitted: Matrix, ends: Matrix) -> Matrix:
    """Return by how much distances differ, as a factor of 1 or more; 1 where both are 0."""
    largest, smallest = np.maximum(fitted, ends), np.minimum(fitted, ends)
    torn = np.full_like(largest, np.inf)
    np.divide(largest, smallest, out=torn, where=smallest > 0)
    torn[largest <= ROUNDING * largest.max(initial=0.0)] = 1.0
    return torn


@quiet
def swapped_pairs(
    factor: SourceFactor, destination: ArrayLike, penalty: float = 0.0
) -> tuple[Finding, ...]:
    """Find pairs whose destinations look exchanged with one another.

    All exchanges are tried at once: with ``e = H y`` the leave-one-out errors, exchanging i and
    j adds ``(H_i - H_j)(y_j - y_i)^T``, so the sum of squares follows from ``H^T H``, ``H^T e``
    and the distances. The best exchange is made in thought and the search repeated.

    Parameters
    ----------
    factor, destination, penalty
        As for :func:`suspects`.

    Returns
    -------
    tuple of Finding
        SWAPPED, the clearest first, each landmark at most once. Nothing below six pairs.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> source = np.random.default_rng(0).normal(size=(12, 3))
    >>> destination = source + 0.1 * np.sin(source)
    >>> destination[[3, 7]] = destination[[7, 3]]
    >>> [sorted(finding.rows) for finding in swapped_pairs(factorise(source), destination)]
    [[3, 7]]
    """
    target, _, _ = displacements(factor, destination)
    modes = factor.modes_at_landmarks
    # With a single mode almost anything can be explained.
    if np.sum(factor.usable_modes) < 2:
        return ()
    certainty, _ = factor.certainty(np.array([check_penalty(penalty)]))
    G = (modes * certainty[:, 0]) @ modes.T
    free = np.sum(modes * modes, axis=1) > RANK_TOLERANCE**2
    free &= np.diag(G) > RANK_TOLERANCE**2 * np.diag(G).max()
    H = np.where(free[:, None], G / np.where(free, np.diag(G), 1.0)[:, None], 0.0)
    gram = H.T @ H
    lengths = np.diag(gram)[:, None] + np.diag(gram) - 2 * gram
    negligible = len(target) * (ROUNDING * float(np.abs(np.asarray(destination)).max())) ** 2
    found: list[Finding] = []
    while True:
        errors = H @ target
        before = float(np.sum(errors * errors))
        if before <= negligible:
            return tuple(found)
        after = before + _exchange(H.T @ errors, target) + lengths * cdist(target, target) ** 2
        after[~free] = after[:, ~free] = np.inf
        np.fill_diagonal(after, np.inf)
        i, j = (int(row) for row in np.unravel_index(after.argmin(), after.shape))
        if not after[i, j] < SHARPLY * before:
            return tuple(found)
        remaining = float(np.sqrt(max(after[i, j], 0.0) / before))
        found.append(Finding(FindingKind.SWAPPED, (i, j), remaining))
        target[[i, j]] = target[[j, i]]
        free[[i, j]] = False


def _exchange(pulls: Matrix, target: Matrix) -> Matrix:
    """Return ``2 (q_i - q_j) . (y_j - y_i)`` for all i and j."""
    across = pulls @ target.T
    own = np.diag(across)
    return np.asarray(2 * (across + across.T - own[:, None] - own))


@quiet
def is_mirrored(source: ArrayLike, destination: ArrayLike) -> bool:
    """Whether a reflection fits the pairs far better than a rotation: left and right bones.

    Parameters
    ----------
    source, destination
        (n, 3) positions, row by row the same landmarks; with fewer than four, or all in one
        plane, there is no telling.

    Examples
    --------
    >>> source = np.random.default_rng(0).normal(size=(8, 3))
    >>> is_mirrored(source, 1.1 * source * [1, 1, -1]), is_mirrored(source, 1.1 * source)
    (True, False)
    """
    u = as_positions(source, "source landmark")
    v = as_positions(destination, "destination landmark")
    if len(u) < 4:
        return False
    turned, reflected = (
        float(np.linalg.norm(fit_similarity(side, v).apply(side) - v))
        for side in (u, u * [-1, 1, 1])
    )
    # Met either way: a plane, or a single place.
    if turned <= 1e-6 * float(np.linalg.norm(v - v.mean(axis=0))):
        return False
    return reflected < MIRRORED * turned
