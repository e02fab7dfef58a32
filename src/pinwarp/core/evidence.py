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
        The rows that are left out.
    pulls : (n, 3, k)
        ``G y`` at every noise level.
    precision : (n, k)
        ``diag G``.
    misfit : (k,)
        ``tr y' G y``.
    log_det : (k,)
        Minus the logarithm of the determinant of the variance.
    freedom
        How many modes are left.
    kept : (n,) bool
        The pairs that can be judged.
    inverse : (k, d, d)
        That of ``G`` between those that are left out.
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
    inverse: Matrix

    @cached_property
    def _safe(self) -> Matrix:
        return np.where(self.kept[:, None], self.precision, 1.0)

    @cached_property
    def gains(self) -> Matrix:
        """(n, k): by how much leaving out one more pair lowers the misfit."""
        squares = np.einsum("nck,nck->nk", self.pulls, self.pulls)
        return np.where(self.kept[:, None], squares / self._safe, 0.0)

    @cached_property
    def remaining(self) -> Matrix:
        """(n, k): the misfit without one more pair."""
        return np.maximum(self.misfit - self.gains, UNJUDGED * self.misfit)

    @cached_property
    def nothing_wrong(self) -> Matrix:
        """(k,): the log likelihood that no pair is wrong."""
        return self.likelihood(self.misfit, self.log_det)

    @cached_property
    def one_wrong(self) -> Matrix:
        """(n, k): the log likelihood that this pair is wrong, wherever it should be."""
        return self.likelihood(self.remaining, self.log_det)

    @cached_property
    def level(self) -> int:
        """The most likely noise level where nothing is wrong."""
        return int(self.nothing_wrong.argmax())

    def level_without(self, row: int) -> int:
        """Return the most likely noise level of the others alone."""
        freed = self.log_det - np.log(self._safe[row])
        fewer = -1.5 * (self.freedom - 1) * np.log(self.remaining[row]) + 1.5 * freed
        return int(fewer.argmax())

    def likelihood(self, misfit: Matrix | float, log_det: Matrix | float) -> Matrix:
        """Return the log likelihood of pairs that fit so well."""
        return np.asarray(-1.5 * self.freedom * np.log(misfit) + 1.5 * log_det)

    def column(self, level: int, row: int) -> Matrix:
        """Return a column of ``G`` at a noise level, (n,)."""
        column = self.field.entries(level, [row])[:, 0]
        if self.left_out:
            taken, onto = self._taken(level)
            column = column - onto @ taken[row]
        return column

    def block(self, level: int | slice, rows: list[int]) -> Matrix:
        """Return ``G`` between some pairs at a noise level, or at some, (..., rows, rows)."""
        block = self.field.entries(level, rows, rows)
        if self.left_out:
            taken = self.field.entries(level, self.left_out, rows)
            block = block - taken @ self.inverse[level] @ taken.swapaxes(-1, -2)
        return block

    def near_entries(self, level: int) -> Matrix:
        """Return ``G`` between each pair and its nearest neighbours at a noise level."""
        entries = self.field.near_entries[level]
        if self.left_out:
            taken, onto = self._taken(level)
            near = self.field.near[:, : entries.shape[1]]
            entries = entries - np.einsum("nd,nkd->nk", onto, taken[near])
        return np.asarray(entries)

    @cached_property
    def _known(self) -> dict[int, tuple[Matrix, Matrix]]:
        return {}

    def _taken(self, level: int) -> tuple[Matrix, Matrix]:
        """Return the columns of those left out as they were, and the same by their inverse."""
        if level not in self._known:
            taken = self.field.entries(level, self.left_out)
            self._known[level] = taken, taken @ self.inverse[level]
        return self._known[level]

    def without(self, rows: Sequence[int]) -> Evidence:
        """Return what all say without some, of what all say."""
        rows = list(rows)
        if not rows:
            return self
        # (k, n, d), (k, d, d), (k, d, 3)
        taken = self.field.entries(slice(None), rows)
        block = taken[:, rows]
        inverse = np.asarray(np.linalg.pinv(block, hermitian=True), dtype=np.float64)
        onto = taken @ inverse
        theirs = self.pulls[rows].transpose(2, 0, 1)
        misfit = self.misfit - np.sum(theirs * (inverse @ theirs), axis=(1, 2))
        precision = self.precision - np.sum(onto * taken, axis=2).T
        return replace(
            self,
            left_out=tuple(rows),
            pulls=self.pulls - (onto @ theirs).transpose(1, 2, 0),
            precision=precision,
            misfit=np.maximum(misfit, LEAST_MISFIT),
            log_det=self.log_det - np.linalg.slogdet(block)[1],
            freedom=self.freedom - len(rows),
            kept=_judged(precision, rows),
            inverse=inverse,
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
    >>> int(seen.one_wrong[:, seen.level].argmax())
    4
    """
    modes, certainty = field.modes, field.certainty
    parts = modes.T @ destination
    levels = len(field.noise)
    spread = parts[:, :, None] * certainty[:, None, :]
    pulls = modes @ spread.reshape(len(parts), 3 * levels)
    whole = Evidence(
        field=field,
        destination=destination,
        left_out=(),
        pulls=pulls.reshape(len(modes), 3, levels),
        precision=field.precision,
        misfit=np.maximum(np.sum(parts * parts, axis=1) @ certainty, LEAST_MISFIT),
        log_det=field.log_det,
        freedom=modes.shape[1],
        kept=_judged(field.precision),
        inverse=np.zeros((levels, 0, 0)),
    )
    return whole.without(left_out)


def _judged(precision: Matrix, left_out: Sequence[int] = ()) -> NDArray[np.bool_]:
    """Return which pairs can be judged."""
    kept = np.asarray(precision[:, 0] > UNJUDGED * float(np.median(precision[:, 0])))
    kept[list(left_out)] = False
    return kept
