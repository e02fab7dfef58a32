"""What the pairs say about one another at every noise level, some of them left out.

With ``G`` as in :mod:`pinwarp.core.quality`, ``U = G y``, ``g = diag G`` and ``Q = tr y' G y``,
leaving out pairs D takes ``G_.D G_DD^-1 G_D.`` from G, so that nothing is factorised again. The
log likelihoods are those of a Gaussian field whose variance is profiled out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.pair_field import PairField

Matrix = NDArray[np.float64]

# A pair that the others leave so little of is determined by itself: it cannot be judged.
UNJUDGED = 1e-9
# What an affine map leaves of destinations of unit length, by rounding.
LEAST_MISFIT = 1e-24
# A share of the largest eigenvalue that is rounding.
LEAST_SQUARE = 1e-15


@dataclass(frozen=True, eq=False)
class Evidence:
    """The pairs that are kept, seen as one field; made by :func:`evidence`.

    Attributes
    ----------
    field
        What depends on the source alone.
    destination : (n, 3) float64
        About their middle, and of unit length in all.
    left_out
        The rows that are left out, ascending.
    pulls : (k, n, 3)
        ``G y`` at every noise level.
    precision : (k, n)
        ``diag G``.
    misfit : (k,)
        ``tr y' G y``.
    log_det : (k,)
        Minus the logarithm of the determinant of the variance.
    freedom
        How many modes are left.
    kept : (n,) bool
        The pairs that can be judged.
    taken : (k, n, d)
        What is taken from ``G`` for those that are left out, ``taken taken'``.
    """

    field: PairField
    destination: Matrix
    left_out: tuple[int, ...]
    pulls: Matrix
    precision: Matrix
    misfit: Matrix
    log_det: Matrix
    freedom: int
    kept: NDArray[np.bool_]
    taken: Matrix

    @cached_property
    def _safe(self) -> Matrix:
        return np.where(self.kept, self.precision, 1.0)

    @cached_property
    def gains(self) -> Matrix:
        """(k, n): by how much leaving out one more pair lowers the misfit."""
        squares = np.einsum("knc,knc->kn", self.pulls, self.pulls)
        return np.where(self.kept, squares / self._safe, 0.0)

    @cached_property
    def remaining(self) -> Matrix:
        """(k, n): the misfit without one more pair."""
        misfit = self.misfit[:, None]
        return np.maximum(misfit - self.gains, UNJUDGED * misfit)

    @cached_property
    def nothing_wrong(self) -> Matrix:
        """(k,): the log likelihood that no pair is wrong."""
        return self.likelihood(self.misfit, self.log_det)

    @cached_property
    def one_wrong(self) -> Matrix:
        """(k, n): the log likelihood that this pair is wrong, wherever it should be."""
        return self.likelihood(self.remaining, self.log_det[:, None])

    @cached_property
    def level(self) -> int:
        """The most likely noise level where nothing is wrong."""
        return int(self.nothing_wrong.argmax())

    def level_without(self, row: int) -> int:
        """Return the most likely noise level of the others alone."""
        freed = self.log_det - np.log(self._safe[:, row])
        fewer = -1.5 * (self.freedom - 1) * np.log(self.remaining[:, row]) + 1.5 * freed
        return int(fewer.argmax())

    def likelihood(self, misfit: Matrix | float, log_det: Matrix | float) -> Matrix:
        """Return the log likelihood of pairs that fit so well."""
        return np.asarray(-1.5 * self.freedom * np.log(misfit) + 1.5 * log_det)

    def column(self, level: int, row: int) -> Matrix:
        """Return a column of ``G`` at a noise level, (n,)."""
        taken = self.taken[level]
        return np.asarray(self.field.column(row)[level] - taken @ taken[row])

    def block(self, levels: slice, rows: list[int]) -> Matrix:
        """Return ``G`` between some pairs at some noise levels, (levels, rows, rows)."""
        taken = self.taken[levels, rows]
        return self.field.block(levels, rows) - taken @ taken.swapaxes(1, 2)

    def near_entries(self, level: int) -> Matrix:
        """Return ``G`` between each pair and its nearest neighbours at a noise level."""
        entries = self.field.near_entries(level)
        if self.left_out:
            taken = self.taken[level]
            near = self.field.near[:, : entries.shape[1]]
            entries = entries - (taken[near] @ taken[:, :, None])[:, :, 0]
        return entries

    def without(self, rows: Sequence[int]) -> Evidence:
        """Return what the pairs say without some more of them."""
        rows = list(rows)
        if not rows:
            return self
        # (k, n, d), and what of it is taken from G.
        columns = np.stack([self.field.column(row) for row in rows], axis=2)
        columns = columns - self.taken @ self.taken[:, rows].swapaxes(1, 2)
        squares, axes = np.linalg.eigh(columns[:, rows])
        # What those before have determined is not left out once more.
        there = squares > LEAST_SQUARE * squares[:, -1:]
        axes = axes / np.sqrt(np.where(there, squares, np.inf))[:, None]
        taken = columns @ axes
        theirs = axes.swapaxes(1, 2) @ self.pulls[:, rows]
        misfit = self.misfit - np.einsum("kdc,kdc->k", theirs, theirs)
        precision = self.precision - np.einsum("knd,knd->kn", taken, taken)
        left_out = tuple(sorted((*self.left_out, *rows)))
        return replace(
            self,
            left_out=left_out,
            pulls=self.pulls - taken @ theirs,
            precision=precision,
            misfit=np.maximum(misfit, LEAST_MISFIT),
            log_det=self.log_det - np.log(np.where(there, squares, 1.0)).sum(axis=1),
            freedom=self.freedom - len(rows),
            kept=_judged(precision, left_out),
            taken=np.concatenate([self.taken, taken], axis=2),
        )


def evidence(field: PairField, destination: Matrix, left_out: Sequence[int] = ()) -> Evidence:
    """Return what the pairs say about one another, some left out.

    Parameters
    ----------
    field
        The source landmarks as a field.
    destination
        (n, 3) destinations, about their middle and scaled to about unit length in all.
    left_out
        Rows that take no part.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> source = np.random.default_rng(0).normal(size=(12, 3))
    >>> strange = 0.1 * np.sin(source)
    >>> strange[4] += 1
    >>> seen = evidence(PairField.of(factorise(source)), strange)
    >>> int(seen.one_wrong[seen.level].argmax())
    4
    """
    modes, certainty = field.modes, field.certainty
    parts = modes.T @ destination
    levels = len(certainty)
    spread = certainty.T[:, :, None] * parts[:, None]
    # One product for all levels.
    pulls = modes @ spread.reshape(len(parts), 3 * levels)
    whole = Evidence(
        field=field,
        destination=destination,
        left_out=(),
        pulls=np.ascontiguousarray(pulls.reshape(len(modes), levels, 3).transpose(1, 0, 2)),
        precision=field.precision,
        misfit=np.maximum(certainty @ np.sum(parts * parts, axis=1), LEAST_MISFIT),
        log_det=field.log_det,
        freedom=modes.shape[1],
        kept=_judged(field.precision),
        taken=np.zeros((levels, len(modes), 0)),
    )
    return whole.without(left_out)


def _judged(precision: Matrix, left_out: Sequence[int] = ()) -> NDArray[np.bool_]:
    """Return which pairs can be judged."""
    kept = np.asarray(precision[0] > UNJUDGED * float(np.median(precision[0])))
    kept[list(left_out)] = False
    return kept
